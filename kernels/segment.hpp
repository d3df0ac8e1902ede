#pragma once
#include "kernels/triangle_pair.hpp"

namespace trigrain {

/// Where two segments are closest: shares s of a0a1 and t of b0b1, in [0, 1].
template <class T> struct SegmentShares { T s, t; };

/// Closest points of segments a0a1 and b0b1. Ericson (2005) 5.1.9 with clamps as selects. The parameter s of
/// the two lines comes from cross products instead of |u|^2 |v|^2 - (u.v)^2: its error grows with 1 / angle instead of
/// 1 / angle^2, so the distance stays good to a few epsilon of the coordinates for any angle. Parallel segments: any
/// closest pair. Segments of length 0 are points.
template <class T> [[gnu::always_inline]] inline SegmentShares<T>
closest_on_segments(const Vec3<T>& a0, const Vec3<T>& a1, const Vec3<T>& b0, const Vec3<T>& b1) {
  const Vec3<T> u = a1 - a0, v = b1 - b0, r = b0 - a0;
  const T uu = squared(u), vv = squared(v), uv = dot(u, v), ru = dot(r, u), rv = dot(r, v);
  const Vec3<T> n = cross(u, v);
  const T nn = squared(n);
  const T on_lines = dot(cross(r, v), n) * inverse_or_zero(nn);
  const T s0 = select(nn > constant<T>(cross_noise<T>) * uu * vv, clamp01(on_lines), T(0));
  const T t = clamp01((uv * s0 - rv) * inverse_or_zero(vv));
  const T s = clamp01((uv * t + ru) * inverse_or_zero(uu)); // from the clamped t: needed where t was clamped
  return {s, t};
}

} // namespace trigrain
