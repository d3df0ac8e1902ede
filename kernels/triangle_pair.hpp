#pragma once
#include "kernels/lanes.hpp"
#include "kernels/triangles.hpp"
#include <array>
#include <limits>

namespace trigrain {

template <class T> using Corners = std::array<Vec3<T>, 3>;

/// Points p on A and q on B (m).
template <class T> struct PointPair { Vec3<T> p, q; };

/// Two triangles in a frame of their own, so that an offset from the world's origin costs no digits: its origin is
/// a[0], which is zero. `extent` (m) is the largest coordinate in that frame; all rounding errors are stated in units
/// of it. It is at most twice the largest coordinate of the pair in any other frame.
template <class T> struct TrianglePair {
  Corners<T> a, b;
  T extent;
};

template <class T, class Mask>
[[gnu::always_inline]] inline Vec3<T> select(const Mask& m, const Vec3<T>& yes, const Vec3<T>& no) {
  return {select(m, yes.x, no.x), select(m, yes.y, no.y), select(m, yes.z, no.z)};
}

template <class T> [[gnu::always_inline]] inline T largest_coordinate(const Vec3<T>& v) {
  return max(max(abs(v.x), abs(v.y)), abs(v.z));
}

/// Largest coordinate of two triangles in a frame with its origin at a[0].
template <class T> [[gnu::always_inline]] inline T extent_of(const Corners<T>& a, const Corners<T>& b) {
  T extent = max(largest_coordinate(a[1]), largest_coordinate(a[2]));
  for (int k = 0; k < 3; ++k) extent = max(extent, largest_coordinate(b[k]));
  return extent;
}

/// `a` and `b` seen from the corner a[0].
template <class T> [[gnu::always_inline]] inline TrianglePair<T> local_pair(const Corners<T>& a, const Corners<T>& b) {
  const Corners<T> to_a{Vec3<T>{T(0), T(0), T(0)}, a[1] - a[0], a[2] - a[0]},
      to_b{b[0] - a[0], b[1] - a[0], b[2] - a[0]};
  return {to_a, to_b, extent_of(to_a, to_b)};
}

inline Corners<double> corners(const Triangle& t) { return {t.a0, t.a1, t.a2}; }

template <class T> [[gnu::always_inline]] inline T squared(const Vec3<T>& v) { return dot(v, v); }

inline constexpr double epsilon = std::numeric_limits<double>::epsilon(); ///< 2^-52

/// A cross product e x f counts as zero unless |e x f|^2 > noise |e|^2 |f|^2: below that it may be nothing but the
/// rounding that fused multiply-adds leave.
template <class T> inline constexpr double cross_noise = 64 * epsilon_of<T>* epsilon_of<T>;

} // namespace trigrain
