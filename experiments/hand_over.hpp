#pragma once
#include "experiments/final_state.hpp"
#include <nlohmann/json_fwd.hpp>

namespace trigrain {

/// What another program needs to go on from `state` of `scene`: the contact law, and every body with its shape, mass
/// and motion (experiments/schema/hand_over.json).
nlohmann::ordered_json hand_over(const Scene& scene, const FinalState& state);

} // namespace trigrain
