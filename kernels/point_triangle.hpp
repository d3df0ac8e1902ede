#pragma once
#include "kernels/triangle_pair.hpp"

namespace trigrain {

//  The seven zones of the plane of a triangle abc, after Ericson (2005) 5.1.5:
//
//             :       :
//              :  C  :
//               :   :
//                 c
//          AC    / \    BC
//               /   \        .
//              / ABC \        .
//     - - - - a-------b - - - -
//        A    :       :    B
//             :  AB   :
//
//  A point that projects into zone A, B, C is closest to that corner; AB, BC, AC: to that edge; ABC: to its projection.

/// Barycentric weights (of b and c) of a point's projection on the plane of a triangle.
template <class T> struct Barycentric { T v, w; };

/// e = b - a, f = c - a, n = e x f with |n|^2 > 0 in `inverse_nn`; r = point - a. By cross products: the error is
/// epsilon |r| L / |n|, where the determinant of the Gram matrix would square the aspect ratio.
template <class T> [[gnu::always_inline]] inline Barycentric<T>
project(const Vec3<T>& r, const Vec3<T>& e, const Vec3<T>& f, const Vec3<T>& n, const T& inverse_nn) {
  return {dot(cross(r, f), n) * inverse_nn, dot(cross(e, r), n) * inverse_nn};
}

/// The same, with the error of the first projection projected again: good to epsilon for aspect ratios of 1e6 and more.
template <class T> [[gnu::always_inline]] inline Barycentric<T>
project_twice(const Vec3<T>& r, const Vec3<T>& e, const Vec3<T>& f, const Vec3<T>& n, const T& inverse_nn) {
  const Barycentric<T> first = project(r, e, f, n, inverse_nn);
  const Barycentric<T> rest = project(r - (first.v * e + first.w * f), e, f, n, inverse_nn);
  return {first.v + rest.v, first.w + rest.w};
}

/// Point of segment ab closest to `point` (m).
template <class T>
[[gnu::always_inline]] inline Vec3<T> closest_on_segment(const Vec3<T>& point, const Vec3<T>& a, const Vec3<T>& b) {
  const Vec3<T> u = b - a;
  return a + clamp01(dot(point - a, u) * inverse_or_zero(squared(u))) * u;
}

/// Point of triangle t closest to `point` (m), for one point or a pack of lanes, without branches: the best of the
/// three edges, and of the projection where that lies inside. Zero-area triangles are their edges.
template <class T> [[gnu::flatten]] Vec3<T> closest_on_triangle(const Vec3<T>& point, const Corners<T>& t) {
  const Vec3<T> e = t[1] - t[0], f = t[2] - t[0], n = cross(e, f);
  const T nn = squared(n);
  const Barycentric<T> z = project_twice(point - t[0], e, f, n, inverse_or_zero(nn));
  const auto inside =
      (nn > T(cross_noise) * squared(e) * squared(f)) & (z.v >= T(0)) & (z.w >= T(0)) & (z.v + z.w <= T(1));
  Vec3<T> best = t[0] + z.v * e + z.w * f;
  T best_d2 = select(inside, squared(point - best), T(std::numeric_limits<double>::max()));
  for (int k = 0; k < 3; ++k) {
    const Vec3<T> q = closest_on_segment(point, t[k], t[(k + 1) % 3]);
    const T d2 = squared(point - q);
    const auto nearer = d2 < best_d2;
    best = {select(nearer, q.x, best.x), select(nearer, q.y, best.y), select(nearer, q.z, best.z)};
    best_d2 = min(best_d2, d2);
  }
  return best;
}

/// The same for one point, zone by zone with early returns: Ericson (2005) 5.1.5 with his areas taken from the normal,
/// so that slivers keep their zones.
inline Vec3<double> closest_on_triangle_by_zones(const Vec3<double>& point, const Corners<double>& t) {
  const Vec3<double>&a = t[0], &b = t[1], &c = t[2];
  const Vec3<double> e = b - a, f = c - a, g = c - b, n = cross(e, f);
  const Vec3<double> ra = point - a, rb = point - b, rc = point - c;
  const double ae = dot(ra, e), af = dot(ra, f), be = dot(rb, e), bf = dot(rb, f), ce = dot(rc, e), cf = dot(rc, f);
  if (ae <= 0 && af <= 0) return a;  // A
  if (be >= 0 && bf <= be) return b; // B
  if (cf >= 0 && ce <= cf) return c; // C
  const double nn = squared(n);
  const bool flat = nn <= cross_noise * squared(e) * squared(f);
  if (flat) { // zero area: the best edge
    Vec3<double> best = closest_on_segment(point, a, b);
    for (const Vec3<double>& q : {closest_on_segment(point, b, c), closest_on_segment(point, a, c)})
      if (squared(point - q) < squared(point - best)) best = q;
    return best;
  }
  if (dot(cross(ra, rb), n) <= 0 && ae >= 0 && be <= 0) return a + (ae / squared(e)) * e;                  // AB
  if (dot(cross(rc, ra), n) <= 0 && af >= 0 && cf <= 0) return a + (af / squared(f)) * f;                  // AC
  if (dot(cross(rb, rc), n) <= 0 && bf >= be && ce >= cf) return b + clamp01(dot(rb, g) / squared(g)) * g; // BC
  const Barycentric<double> z = project_twice(ra, e, f, n, 1 / nn);                                        // ABC
  const double v = clamp01(z.v), w = std::min(clamp01(z.w), 1 - v);
  return a + v * e + w * f;
}

} // namespace trigrain
