#pragma once
#include "kernels/hits.hpp"
#include "kernels/triangle_pair.hpp"

namespace trigrain {

/// Weights of two points: x = a0 + z[0] (a1 - a0) + z[1] (a2 - a0) and y = b0 + z[2] (b1 - b0) + z[3] (b2 - b0).
template <class T> using Weights = std::array<T, 4>;

/// The points (m, the pair's frame) that weights stand for.
template <class T>
[[gnu::always_inline]] inline PointPair<T> points_at(const TrianglePair<T>& pair, const Weights<T>& z) {
  return {z[0] * pair.a[1] + z[1] * pair.a[2],
          pair.b[0] + z[2] * (pair.b[1] - pair.b[0]) + z[3] * (pair.b[2] - pair.b[0])};
}

/// The bits of Features for weights in the triangles, as a number: a corner's bit is set where its weight is not 0.
template <class T> [[gnu::always_inline]] inline T feature_of(const Weights<T>& z) {
  const auto corners = [](const T& v, const T& w) {
    const T u = T(1) - v - w, noise = constant<T>(2 * epsilon_of<T>); // u of a point on the third edge
    return select(u > noise, T(1), T(0)) + select(v > T(0), T(2), T(0)) + select(w > T(0), T(4), T(0));
  };
  return corners(z[0], z[1]) + T(1 << Features::shift_b) * corners(z[2], z[3]);
}

} // namespace trigrain
