#pragma once
#include "experiments/stability/study.hpp"

namespace trigrain {

/// Tests 1 to 8 of Chung & Ooi (Granular Matter 13, 2011, 643-656) with the law hertz-mindlin; `value` is the test,
/// `level` the mesh that stands for the ball.
std::vector<Metric> impact(const StudyRequest& request);

} // namespace trigrain
