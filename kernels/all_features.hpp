#pragma once
#include "kernels/triangle_frame.hpp"
#include "kernels/weights.hpp"

namespace trigrain {

/// The closest points found so far: their squared distance (m2), weights on A, and on B weights or one share.
template <class T, class OnB> struct Nearest {
  T distance2;
  Barycentric<T> on_a;
  OnB on_b;

  [[gnu::always_inline]] void compare(const Nearest& other) {
    const auto nearer = other.distance2 < distance2;
    distance2 = min(distance2, other.distance2);
    on_a = select(nearer, other.on_a, on_a);
    on_b = select(nearer, other.on_b, on_b);
  }
};

/// Weights of the point at a share of edge `number`, which leads from corner `number` to the next.
template <class T> [[gnu::always_inline]] inline Barycentric<T> on_edge(int number, const T& share) {
  if (number == 0) return {share, T(0)};
  if (number == 1) return {T(1) - share, share};
  return {T(0), T(1) - share};
}

/// The edges of A against an edge of B, in the frame of that edge: A's corners at `a`, the edge from (0, 0, 0) to
/// (length, 0, 0). Across it edge k of A is a segment and the line of the edge a point, whose closest share s0 is good
/// to rounding at any angle; then both shares are clamped in turn. Parallel edges: any s0 leads to a closest pair.
/// `inverse_edge2` is 1 / |edge k|^2. Of B it gives the place on the edge (m).
template <class T> [[gnu::always_inline]] inline Nearest<T, T>
nearest_on_edge(const Corners<T>& a, const std::array<T, 3>& inverse_edge2, const T& length) {
  const auto against = [&](int k) -> Nearest<T, T> {
    const Vec3<T>&r = a[k], u = r - a[(k + 1) % 3]; // back along edge k
    const T across_u = r.y * u.y + r.z * u.z;
    const T s0 = clamp01(across_u / positive(u.y * u.y + u.z * u.z));
    const T x = min(max(r.x - s0 * u.x, T(0)), length), along = r.x - x;
    const T s = clamp01((along * u.x + across_u) * inverse_edge2[k]);
    return {squared(Vec3<T>{along, r.y, r.z} - s * u), on_edge(k, s), x};
  };
  Nearest<T, T> nearest = against(0);
  nearest.compare(against(1));
  nearest.compare(against(2));
  return nearest;
}

/// The lowest of three corners over a face: where a corner's projection is closest, no other corner is lower.
template <class T> struct Lowest {
  T height; ///< not negative
  MaskOf<T> is1, is2;

  [[gnu::always_inline]] explicit Lowest(const std::array<T, 3>& heights) : height(abs(heights[0])) {
    is1 = abs(heights[1]) < height;
    height = min(height, abs(heights[1]));
    is2 = abs(heights[2]) < height;
    height = min(height, abs(heights[2]));
  }
  template <class X> [[gnu::always_inline]] X of(const X& x0, const X& x1, const X& x2) const {
    return select(is2, x2, select(is1, x1, x0));
  }
  [[gnu::always_inline]] Barycentric<T> weights() const { return {of(T(0), T(1), T(0)), of(T(0), T(0), T(1))}; }
};

/// d2 where the weights are inside their triangle, else the largest number.
template <class T> [[gnu::always_inline]] inline T if_inside(const Barycentric<T>& z, const T& d2) {
  const auto inside = (z.v >= T(0)) & (z.w >= T(0)) & (z.v + z.w <= T(1));
  return select(inside, d2, constant<T>(std::numeric_limits<ScalarOf<T>>::max()));
}

/// Weights of the closest points of a pair that does not cross, and where B has no area: they mean nothing there.
template <class T> struct ClosestWeights {
  Weights<T> z;
  MaskOf<T> doubtful;
};

/// The best of 15 features. The edges and the face of B are compared in B's own frame, where its corners are (0, 0, 0),
/// (x1, 0, 0) and (x2, y2, 0) and heights over its face are the third coordinate; the face of A in the frame of the
/// pair.
template <class T> [[gnu::always_inline]] inline ClosestWeights<T> closest_weights(const TrianglePair<T>& pair) {
  const Corners<T>&a = pair.a, &b = pair.b;
  const TriangleFrame<T> of_a(a[1], a[2]), of_b(b[1] - b[0], b[2] - b[0]); // a[0] is the origin

  const Vec3<T> normal_a = cross(of_a.e, of_a.m);
  const Lowest<T> lowest_b({dot(b[0], normal_a), dot(b[1], normal_a), dot(b[2], normal_a)});
  const Vec3<T> corner_b = lowest_b.of(b[0], b[1], b[2]);
  const Barycentric<T> on_a = of_a.project(dot(corner_b, of_a.e), dot(corner_b, of_a.m));
  const T over_a2 = (lowest_b.height * lowest_b.height) * (of_a.inverse_ee * of_a.inverse_mm);
  const T far = constant<T>(std::numeric_limits<ScalarOf<T>>::max());
  Nearest<T, Barycentric<T>> nearest{select(of_a.flat, far, if_inside(on_a, over_a2)), on_a, lowest_b.weights()};

  const T x1 = sqrt(of_b.ee), y2 = sqrt(of_b.mm), x2 = of_b.mu * x1;
  const T per_x1 = x1 * of_b.inverse_ee, per_y2 = y2 * of_b.inverse_mm;
  const auto corners_along = [&](const Vec3<T>& axis, const T& scale) {
    const T origin = dot(b[0], axis);
    return std::array<T, 3>{-origin * scale, (dot(a[1], axis) - origin) * scale, (dot(a[2], axis) - origin) * scale};
  };
  const std::array<T, 3> x = corners_along(of_b.e, per_x1), y = corners_along(of_b.m, per_y2),
                         z = corners_along(cross(of_b.e, of_b.m), per_x1 * per_y2);

  const Lowest<T> lowest_a(z);
  const T w = lowest_a.of(y[0], y[1], y[2]) * per_y2;
  const Barycentric<T> on_b{(lowest_a.of(x[0], x[1], x[2]) - w * x2) * per_x1, w};
  nearest.compare({if_inside(on_b, lowest_a.height * lowest_a.height), lowest_a.weights(), on_b});

  const Corners<T> in_b{Vec3<T>{x[0], y[0], z[0]}, Vec3<T>{x[1], y[1], z[1]}, Vec3<T>{x[2], y[2], z[2]}};
  const std::array<T, 3> inverse_edge2{of_a.inverse_ee, inverse_or_large(squared(a[2] - a[1])),
                                       inverse_or_large(squared(a[2]))};
  const auto compare_edges = [&](int l, const Corners<T>& in_edge, const T& length, const T& inverse_length) {
    const Nearest<T, T> n = nearest_on_edge(in_edge, inverse_edge2, length);
    const T share = min(n.on_b * (constant<T>(1 + 2 * epsilon_of<T>) * inverse_length), T(1)); // 1 at the end
    nearest.compare({n.distance2, n.on_a, on_edge(l, share)});
  };
  compare_edges(0, in_b, x1, per_x1);
  const PlaneEdge<T> edge1(x1, T(0), x2, y2), edge2(x2, y2, T(0), T(0));
  compare_edges(1, {edge1.seen(in_b[0]), edge1.seen(in_b[1]), edge1.seen(in_b[2])}, edge1.length, edge1.inverse_length);
  compare_edges(2, {edge2.seen(in_b[0]), edge2.seen(in_b[1]), edge2.seen(in_b[2])}, edge2.length, edge2.inverse_length);
  return {{nearest.on_a.v, nearest.on_a.w, nearest.on_b.v, nearest.on_b.w}, of_b.flat};
}

} // namespace trigrain
