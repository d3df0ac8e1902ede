#pragma once
#include "experiments/run_point.hpp"
#include <nlohmann/json_fwd.hpp>

namespace trigrain {

/// The record of one point (experiments/schema/record.json): from it alone one can say what ran, where, with which code
/// and flags, whether it was right, and every time that was measured.
nlohmann::ordered_json make_record(const PointResult& point, const std::string& point_id);

/// The part of a record that says how this program was built.
nlohmann::ordered_json describe_build();

} // namespace trigrain
