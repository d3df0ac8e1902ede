#pragma once
#include "kernels/triangle_pair.hpp"

namespace trigrain {

/// Largest rounding error of gap_along() and of the length of p - q, in units of TrianglePair::extent. With unit
/// round-off h = epsilon / 2: the six corners carry h each per coordinate, a dot product with a unit vector 3 sqrt(3)
/// h, the difference of two of them and its division by |u| 8 h more: together below 22 h = 11 epsilon; 12 leaves a
/// margin.
template <class T> inline constexpr double certificate_rounding = 12 * epsilon_of<T>;

/// Gap of the triangles along u (any length > 0), in m: min over A of u.a - max over B of u.b, divided by |u|. For
/// every u it is a lower bound of the distance, up to certificate_rounding; 0 for u = 0. Krestenitis (2018); the bound
/// is the separating-plane theorem.
template <class T> [[gnu::always_inline]] inline T gap_along(const Vec3<T>& u, const TrianglePair<T>& pair) {
  const T lowest_a = min(min(dot(u, pair.a[1]), dot(u, pair.a[2])), T(0)); // a[0] is the origin
  const T highest_b = max(max(dot(u, pair.b[0]), dot(u, pair.b[1])), dot(u, pair.b[2]));
  return (lowest_a - highest_b) * inverse_or_zero(sqrt(squared(u)));
}

/// gap_along() with all rounding taken off and 0 at least: a proven lower bound of the distance (m).
template <class T> [[gnu::always_inline]] inline T proven_gap(const T& gap, const T& extent) {
  return max(gap - constant<T>(certificate_rounding<T>) * extent, T(0));
}

/// Lanes whose separation exceeds reach (m), whatever the rounding of it, of reach and of brute force's own distance:
/// no contact, and brute force says so too.
template <class T>
[[gnu::always_inline]] inline MaskOf<T> beyond(const T& gap, const T& reach, const TrianglePair<T>& pair) {
  const double margin = certificate_rounding<T> + 4 * epsilon_of<T>;
  return gap > reach * constant<T>(1 + 2 * epsilon_of<T>) + constant<T>(margin) * pair.extent;
}

/// Lanes that the direction between the triangles' middles proves to be beyond reach: the cheapest "no contact".
template <class T>
[[gnu::always_inline]] inline MaskOf<T> apart_by_middles(const TrianglePair<T>& pair, const T& reach) {
  const Vec3<T> u = pair.a[1] + pair.a[2] - (pair.b[0] + pair.b[1] + pair.b[2]); // a[0] is the origin
  return beyond(gap_along(u, pair), reach, pair);
}

} // namespace trigrain
