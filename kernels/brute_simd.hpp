#pragma once
#include "kernels/kernels.hpp"

namespace trigrain {

/// All 15 features without branches, one pair per lane. Crossing is decided in lanes where the rounding of nine volumes
/// leaves no doubt; pairs in doubt (touching, coplanar, flat, or within rounding of `reach`) are redone by brute force,
/// so that in double the contacts are brute force's for every reach. In float the bounds hold and the distance is
/// within float's rounding of the truth.
template <class T> void brute_simd(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts);

} // namespace trigrain
