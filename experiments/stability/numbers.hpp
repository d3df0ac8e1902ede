#pragma once
#include "experiments/stability/study.hpp"

namespace trigrain {

// Where numbers and meshes fail.
std::vector<Metric> far_from_origin(const StudyRequest& request); ///< value: distance of the bodies from the origin (m)
std::vector<Metric> scale_invariance(const StudyRequest& request); ///< value: k; triangle pairs are scaled by 2^k
std::vector<Metric> degenerate(const StudyRequest& request);

} // namespace trigrain
