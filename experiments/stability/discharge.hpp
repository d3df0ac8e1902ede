#pragma once
#include "experiments/stability/study.hpp"

namespace trigrain {

/// A bin of grains empties through a square opening of `value` grain diameters: the rate between 20 and 70 % emptied,
/// which Beverloo, Leniger & van de Velde (1961) say grows with (D - k d)^(5/2). `vertices` 0: spheres.
std::vector<Metric> discharge(const StudyRequest& request);

} // namespace trigrain
