#pragma once
#include "kernels/certificate.hpp"
#include "kernels/newton.hpp"
#include "kernels/point_triangle.hpp"
#include "kernels/segment.hpp"

namespace trigrain {

/// Points solved exactly on the features an iterate points at, and the best gap over the directions that should prove
/// them (m, certificate.hpp).
template <class T> struct Polished {
  PointPair<T> points;
  T upper, gap;
};

template <class T, class Mask>
[[gnu::always_inline]] inline Vec3<T> select(const Mask& m, const Vec3<T>& yes, const Vec3<T>& no) {
  return {select(m, yes.x, no.x), select(m, yes.y, no.y), select(m, yes.z, no.z)};
}

/// The features of a triangle nearest to a point in it: the corner of largest weight and the edge opposite the
/// smallest.
template <class T> struct Features { Vec3<T> corner, edge0, edge1; };

template <class T> [[gnu::always_inline]] inline Features<T> features_at(const Corners<T>& t, const T& v, const T& w) {
  const T u = T(1) - v - w;
  const auto skip0 = (u <= v) & (u <= w), skip1 = v <= w;
  const auto take0 = (u >= v) & (u >= w), take1 = v >= w;
  return {select(take0, t[0], select(take1, t[1], t[2])), select(skip0, t[1], t[0]),
          select(skip0, t[2], select(skip1, t[2], t[1]))};
}

/// u without its part along edge e, where that part is small: at a small gap u = p - q is mostly rounding, but at an
/// edge it must be normal to it.
template <class T> [[gnu::always_inline]] inline Vec3<T> normal_to(const Vec3<T>& e, const Vec3<T>& u) {
  const T ee = squared(e), ue = dot(u, e);
  return u - select(ue * ue < T(1e-4) * ee * squared(u), ue * inverse_or_zero(ee), T(0)) * e;
}

/// Takes the best of corner of A - B, A - corner of B, and edge - edge, for the features nearest to weights z: if
/// Newton found the right features, these are the closest points to rounding. Directions tried: normal of the face or
/// cross product of the edges, p - q, and p - q made normal to the edges.
template <class T> [[gnu::flatten]] Polished<T> polish(const TrianglePair<T>& pair, const Weights<T>& z) {
  const Features<T> a = features_at(pair.a, z[0], z[1]), b = features_at(pair.b, z[2], z[3]);
  const Vec3<T> edge_a = a.edge1 - a.edge0, edge_b = b.edge1 - b.edge0;
  PointPair<T> best = closest_on_segments(a.edge0, a.edge1, b.edge0, b.edge1);
  T best_d2 = squared(best.p - best.q);
  Vec3<T> normal = cross(edge_a, edge_b);
  const auto keep_nearer = [&](const PointPair<T>& c, const Vec3<T>& face_normal) {
    const T d2 = squared(c.p - c.q);
    const auto nearer = d2 < best_d2;
    best = {select(nearer, c.p, best.p), select(nearer, c.q, best.q)};
    normal = select(nearer, face_normal, normal);
    best_d2 = min(best_d2, d2);
  };
  keep_nearer({a.corner, closest_on_triangle(a.corner, pair.b)}, cross(pair.b[1] - pair.b[0], pair.b[2] - pair.b[0]));
  keep_nearer({closest_on_triangle(b.corner, pair.a), b.corner}, cross(pair.a[1] - pair.a[0], pair.a[2] - pair.a[0]));
  const Vec3<T> u = best.p - best.q;
  const Vec3<T> towards_a = select(dot(u, normal) < T(0), T(-1) * normal, normal);
  const T gap = max(max(gap_along(towards_a, pair), gap_along(u, pair)),
                    gap_along(normal_to(edge_a, normal_to(edge_b, u)), pair));
  return {best, sqrt(best_d2), gap};
}

} // namespace trigrain
