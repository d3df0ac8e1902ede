#pragma once
#include "kernels/point_triangle.hpp"
#include "kernels/weights.hpp"
#include <algorithm>

namespace trigrain {

/// A triangle with what its 15 comparisons share. Weights of a point's projection on its plane are v = r.to_v, w =
/// r.to_w with r = point - corner[0]; `outside` is 2 for a zero-area triangle, whose face has no inside, else 0.
template <class T> struct PreparedTriangle {
  Corners<T> edge; ///< edge k leads from corner k to corner k + 1
  std::array<T, 3> edge2, inverse_edge2;
  Vec3<T> normal, to_v, to_w; ///< normal = edge[0] x edge[1], not of unit length
  T inverse_nn;               ///< of |normal|^2; 0 for a zero-area triangle
  T outside;
  MaskOf<T> slim; ///< largest angle within 0.03 of pi: heights over the face are too inexact to choose a corner by
  MaskOf<T> thin; ///< height below 1e-7 (float: 1e-4) of the edges: weights on the face have lost digits that the
                  ///< answer needs
};

template <class T> [[gnu::always_inline]] inline PreparedTriangle<T> prepared(const Corners<T>& c) {
  PreparedTriangle<T> t;
  t.edge = {c[1] - c[0], c[2] - c[1], c[0] - c[2]};
  for (int k = 0; k < 3; ++k) {
    t.edge2[k] = squared(t.edge[k]);
    t.inverse_edge2[k] = T(1) / max(t.edge2[k], constant<T>(std::numeric_limits<ScalarOf<T>>::min()));
  }
  const MaskOf<T> longest0 = (t.edge2[0] >= t.edge2[1]) & (t.edge2[0] >= t.edge2[2]),
                  longest1 = t.edge2[1] >= t.edge2[2];
  const auto after_longest = [&](int k) {
    return select(longest0, t.edge[(1 + k) % 3], select(longest1, t.edge[(2 + k) % 3], t.edge[k]));
  };
  t.normal = cross(after_longest(0), after_longest(1)); // of the largest angle: most exact
  const T nn = squared(t.normal);
  const T two_shorter = min(min(t.edge2[0] * t.edge2[1], t.edge2[1] * t.edge2[2]), t.edge2[2] * t.edge2[0]);
  const auto flat = nn <= constant<T>(cross_noise<T>) * two_shorter;
  const Vec3<T> f = c[2] - c[0];
  t.inverse_nn = select(flat, T(0), inverse_or_zero(nn));
  t.to_v = t.inverse_nn * cross(f, t.normal);
  t.to_w = t.inverse_nn * cross(t.normal, t.edge[0]);
  t.outside = select(flat, T(2), T(0));
  t.slim = nn < constant<T>(1e-3) * two_shorter;
  t.thin = nn < constant<T>(std::max(1e-14, epsilon_of<T> / 10)) * (t.edge2[0] * t.edge2[2]);
  return t;
}

/// The best of the features compared so far: its squared distance (m2), its number and its two shares. Numbers 0-8:
/// edge k of A and edge l of B, number 3 k + l, shares along them; 9-11: corner k of A on the face of B, weights there;
/// 12-14: corner l of B on the face of A.
template <class T> struct NearestFeature {
  T distance2, number, s, t;

  [[gnu::always_inline]] void compare(const T& d2, const T& other, const T& other_s, const T& other_t) {
    const auto nearer = d2 < distance2;
    distance2 = min(distance2, d2);
    number = select(nearer, other, number);
    s = select(nearer, other_s, s);
    t = select(nearer, other_t, t);
  }
};

/// The corners of A, seen from corner l of B, along edge l of B (in edge lengths) and across it (m).
template <class T> struct CornersAlongEdge {
  Corners<T> r, across;
  std::array<T, 3> along;
};

template <class T> [[gnu::always_inline]] inline CornersAlongEdge<T>
corners_along_edge(const Corners<T>& a, const Vec3<T>& corner_b, const PreparedTriangle<T>& b, int l) {
  CornersAlongEdge<T> c;
  for (int k = 0; k < 3; ++k) {
    c.r[k] = a[k] - corner_b;
    c.along[k] = dot(c.r[k], b.edge[l]) * b.inverse_edge2[l];
    c.across[k] = c.r[k] - c.along[k] * b.edge[l];
  }
  return c;
}

/// Edge k of A against edge l of B. Across the direction of edge l, edge k is a segment and the line of edge l a point,
/// whose closest share s0 is good to rounding at any angle; then both shares are clamped in turn. Parallel edges: any
/// s0 leads to a closest pair.
template <class T>
[[gnu::always_inline]] inline void compare_edges(const PreparedTriangle<T>& a, int k, const PreparedTriangle<T>& b,
                                                 int l, const CornersAlongEdge<T>& c, NearestFeature<T>& best) {
  const int next = (k + 1) % 3;
  const Vec3<T>&u = a.edge[k], w = c.across[next] - c.across[k];
  const T s0 = clamp01(-dot(c.across[k], w) / max(squared(w), constant<T>(std::numeric_limits<ScalarOf<T>>::min())));
  const T t = clamp01(c.along[k] + s0 * (c.along[next] - c.along[k]));
  const Vec3<T> y = c.r[k] - t * b.edge[l];
  const T s = clamp01(-dot(y, u) * a.inverse_edge2[k]);
  best.compare(squared(y + s * u), T(3 * k + l), s, t);
}

/// Takes a corner that projects on the face of t with weights v and w, if that is inside; `rest` leads to the corner.
template <class T> [[gnu::always_inline]] inline void compare_projection(const T& v, const T& w, const Vec3<T>& rest,
                                                                         const PreparedTriangle<T>& t, const T& number,
                                                                         NearestFeature<T>& best) {
  const auto inside = (v >= T(0)) & (w >= T(0)) & (v + w + t.outside <= T(1));
  best.compare(select(inside, squared(rest), T(std::numeric_limits<ScalarOf<T>>::max())), number, v, w);
}

/// A corner against a face, where it projects inside: with the rounding of the first projection projected again
/// (project_twice, point_triangle.hpp). r leads from the face's corner 0 to the corner.
template <class T> [[gnu::always_inline]] inline void compare_corner(const Vec3<T>& r, const PreparedTriangle<T>& t,
                                                                     const T& number, NearestFeature<T>& best) {
  const T v1 = dot(r, t.to_v), w1 = dot(r, t.to_w);
  const Vec3<T> rest = r - v1 * t.edge[0] + w1 * t.edge[2];
  const T v2 = dot(rest, t.to_v), w2 = dot(rest, t.to_w);
  compare_projection(v1 + v2, w1 + w2, rest - v2 * t.edge[0] + w2 * t.edge[2], t, number, best);
}

/// The same for a slim face, whose to_v and to_w have lost digits: by cross products.
template <class T> [[gnu::always_inline]] inline void
compare_corner_with_slim(const Vec3<T>& r, const PreparedTriangle<T>& t, int number, NearestFeature<T>& best) {
  const Vec3<T> f = T(-1) * t.edge[2];
  const Barycentric<T> z = project_twice(r, t.edge[0], f, t.normal, t.inverse_nn);
  compare_projection(z.v, z.w, r - (z.v * t.edge[0] + z.w * f), t, T(number), best);
}

/// The corners of triangle c against the face of t. Where a corner's projection is closest, no other corner is lower:
/// one comparison does.
template <class T> [[gnu::always_inline]] inline void compare_corners(const Corners<T>& c, const Vec3<T>& corner_t,
                                                                      const PreparedTriangle<T>& t, int number,
                                                                      NearestFeature<T>& best) {
  const Corners<T> r{c[0] - corner_t, c[1] - corner_t, c[2] - corner_t};
  Vec3<T> lowest = r[0];
  T height = abs(dot(r[0], t.normal)), which(number);
  for (int k = 1; k < 3; ++k) {
    const T other = abs(dot(r[k], t.normal));
    const auto lower = other < height;
    height = min(height, other);
    lowest = select(lower, r[k], lowest);
    which = select(lower, T(number + k), which);
  }
  compare_corner(lowest, t, which, best);
}

template <class T> [[gnu::always_inline]] inline NearestFeature<T>
nearest_feature(const TrianglePair<T>& pair, const PreparedTriangle<T>& a, const PreparedTriangle<T>& b) {
  NearestFeature<T> best{T(std::numeric_limits<ScalarOf<T>>::max()), T(0), T(0), T(0)};
#pragma GCC unroll 3
  for (int l = 0; l < 3; ++l) {
    const CornersAlongEdge<T> c = corners_along_edge(pair.a, pair.b[l], b, l);
#pragma GCC unroll 3
    for (int k = 0; k < 3; ++k) compare_edges(a, k, b, l, c, best);
  }
  compare_corners(pair.a, pair.b[0], b, 9, best);
  compare_corners(pair.b, pair.a[0], a, 12, best);
  if (any_of(b.slim))
    for (int k = 0; k < 3; ++k) compare_corner_with_slim(pair.a[k] - pair.b[0], b, 9 + k, best);
  if (any_of(a.slim))
    for (int k = 0; k < 3; ++k) compare_corner_with_slim(pair.b[k] - pair.a[0], a, 12 + k, best);
  return best;
}

/// The weights in both triangles that a feature's number and shares stand for.
template <class T> [[gnu::always_inline]] inline Weights<T> weights_of(const NearestFeature<T>& f) {
  const T zero(0), one(1);
  const auto is = [&](int number) { return f.number == T(number); };
  const auto below = [&](int number) { return f.number < T(number); };
  const MaskOf<T> edges = below(9), corner_b = !below(12), corner_a = !(edges | corner_b);
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
  const MaskOf<T> doubtful = a.thin | b.thin;
  return {weights_of(nearest_feature(pair, a, b)), doubtful};
}

} // namespace trigrain
