#pragma once
#include "kernels/weights.hpp"

namespace trigrain {

/// A triangle with what its 15 comparisons share. Weights of a point's projection on its plane are v = r.to_v, w =
/// r.to_w with r = point - corner[0]; `outside` is 2 for a zero-area triangle, whose face has no inside, else 0.
template <class T> struct PreparedTriangle {
  Corners<T> corner, edge; ///< edge k leads from corner k to corner k + 1
  std::array<T, 3> edge2, inverse_edge2;
  Vec3<T> normal, to_v, to_w; ///< normal = edge[0] x -edge[2], not of unit length
  T outside;
  MaskOf<T> thin; ///< height below 1e-7 of the edges: weights on the face have lost digits that a double's answer needs
};

template <class T> [[gnu::always_inline]] inline PreparedTriangle<T> prepared(const Corners<T>& c) {
  PreparedTriangle<T> t;
  t.corner = c;
  t.edge = {c[1] - c[0], c[2] - c[1], c[0] - c[2]};
  for (int k = 0; k < 3; ++k) {
    t.edge2[k] = squared(t.edge[k]);
    t.inverse_edge2[k] = inverse_or_zero(t.edge2[k]);
  }
  const Vec3<T> f = c[2] - c[0];
  t.normal = cross(t.edge[0], f);
  const T nn = squared(t.normal);
  const auto flat = nn <= constant<T>(cross_noise<T>) * t.edge2[0] * t.edge2[2];
  const T inverse_nn = select(flat, T(0), inverse_or_zero(nn));
  t.to_v = inverse_nn * cross(f, t.normal);
  t.to_w = inverse_nn * cross(t.normal, t.edge[0]);
  t.outside = select(flat, T(2), T(0));
  t.thin = nn < constant<T>(1e-14) * t.edge2[0] * t.edge2[2];
  return t;
}

/// The best of the features compared so far: its squared distance (m2), its number and its two shares. Numbers 0-8:
/// edge k of A and edge l of B, number 3 k + l, shares along them; 9-11: corner k of A on the face of B, weights there;
/// 12-14: corner l of B on the face of A.
template <class T> struct NearestFeature {
  T distance2, number, s, t;

  [[gnu::always_inline]] void compare(const T& d2, int other, const T& other_s, const T& other_t) {
    const auto nearer = d2 < distance2;
    distance2 = min(distance2, d2);
    number = select(nearer, T(other), number);
    s = select(nearer, other_s, s);
    t = select(nearer, other_t, t);
  }
};

/// As closest_on_segments() (segment.hpp), with r = b0 - a0.
template <class T> [[gnu::always_inline]] inline void
compare_edges(const PreparedTriangle<T>& a, int k, const PreparedTriangle<T>& b, int l, NearestFeature<T>& best) {
  const Vec3<T>&u = a.edge[k], &v = b.edge[l], r = b.corner[l] - a.corner[k], n = cross(u, v);
  const T nn = squared(n), uv = dot(u, v), ru = dot(r, u), rv = dot(r, v);
  const auto crosses = nn > constant<T>(cross_noise<T>) * a.edge2[k] * b.edge2[l];
  const T on_lines = dot(cross(r, v), n) / select(crosses, nn, T(1));
  const T s0 = select(crosses, clamp01(on_lines), T(0));
  const T t = clamp01((uv * s0 - rv) * b.inverse_edge2[l]);
  const T s = clamp01((uv * t + ru) * a.inverse_edge2[k]);
  best.compare(squared(r + t * v - s * u), 3 * k + l, s, t);
}

/// A corner against a face, where it projects inside: with the rounding of the first projection projected again
/// (project_twice, point_triangle.hpp).
template <class T> [[gnu::always_inline]] inline void
compare_corner(const Vec3<T>& corner, const PreparedTriangle<T>& t, int number, NearestFeature<T>& best) {
  const Vec3<T> r = corner - t.corner[0];
  const T v1 = dot(r, t.to_v), w1 = dot(r, t.to_w);
  const Vec3<T> rest = r - v1 * t.edge[0] + w1 * t.edge[2];
  const T v2 = dot(rest, t.to_v), w2 = dot(rest, t.to_w), v = v1 + v2, w = w1 + w2;
  const auto inside = (v >= T(0)) & (w >= T(0)) & (v + w + t.outside <= T(1));
  const T d2 = squared(rest - v2 * t.edge[0] + w2 * t.edge[2]);
  best.compare(select(inside, d2, T(std::numeric_limits<ScalarOf<T>>::max())), number, v, w);
}

template <class T> [[gnu::always_inline]] inline NearestFeature<T> nearest_feature(const PreparedTriangle<T>& a,
                                                                                   const PreparedTriangle<T>& b) {
  NearestFeature<T> best{T(std::numeric_limits<ScalarOf<T>>::max()), T(0), T(0), T(0)};
#pragma GCC unroll 3
  for (int k = 0; k < 3; ++k)
#pragma GCC unroll 3
    for (int l = 0; l < 3; ++l) compare_edges(a, k, b, l, best);
#pragma GCC unroll 3
  for (int k = 0; k < 3; ++k) {
    compare_corner(a.corner[k], b, 9 + k, best);
    compare_corner(b.corner[k], a, 12 + k, best);
  }
  return best;
}

/// The weights in both triangles that a feature's number and shares stand for.
template <class T> [[gnu::always_inline]] inline Weights<T> weights_of(const NearestFeature<T>& f) {
  const T zero(0), one(1);
  const auto is = [&](int number) { return f.number == T(number); };
  const auto below = [&](int number) { return f.number < T(number); };
  const MaskOf<T> edges = below(9), corner_b = !below(12), corner_a = !edges & !corner_b;
  // which edge of A (0, 1, 2) and of B, where edges
  const MaskOf<T> a0 = below(3), a1 = below(6) & !a0, b0 = is(0) | is(3) | is(6), b1 = is(1) | is(4) | is(7);
  const auto on_edge_v = [&](const auto& e0, const auto& e1, const T& s) {
    return select(e0, s, select(e1, one - s, zero));
  };
  const auto on_edge_w = [&](const auto& e0, const auto& e1, const T& s) {
    return select(e0, zero, select(e1, s, one - s));
  };
  Weights<T> z;
  z[0] = select(edges, on_edge_v(a0, a1, f.s), select(corner_a, select(is(10), one, zero), f.s));
  z[1] = select(edges, on_edge_w(a0, a1, f.s), select(corner_a, select(is(11), one, zero), f.t));
  z[2] = select(edges, on_edge_v(b0, b1, f.t), select(corner_b, select(is(13), one, zero), f.s));
  z[3] = select(edges, on_edge_w(b0, b1, f.t), select(corner_b, select(is(14), one, zero), f.t));
  return z;
}

/// Weights of the closest points of a pair that does not cross, and whether a thin triangle makes them doubtful.
template <class T> struct ClosestWeights {
  Weights<T> z;
  MaskOf<T> doubtful;
};

template <class T> [[gnu::always_inline]] inline ClosestWeights<T> closest_weights(const TrianglePair<T>& pair) {
  const PreparedTriangle<T> a = prepared(pair.a), b = prepared(pair.b);
  return {weights_of(nearest_feature(a, b)), a.thin | b.thin};
}

} // namespace trigrain
