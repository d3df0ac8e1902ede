#pragma once
#include "kernels/kernels.hpp"
#include "kernels/weights.hpp"

namespace trigrain {

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
template <class T>
void add_penalty(Symmetric4<T>& hessian, Weights<T>& gradient, const Weights<T>& z, int k, const T& twice) {
  const T zero(0);
  const T low0 = min(z[k], zero), low1 = min(z[k + 1], zero), over = max(z[k] + z[k + 1] - T(1), zero);
  const T on_over = select(over > zero, twice, zero);
  hessian[k][k] += select(low0 < zero, twice, zero) + on_over;
  hessian[k + 1][k + 1] += select(low1 < zero, twice, zero) + on_over;
  hessian[k + 1][k] += on_over;
  gradient[k] += twice * (low0 + over);
  gradient[k + 1] += twice * (low1 + over);
}

/// Weights after query.steps Newton steps for the closest points of a pair; near the triangles, not in them.
/// Krestenitis (2018), Krestenitis, Weinzierl, Koziara (2017): minimise |x - y|^2 plus a penalty on z outside.
template <class T> [[gnu::flatten]] Weights<T> newton(const TrianglePair<T>& pair, const Query& query) {
  constexpr double start_weight = 0.33; // the middles
  const T twice = constant<T>(2 * query.schedule->weight);
  double damping = query.schedule->damping;
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
  z.fill(constant<T>(start_weight));
  for (int step = 0; step < query.steps; ++step, damping *= query.schedule->growth) {
    Symmetric4<T> hessian = h;
    Weights<T> gradient = offset;
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
#pragma GCC unroll 4
      for (int j = 0; j < 4; ++j) gradient[i] += h[std::max(i, j)][std::min(i, j)] * z[j];
      hessian[i][i] += constant<T>(damping);
    }
    add_penalty(hessian, gradient, z, 0, twice);
    add_penalty(hessian, gradient, z, 2, twice);
    const Weights<T> dz = solve(hessian, gradient);
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) z[i] -= dz[i];
  }
  return z;
}

/// Weights moved into the triangles: negative ones to 0, then onto the third edge by scaling. What Newton left infinite
/// or not a number, as it may without damping, becomes some point of the triangle.
template <class T> Weights<T> clamped(const Weights<T>& z) {
  Weights<T> r;
#pragma GCC unroll 4
  for (int k = 0; k < 4; k += 2) {
    const auto positive = [](const T& x) { return select(x > T(0), min(x, constant<T>(1e30)), T(0)); };
    const T v = positive(z[k]), w = positive(z[k + 1]), shrink = T(1) / max(v + w, T(1));
    r[k] = v * shrink;
    r[k + 1] = w * shrink;
  }
  return r;
}

} // namespace trigrain
