#pragma once
#include "experiments/stability/study.hpp"

namespace trigrain {

// Where the halo fails.
std::vector<Metric> tunnelling(const StudyRequest& request);      ///< value: speed over the response limit
std::vector<Metric> detection(const StudyRequest& request);       ///< value: way per step over the width that is seen
std::vector<Metric> overlap_release(const StudyRequest& request); ///< value: overlap at the start over the sum of halos

} // namespace trigrain
