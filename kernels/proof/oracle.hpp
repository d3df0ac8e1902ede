#pragma once
#include "kernels/triangles.hpp"
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cstdint>

namespace trigrain::oracle {

using Quad = boost::multiprecision::cpp_bin_float_quad; ///< 113 bits

/// How the calls so far were decided; the exact numbers cost about ten times the filter.
struct Decisions {
  std::int64_t filtered = 0; ///< by bounded rounding errors, and one feature in exact numbers
  std::int64_t exact = 0;    ///< all features in exact numbers
};

/// Distance of two triangles (m) as given: 0 if and only if they have a point in common, else the square root of an
/// exact fraction, rounded to 113 bits. Zero-area triangles included. Shares no text and no method with the kernels:
/// the least of the distances of all features at their interior critical points, without clamps or regions, in integers
/// and without a division.
Quad distance(const Triangle& a, const Triangle& b, Decisions* decisions = nullptr);

/// Distance of a point and a triangle (m).
Quad distance(const Vec3<double>& p, const Triangle& t);

/// distance() without the filter, to test it.
Quad distance_unfiltered(const Triangle& a, const Triangle& b);

} // namespace trigrain::oracle
