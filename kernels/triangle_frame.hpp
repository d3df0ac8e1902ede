#pragma once
#include "kernels/point_triangle.hpp"

namespace trigrain {

/// x >= 0 made fit to divide by.
template <class T> [[gnu::always_inline]] inline T positive(const T& x) {
  return max(x, constant<T>(std::numeric_limits<ScalarOf<T>>::min()));
}
/// 1 / x for x >= 0, and a large number in place of infinity.
template <class T> [[gnu::always_inline]] inline T inverse_or_large(const T& x) { return T(1) / positive(x); }

/// A triangle with edges e and f from its corner 0 in axes at right angles: e and m, with f = mu e + m. They are so to
/// rounding for every shape, for m is (e x f) x e / ee; where rounding leaves of e x f its size alone, m is as long as
/// the rounding of f.
template <class T> struct TriangleFrame {
  Vec3<T> e, m; ///< m
  T ee, mm;     ///< |e|^2 and |m|^2 (m2)
  T inverse_ee, inverse_mm, mu;
  MaskOf<T> flat; ///< e or m is zero, or too small for products of three lengths: the axes mean nothing

  [[gnu::always_inline]] TriangleFrame(const Vec3<T>& edge, const Vec3<T>& f)
      : e(edge), ee(squared(e)), inverse_ee(inverse_or_large(ee)), mu(dot(f, e) * inverse_ee) {
    constexpr double smallest = sizeof(ScalarOf<T>) == sizeof(double) ? 1e-200 : 1e-24;
    m = inverse_ee * cross(cross(e, f), e);
    mm = squared(m);
    inverse_mm = inverse_or_large(mm);
    flat = min(ee, mm) <= constant<T>(smallest);
  }

  /// Weights of the projection of a point r, seen from corner 0, from r.e and r.m.
  [[gnu::always_inline]] Barycentric<T> project(const T& re, const T& rm) const {
    const T w = rm * inverse_mm;
    return {re * inverse_ee - w * mu, w};
  }
};

/// An edge in the plane of its triangle: from point (x, y) in direction (dx, dy), of length 1.
template <class T> struct PlaneEdge {
  T x, y, dx, dy;
  T length, inverse_length; ///< m, 1/m

  [[gnu::always_inline]] PlaneEdge(const T& from_x, const T& from_y, const T& to_x, const T& to_y)
      : x(from_x), y(from_y) {
    const T ex = to_x - x, ey = to_y - y, length2 = ex * ex + ey * ey;
    length = sqrt(length2);
    inverse_length = length * inverse_or_large(length2);
    dx = inverse_length * ex;
    dy = inverse_length * ey;
  }

  /// A point over the plane in the frame of the edge: x along it from where it starts, y across it in the plane.
  [[gnu::always_inline]] Vec3<T> seen(const Vec3<T>& p) const {
    const T px = p.x - x, py = p.y - y;
    return {dx * px + dy * py, dx * py - dy * px, p.z};
  }
};

} // namespace trigrain
