#pragma once
#include "kernels/triangle_pair.hpp"

namespace trigrain {

/// Constants of the penalty method, in units of the trace of H = 2 W^T W so that they hold at every scale. Penalty
/// 1e6 lambda^2 with lambda^2 = 0.0125 tr H (Krestenitis 2018); damping 1e-2 tr H, the same in every step: growing it
/// freezes the iterate. Measured with these four steps on 2e5 random pairs with corners uniform in cubes of edge 2 m:
/// too long by more than 1e-3 of the longest edge are 17 % of the pairs that do not cross if the cubes coincide, 5 % if
/// they are 3 m apart; the worst by 0.7 edges; the certificate flagged every one of them.
struct Penalty {
  static constexpr double weight = 1e6 * 0.0125;
  static constexpr double damping = 1e-2;
  static constexpr double start = 0.33;
  static constexpr int steps = 4;
};

/// Weights of two points: x = a0 + z[0] (a1 - a0) + z[1] (a2 - a0) and y = b0 + z[2] (b1 - b0) + z[3] (b2 - b0).
template <class T> using Weights = std::array<T, 4>;

/// Symmetric 4x4 matrix; only [row][column] with row >= column is used.
template <class T> using Symmetric4 = std::array<std::array<T, 4>, 4>;

/// m^-1 g for positive definite m by LDL^T, a fixed sequence of operations.
template <class T> Weights<T> solve(Symmetric4<T> m, Weights<T> g) {
  std::array<T, 4> inverse_d;
#pragma GCC unroll 4
  for (int k = 0; k < 4; ++k) {
    inverse_d[k] = T(1) / m[k][k];
#pragma GCC unroll 4
    for (int i = k + 1; i < 4; ++i) {
      const T l = m[i][k] * inverse_d[k];
#pragma GCC unroll 4
      for (int j = k + 1; j <= i; ++j) m[i][j] -= l * m[j][k];
      g[i] -= l * g[k];
    }
  }
#pragma GCC unroll 4
  for (int k = 3; k >= 0; --k) {
#pragma GCC unroll 4
    for (int i = k + 1; i < 4; ++i) g[k] -= m[i][k] * g[i];
    g[k] *= inverse_d[k];
  }
  return g;
}

/// Adds the penalty of one triangle's three constraints, z0 >= 0, z1 >= 0, z0 + z1 <= 1, to Hessian and gradient.
template <class T> void add_penalty(Symmetric4<T>& hessian, Weights<T>& gradient, const Weights<T>& z, int k) {
  const T zero(0), twice(2 * Penalty::weight);
  const T low0 = min(z[k], zero), low1 = min(z[k + 1], zero), over = max(z[k] + z[k + 1] - T(1), zero);
  const T on_over = select(over > zero, twice, zero);
  hessian[k][k] += select(low0 < zero, twice, zero) + on_over;
  hessian[k + 1][k + 1] += select(low1 < zero, twice, zero) + on_over;
  hessian[k + 1][k] += on_over;
  gradient[k] += twice * (low0 + over);
  gradient[k + 1] += twice * (low1 + over);
}

/// Weights after Penalty::steps Newton steps for the closest points of a pair; near the triangles, not in them.
/// Krestenitis (2018), Krestenitis, Weinzierl, Koziara (2017): minimise |x - y|^2 plus a penalty on z outside.
template <class T> [[gnu::flatten]] Weights<T> newton(const TrianglePair<T>& pair) {
  const std::array<Vec3<T>, 4> w{pair.a[1] - pair.a[0], pair.a[2] - pair.a[0], pair.b[0] - pair.b[1],
                                 pair.b[0] - pair.b[2]};
  const T half_trace = squared(w[0]) + squared(w[1]) + squared(w[2]) + squared(w[3]);
  const T unit = inverse_or_zero(half_trace); // 2 / tr H: everything below is divided by tr H
  const Vec3<T> start = pair.a[0] - pair.b[0];
  Symmetric4<T> h;
  Weights<T> offset;
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) {
#pragma GCC unroll 4
    for (int j = 0; j <= i; ++j) h[i][j] = dot(w[i], w[j]) * unit;
    offset[i] = dot(w[i], start) * unit;
  }
  Weights<T> z;
  z.fill(T(Penalty::start));
  for (int step = 0; step < Penalty::steps; ++step) {
    Symmetric4<T> hessian = h;
    Weights<T> gradient = offset;
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
#pragma GCC unroll 4
      for (int j = 0; j < 4; ++j) gradient[i] += h[std::max(i, j)][std::min(i, j)] * z[j];
      hessian[i][i] += T(Penalty::damping);
    }
    add_penalty(hessian, gradient, z, 0);
    add_penalty(hessian, gradient, z, 2);
    const Weights<T> dz = solve(hessian, gradient);
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) z[i] -= dz[i];
  }
  return z;
}

/// Weights moved into the triangles: negative ones to 0, then onto the third edge by scaling.
template <class T> Weights<T> clamped(const Weights<T>& z) {
  Weights<T> r;
#pragma GCC unroll 4
  for (int k = 0; k < 4; k += 2) {
    const T v = max(z[k], T(0)), w = max(z[k + 1], T(0)), shrink = T(1) / max(v + w, T(1));
    r[k] = v * shrink;
    r[k + 1] = w * shrink;
  }
  return r;
}

/// The points (m, the pair's frame) that weights stand for.
template <class T> PointPair<T> points_at(const TrianglePair<T>& pair, const Weights<T>& z) {
  return {pair.a[0] + z[0] * (pair.a[1] - pair.a[0]) + z[1] * (pair.a[2] - pair.a[0]),
          pair.b[0] + z[2] * (pair.b[1] - pair.b[0]) + z[3] * (pair.b[2] - pair.b[0])};
}

} // namespace trigrain
