#pragma once
#include "experiments/stability/study.hpp"

namespace trigrain {

/// A bin of grains flows through a square opening of `value` grain diameters, and what has left is put back on top: the
/// rate while half of the grains leave, after a fifth that left before, which Beverloo, Leniger & van de Velde (1961) say
/// grows with (D - k d)^(5/2). `vertices` 0: spheres.
std::vector<Metric> discharge(const StudyRequest& request);

/// The same bin, after that fifth, is no longer refilled: the rate while each tenth of the grains leaves, and how high
/// they then stand over the opening. Names end with the percentage that is left in the middle of the tenth.
std::vector<Metric> emptying(const StudyRequest& request);

} // namespace trigrain
