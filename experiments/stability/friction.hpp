#pragma once
#include "experiments/stability/study.hpp"

namespace trigrain {

// Friction that is known in closed form.
std::vector<Metric> slope(const StudyRequest& request);           ///< value: slope (degrees) on which it slides
std::vector<Metric> slope_rest(const StudyRequest& request);      ///< value: steps
std::vector<Metric> topple(const StudyRequest& request);          ///< value: blocks per axis of the map
std::vector<Metric> rolling_ball(const StudyRequest& request);    ///< value: slope (degrees); 0: slides first
std::vector<Metric> rolling_polygon(const StudyRequest& request); ///< value: corners

} // namespace trigrain
