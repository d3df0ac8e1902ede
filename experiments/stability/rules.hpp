#pragma once
#include "experiments/stability/study.hpp"

namespace trigrain {

// What every contact rule has to stand; `value` is the number of cuts per face.
std::vector<Metric> tessellation(const StudyRequest& request);
std::vector<Metric> loop_work(const StudyRequest& request);
std::vector<Metric> rule_cost(const StudyRequest& request);
std::vector<Metric> face_rest(const StudyRequest& request);
std::vector<Metric> stack(const StudyRequest& request);

} // namespace trigrain
