#pragma once
#include "experiments/run_point.hpp"
#include <nlohmann/json_fwd.hpp>

namespace trigrain {

/// The record of one point (experiments/schema/record.json): from it alone one can say what ran, where, with which code
/// and flags, whether it was right, and every time that was measured.
nlohmann::ordered_json make_record(const PointResult& point, const std::string& point_id);

} // namespace trigrain
