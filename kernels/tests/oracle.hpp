#pragma once
#include "kernels/triangles.hpp"
#include <algorithm>
#include <array>

namespace trigrain::oracle {

// Distances by enumeration of interior critical points, over a number type N that is exact (cpp_rational) or much finer
// than double (cpp_bin_float_quad). No clamping and no regions, so it shares no logic with the kernels.

template <class N> using Point = std::array<N, 3>;
template <class N> using Corners = std::array<Point<N>, 3>;

template <class N> Point<N> point(const Vec3<double>& v) { return {N(v.x), N(v.y), N(v.z)}; }
template <class N> Corners<N> corners(const Triangle& t) { return {point<N>(t.a0), point<N>(t.a1), point<N>(t.a2)}; }
template <class N> Point<N> minus(const Point<N>& a, const Point<N>& b) {
  return {N(a[0] - b[0]), N(a[1] - b[1]), N(a[2] - b[2])};
}
template <class N> N dot(const Point<N>& a, const Point<N>& b) { return N(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]); }
template <class N> Point<N> cross(const Point<N>& a, const Point<N>& b) {
  return {N(a[1] * b[2] - a[2] * b[1]), N(a[2] * b[0] - a[0] * b[2]), N(a[0] * b[1] - a[1] * b[0])};
}
template <class N> Point<N> along(const Point<N>& a, const N& s, const Point<N>& u) {
  return {N(a[0] + s * u[0]), N(a[1] + s * u[1]), N(a[2] + s * u[2])};
}
template <class N> N squared(const Point<N>& v) { return dot(v, v); }

/// Lowers d2 to the squared distance of p from triangle t.
template <class N> void lower_to_triangle(N& d2, const Point<N>& p, const Corners<N>& t) {
  for (int k = 0; k < 3; ++k) {
    const Point<N> r = minus(p, t[k]), u = minus(t[(k + 1) % 3], t[k]);
    d2 = std::min(d2, squared(r)); // corner
    const N uu = squared(u), ru = dot(r, u);
    if (ru > 0 && ru < uu) d2 = std::min(d2, squared(minus(r, along({N(0), N(0), N(0)}, N(ru / uu), u)))); // edge
  }
  const Point<N> e = minus(t[1], t[0]), f = minus(t[2], t[0]), r = minus(p, t[0]), n = cross(e, f);
  const N nn = squared(n), v = dot(cross(r, f), n), w = dot(cross(e, r), n), h = dot(r, n);
  if (nn > 0 && v > 0 && w > 0 && v + w < nn) d2 = std::min(d2, N(h * h / nn)); // face
}

/// Lowers d2 to that of the lines of two edges, where their closest points are inside both.
template <class N>
void lower_to_edges(N& d2, const Point<N>& a0, const Point<N>& a1, const Point<N>& b0, const Point<N>& b1) {
  const Point<N> u = minus(a1, a0), v = minus(b1, b0), r = minus(b0, a0), n = cross(u, v);
  const N nn = squared(n);
  if (nn == 0) return;
  const N s = dot(cross(r, v), n), t = dot(cross(r, u), n), h = dot(r, n);
  if (s > 0 && s < nn && t > 0 && t < nn) d2 = std::min(d2, N(h * h / nn));
}

/// Does segment pq go through the inside of t? (Through its edges or with its ends: some other feature has distance 0.)
template <class N> bool pierces(const Point<N>& p, const Point<N>& q, const Corners<N>& t) {
  const Point<N> n = cross(minus(t[1], t[0]), minus(t[2], t[0]));
  const N hp = dot(minus(p, t[0]), n), hq = dot(minus(q, t[0]), n);
  if (!((hp > 0 && hq < 0) || (hp < 0 && hq > 0))) return false;
  const Point<N> x = along(p, N(hp / (hp - hq)), minus(q, p));
  for (int k = 0; k < 3; ++k)
    if (dot(cross(minus(t[(k + 1) % 3], t[k]), minus(x, t[k])), n) < 0) return false;
  return true;
}

/// Squared distance of two triangles (m2).
template <class N> N distance2(const Triangle& ta, const Triangle& tb) {
  const Corners<N> a = corners<N>(ta), b = corners<N>(tb);
  N d2 = squared(minus(a[0], b[0]));
  for (int k = 0; k < 3; ++k) {
    if (pierces(a[k], a[(k + 1) % 3], b) || pierces(b[k], b[(k + 1) % 3], a)) return N(0);
    lower_to_triangle(d2, a[k], b);
    lower_to_triangle(d2, b[k], a);
    for (int l = 0; l < 3; ++l) lower_to_edges(d2, a[k], a[(k + 1) % 3], b[l], b[(l + 1) % 3]);
  }
  return d2;
}

/// Squared distance of a point and a triangle (m2).
template <class N> N distance2(const Vec3<double>& p, const Triangle& t) {
  N d2 = squared(minus(point<N>(p), point<N>(t.a0)));
  lower_to_triangle(d2, point<N>(p), corners<N>(t));
  return d2;
}

} // namespace trigrain::oracle
