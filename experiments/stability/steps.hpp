#pragma once
#include "experiments/stability/study.hpp"

namespace trigrain {

// Where steps become too long.
std::vector<Metric> critical_step_study(const StudyRequest& request); ///< value: what stands on what, see the source
std::vector<Metric> rebound(const StudyRequest& request);             ///< steps_per_contact varies
std::vector<Metric> rebound_explicit(const StudyRequest& request);    ///< the same by explicit Euler, to compare with
std::vector<Metric> long_run(const StudyRequest& request);            ///< value: bounces; steps_per_contact varies

} // namespace trigrain
