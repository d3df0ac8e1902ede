#pragma once
#include "dem/simulation.hpp"
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace trigrain {

/// What one call of dem_bench is asked to do. An empty path means: not asked for.
struct BenchRequest {
  std::string scene;
  SceneOptions scene_options;
  std::filesystem::path scene_file; ///< instead of scene and its options
  Options options;
  std::filesystem::path start_state;
  std::string step_control;          ///< instead of the scene's
  std::optional<std::int64_t> steps; ///< length of a sample
  std::optional<double> end;         ///< the same in simulated seconds
  int repeats = 1;                   ///< samples
  std::int64_t warmup = 0;           ///< untimed steps before each sample
  std::optional<std::int64_t> check_steps;
  std::filesystem::path record, final_state, hand_over, trace, vtk;
  std::int64_t history = 0; ///< steps per row of the record's history; 0: none
  double vtk_every = 0;     ///< simulated seconds; 0: first and last only
  std::string point_id;
  std::vector<std::string> extra_params; ///< key=value
};

/// Reads the command line; none if it asked for --help or --list, which are printed to `out`.
/// InputError for unknown options, values of a wrong type or range, and combinations that make no sense.
std::optional<BenchRequest> parse_command_line(int argc, const char* const* argv, std::ostream& out);

/// Every parameter of the run, defaults included, then the extra ones. InputError for an extra one that is not
/// key=value or whose key is taken.
nlohmann::ordered_json params_of(const BenchRequest& request);

/// The scene the request names, with the start state's motion.
struct StartingPoint {
  Scene scene;
  double time = 0; ///< s, of the start state
};
StartingPoint starting_point(const BenchRequest& request);

} // namespace trigrain
