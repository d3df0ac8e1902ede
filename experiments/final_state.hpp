#pragma once
#include "dem/simulation.hpp"
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace trigrain {

/// Where a run ended, in the scene's body order; positions and orientations are those of the shapes' own frames.
struct FinalState {
  double time = 0; ///< s
  Energy energy;
  std::vector<Body> bodies; ///< of a state that was read, only pose, velocities and `fixed` (false where not known)
  int fixed_bodies = -1;    ///< -1 if the file does not say
};

/// The state of `simulation`; `start_time` (s) is the simulated time at which it began.
FinalState final_state(const Simulation& simulation, double start_time = 0);

/// [x, y, z]
nlohmann::ordered_json array_of(const Eigen::Vector3d& v);

/// JSON of experiments/schema/final_state.json; every double survives the round trip bit by bit.
nlohmann::ordered_json to_json(const FinalState& state);

/// InputError names the file, the key, and what was expected there.
FinalState read_final_state(const std::filesystem::path& file);

/// `scene` with the moving bodies where `state` left them. InputError, naming `file`, unless the state has as many
/// bodies, and as many fixed ones, as the scene.
Scene continued(Scene scene, const FinalState& state, const std::filesystem::path& file);

/// The scene of `simulation` with its bodies as they are now: a run that starts here starts from the same bits each
/// time.
Scene snapshot(const Simulation& simulation);

} // namespace trigrain
