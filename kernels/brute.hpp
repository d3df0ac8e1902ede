#pragma once
#include "kernels/kernels.hpp"

namespace trigrain {

/// Closest points of two triangles, exact: |distance - d| <= 1e-14 max(longest edge, largest coordinate), p in A, q in
/// B, and p = q with distance = 0 if and only if the triangles touch or cross. `lower` is the certificate of METHODS'
/// separating plane normal to p - q (certificate.hpp), proven whatever the rounding. Inputs: finite, magnitudes 1e-90
/// to 1e90 or 0.
Closest closest_by_brute_force(const Triangle& a, const Triangle& b);

void brute(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts);

} // namespace trigrain
