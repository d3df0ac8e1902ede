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

template <class T, class Mask> [[gnu::always_inline]] inline Barycentric<T>
select(const Mask& m, const Barycentric<T>& yes, const Barycentric<T>& no) {
  return {select(m, yes.v, no.v), select(m, yes.w, no.w)};
}

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

/// Share s in [0, 1] of the point of segment a, a + u closest to `point`.
template <class T>
[[gnu::always_inline]] inline T share_on_segment(const Vec3<T>& point, const Vec3<T>& a, const Vec3<T>& u) {
  return clamp01(dot(point - a, u) * inverse_or_zero(squared(u)));
}

/// Weights of the point of triangle t closest to `point` (m), for one point or a pack of lanes, without branches: the
/// best of the three edges, and of the projection where that lies inside. Zero-area triangles are their edges.
template <class T>
[[gnu::always_inline]] inline Barycentric<T> closest_on_triangle(const Vec3<T>& point, const Corners<T>& t) {
  const Vec3<T> e = t[1] - t[0], f = t[2] - t[0], g = t[2] - t[1], n = cross(e, f), r = point - t[0];
  const T nn = squared(n);
  Barycentric<T> best = project_twice(r, e, f, n, inverse_or_zero(nn));
  const auto inside = (nn > constant<T>(cross_noise<T>) * squared(e) * squared(f)) & (best.v >= T(0)) &
                      (best.w >= T(0)) & (best.v + best.w <= T(1));
  T best_d2 = select(inside, squared(r - (best.v * e + best.w * f)), T(std::numeric_limits<ScalarOf<T>>::max()));
  const auto keep_nearer = [&](const Vec3<T>& from_point, const Barycentric<T>& z) {
    const T d2 = squared(from_point);
    const auto nearer = d2 < best_d2;
    best = select(nearer, z, best);
    best_d2 = min(best_d2, d2);
  };
  const T on_e = share_on_segment(point, t[0], e), on_f = share_on_segment(point, t[0], f),
          on_g = share_on_segment(point, t[1], g);
  keep_nearer(r - on_e * e, {on_e, T(0)});
  keep_nearer(r - on_f * f, {T(0), on_f});
  keep_nearer(point - t[1] - on_g * g, {T(1) - on_g, on_g});
  return best;
}

/// Point of a triangle and what it lies on: bits 1, 2, 4 for the corners of its zone.
struct ZonePoint {
  Vec3<double> point;
  int corners;
};

/// The same for one point, zone by zone with early returns: Ericson (2005) 5.1.5 with his areas taken from the normal,
/// so that slivers keep their zones.
inline ZonePoint closest_on_triangle_by_zones(const Vec3<double>& point, const Corners<double>& t) {
  const Vec3<double>&a = t[0], &b = t[1], &c = t[2];
  const Vec3<double> e = b - a, f = c - a, g = c - b, n = cross(e, f);
  const Vec3<double> ra = point - a, rb = point - b, rc = point - c;
  const double ae = dot(ra, e), af = dot(ra, f), be = dot(rb, e), bf = dot(rb, f), ce = dot(rc, e), cf = dot(rc, f);
  if (ae <= 0 && af <= 0) return {a, 1};  // A
  if (be >= 0 && bf <= be) return {b, 2}; // B
  if (cf >= 0 && ce <= cf) return {c, 4}; // C
  const double nn = squared(n);
  if (nn <= cross_noise<double> * squared(e) * squared(f)) { // zero area: the best edge
    ZonePoint best{a + share_on_segment(point, a, e) * e, 3};
    for (const ZonePoint& z :
         {ZonePoint{b + share_on_segment(point, b, g) * g, 6}, {a + share_on_segment(point, a, f) * f, 5}})
      if (squared(point - z.point) < squared(point - best.point)) best = z;
    return best;
  }
  if (dot(cross(ra, rb), n) <= 0 && ae >= 0 && be <= 0) return {a + (ae / squared(e)) * e, 3};                  // AB
  if (dot(cross(rc, ra), n) <= 0 && af >= 0 && cf <= 0) return {a + (af / squared(f)) * f, 5};                  // AC
  if (dot(cross(rb, rc), n) <= 0 && bf >= be && ce >= cf) return {b + clamp01(dot(rb, g) / squared(g)) * g, 6}; // BC
  Barycentric<double> z = project(ra, e, f, n, 1 / nn), rest{1, 1};                                             // ABC
  for (int k = 0; k < 5 && std::max(std::fabs(rest.v), std::fabs(rest.w)) > 1e-9; ++k) { // once, but for the thinnest
    rest = project(ra - (z.v * e + z.w * f), e, f, n, 1 / nn);
    z = {z.v + rest.v, z.w + rest.w};
  }
  const double v = clamp01(z.v), w = std::min(clamp01(z.w), 1 - v);
  return {a + v * e + w * f, 7};
}

} // namespace trigrain
