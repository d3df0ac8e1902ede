#pragma once
#include "experiments/stability/study.hpp"

namespace trigrain {

// Where methods fail.
std::vector<Metric> step_limit(const StudyRequest& request);      ///< value: 0 ball, 1 cube on its face, 2 three cubes
std::vector<Metric> rebound(const StudyRequest& request);         ///< steps_per_contact varies
std::vector<Metric> long_run(const StudyRequest& request);        ///< value: bounces; steps_per_contact varies
std::vector<Metric> tunnelling(const StudyRequest& request);      ///< value: speed over the response limit
std::vector<Metric> overlap_release(const StudyRequest& request); ///< value: overlap at the start over the sum of halos
std::vector<Metric> cut_floor(const StudyRequest& request);       ///< value: cuts of the floor
std::vector<Metric> mass_ratio(const StudyRequest& request); ///< value: mass of the upper of two cubes over the lower's

} // namespace trigrain
