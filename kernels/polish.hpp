#pragma once
#include "kernels/certificate.hpp"
#include "kernels/point_triangle.hpp"
#include "kernels/segment.hpp"
#include "kernels/weights.hpp"

namespace trigrain {

/// Weights solved exactly on the features an iterate points at, their points and distance, and the best gap over the
/// directions that should prove them (m, certificate.hpp).
template <class T> struct Polished {
  Weights<T> z;
  PointPair<T> points;
  T distance, gap;
};

/// The corner of a triangle of largest weight, with its own weights, and the edge opposite the smallest.
template <class T> struct NearFeatures {
  Vec3<T> corner, edge0, edge1;
  Barycentric<T> at_corner;
  MaskOf<T> skip0, skip1; ///< which corner the edge leaves out; neither: corner 2

  /// Weights of the point at share s of the edge.
  Barycentric<T> on_edge(const T& s) const {
    return {select(skip0, T(1) - s, select(skip1, T(0), s)), select(skip0 | skip1, s, T(0))};
  }
};

template <class T>
[[gnu::always_inline]] inline NearFeatures<T> features_at(const Corners<T>& t, const T& v, const T& w) {
  const T u = T(1) - v - w;
  const MaskOf<T> skip0 = (u <= v) & (u <= w), skip1 = (v <= w) & !skip0;
  const MaskOf<T> take0 = (u >= v) & (u >= w), take1 = v >= w;
  return {.corner = select(take0, t[0], select(take1, t[1], t[2])),
          .edge0 = select(skip0, t[1], t[0]),
          .edge1 = select(skip0 | skip1, t[2], t[1]),
          .at_corner = {select(take0, T(0), select(take1, T(1), T(0))), select(take0, T(0), select(take1, T(0), T(1)))},
          .skip0 = skip0,
          .skip1 = skip1};
}

/// u without its part along edge e, where that part is small: at a small gap u = p - q is mostly rounding, but at an
/// edge it must be normal to it.
template <class T> [[gnu::always_inline]] inline Vec3<T> normal_to(const Vec3<T>& e, const Vec3<T>& u) {
  const T ee = squared(e), ue = dot(u, e);
  return u - select(ue * ue < constant<T>(1e-4) * ee * squared(u), ue * inverse_or_zero(ee), T(0)) * e;
}

/// Takes the best of corner of A - B, A - corner of B, and edge - edge, for the features nearest to weights z: if
/// Newton found the right features, these are the closest points to rounding. Directions tried: normal of the face or
/// cross product of the edges, p - q, and p - q made normal to the edges.
template <class T> [[gnu::flatten]] Polished<T> polish(const TrianglePair<T>& pair, const Weights<T>& z) {
  const NearFeatures<T> a = features_at(pair.a, z[0], z[1]), b = features_at(pair.b, z[2], z[3]);
  const Vec3<T> edge_a = a.edge1 - a.edge0, edge_b = b.edge1 - b.edge0;
  const auto [s, t] = closest_on_segments(a.edge0, a.edge1, b.edge0, b.edge1);
  const Barycentric<T> za = a.on_edge(s), zb = b.on_edge(t);
  Weights<T> best{za.v, za.w, zb.v, zb.w};
  PointPair<T> points = points_at(pair, best);
  T best_d2 = squared(points.p - points.q);
  Vec3<T> normal = cross(edge_a, edge_b);
  const auto keep_nearer = [&](const Barycentric<T>& on_a, const Barycentric<T>& on_b, const Vec3<T>& face_normal) {
    const Weights<T> other{on_a.v, on_a.w, on_b.v, on_b.w};
    const PointPair<T> c = points_at(pair, other);
    const T d2 = squared(c.p - c.q);
    const auto nearer = d2 < best_d2;
    for (int k = 0; k < 4; ++k) best[k] = select(nearer, other[k], best[k]);
    points = {select(nearer, c.p, points.p), select(nearer, c.q, points.q)};
    normal = select(nearer, face_normal, normal);
    best_d2 = min(best_d2, d2);
  };
  keep_nearer(a.at_corner, closest_on_triangle(a.corner, pair.b), cross(pair.b[1] - pair.b[0], pair.b[2] - pair.b[0]));
  keep_nearer(closest_on_triangle(b.corner, pair.a), b.at_corner, cross(pair.a[1] - pair.a[0], pair.a[2] - pair.a[0]));
  const Vec3<T> u = points.p - points.q;
  const Vec3<T> towards_a = select(dot(u, normal) < T(0), T(-1) * normal, normal);
  const T gap = max(max(gap_along(towards_a, pair), gap_along(u, pair)),
                    gap_along(normal_to(edge_a, normal_to(edge_b, u)), pair));
  return {best, points, sqrt(best_d2), gap};
}

} // namespace trigrain
