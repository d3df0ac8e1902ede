#pragma once
#include "experiments/stability/study.hpp"

namespace trigrain {

// Scenes on which methods fail.
std::vector<Metric> cut_floor(const StudyRequest& request);  ///< value: cuts of the floor
std::vector<Metric> mass_ratio(const StudyRequest& request); ///< value: mass of the upper of two cubes over the lower's
std::vector<Metric> long_rest(const StudyRequest& request);  ///< value: steps
std::vector<Metric> flat_drop(const StudyRequest& request);  ///< value: tilt, times edge and frequency, over speed
std::vector<Metric> grazing(const StudyRequest& request);    ///< value: angle from the normal (degrees)
std::vector<Metric> determinism(const StudyRequest& request); ///< value: threads

} // namespace trigrain
