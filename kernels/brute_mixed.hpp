#pragma once
#include "kernels/kernels.hpp"

namespace trigrain {

/// Brute force over lanes that looks in float and answers in double: pairs whose separating gap in float, less all its
/// rounding, exceeds reach are dropped; the rest is solved by brute_simd<Double>. Same answers as that, bit for bit.
template <class Float, class Double>
void brute_mixed(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts);

} // namespace trigrain
