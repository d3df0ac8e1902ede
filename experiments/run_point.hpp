#pragma once
#include "experiments/command_line.hpp"
#include "experiments/final_state.hpp"
#include "experiments/history.hpp"
#include "experiments/machine.hpp"
#include "experiments/verify.hpp"
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace trigrain {

/// One timed run.
struct Sample {
  Usage used;
  StepStats stats;
  double search = 0;                  ///< s, see search_seconds()
  std::optional<double> load_average; ///< when it ended
  Energy initial, final;
  Momentum momentum_error;
  FastContact first_fast, first_fast_body;
  std::uint64_t state_hash = 0; ///< of its last state
  CheckItem state;              ///< that state is finite
  int bodies_outside = 0;
  std::optional<History> history;
  std::optional<std::int64_t> heap_bytes; ///< that the simulation held at the end, meshes not counted
};

/// How far a run has come: called between steps, outside of the clock.
struct Progress {
  int sample, samples;
  double share; ///< of this sample, 0 to 1
  double time;  ///< simulated, s
};

/// What came of one point.
struct PointResult {
  Scene scene;
  double start_time = 0; ///< s
  nlohmann::ordered_json params, placement, counters;
  Check check;
  std::vector<Sample> samples;  ///< empty if the check before the timing failed
  FinalState final_state;       ///< of the last sample
  nlohmann::ordered_json trace; ///< if it was asked for
  std::vector<std::string> warnings;
  std::string started_utc; ///< ISO 8601
};

/// Checks, then times; see dem_bench --help. Writes VTK frames (of the first sample) if they are asked for, and no
/// other file. `report` may be empty. InputError for what the request gets wrong.
PointResult run_point(const BenchRequest& request, const std::function<void(const Progress&)>& report);

} // namespace trigrain
