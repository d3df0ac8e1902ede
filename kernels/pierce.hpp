#pragma once
#include "kernels/triangle_pair.hpp"

namespace trigrain {

/// Whether the triangles have a point in common, as far as rounding can tell, and such a point of the pairs that do.
template <class T> struct Pierced {
  MaskOf<T> surely, surely_not;
  Vec3<T> point; ///< m, where surely
};

template <class T> [[gnu::always_inline]] inline Corners<T> edges_of(const Corners<T>& t) {
  return {t[1] - t[0], t[2] - t[1], t[0] - t[2]};
}

/// An edge of one triangle through the face of the other: signs of two heights and three volumes. Guigue, Devillers
/// (2003) for the predicates. A value counts as signed if it is larger than its rounding can be: six products of which
/// none exceeds 2 L L' extent (edges up to L and L', a difference of corners up to 2 extent), each good to 13 epsilon /
/// 2 (corners and differences 6, Shewchuk's (1997) bound of the volume 7): 78 epsilon; 96 leaves a margin.
template <class T> [[gnu::noinline, gnu::flatten]] Pierced<T> pierce(const TrianglePair<T>& pair) {
  const Corners<T>&a = pair.a, &b = pair.b, u = edges_of(a), v = edges_of(b);
  const Vec3<T> normal_a = cross(u[0], u[1]), normal_b = cross(v[0], v[1]);
  const auto longest = [](const Corners<T>& edges) {
    return max(max(largest_coordinate(edges[0]), largest_coordinate(edges[1])), largest_coordinate(edges[2]));
  };
  const T unit = constant<T>(96 * epsilon_of<T>) * pair.extent, la = longest(u), lb = longest(v);
  const T volume_doubt = unit * la * lb, a_doubt = unit * lb * lb, b_doubt = unit * la * la;
  // volume[k][l]: edge k of A against edge l of B, (u x v).r
  std::array<std::array<T, 3>, 3> volume;
  std::array<T, 3> height_a, height_b; // corners of A over the plane of B, of B over that of A
  for (int k = 0; k < 3; ++k) {
    for (int l = 0; l < 3; ++l) volume[k][l] = dot(cross(u[k], v[l]), b[l] - a[k]);
    height_a[k] = dot(a[k] - b[0], normal_b);
    height_b[k] = dot(b[k] - a[0], normal_a);
  }
  Pierced<T> r{.surely = la < T(0), .surely_not = la >= T(0), .point = a[0]};
  // An edge that nearly lies in the plane, or a face that is nearly flat, puts the point off by more than the rounding
  // of the corners: sines below this are left in doubt.
  T steepest = constant<T>(0.05);
  const auto try_edge = [&](const Vec3<T>& corner, const Vec3<T>& edge, const T& doubt, const T& size, const T& h0,
                            const T& h1, const T& v0, const T& v1, const T& v2) {
    const auto up0 = h0 > doubt, down0 = h0<-doubt, up1 = h1> doubt, down1 = h1 < -doubt;
    const T least = min(min(v0, v1), v2), most = max(max(v0, v1), v2);
    const auto above = least > volume_doubt, below = most < -volume_doubt;
    const auto some_above = most > volume_doubt, some_below = least < -volume_doubt;
    const auto hit = ((up0 & down1) | (down0 & up1)) & (above | below) & (abs(h0 - h1) > steepest * size);
    steepest = select(hit, abs(h0 - h1) / size, steepest);
    const auto miss = (up0 & up1) | (down0 & down1) | (some_above & some_below);
    const T s = clamp01(h0 / select(hit, h0 - h1, T(1)));
    r.point = select(hit, corner + s * edge, r.point);
    r.surely = r.surely | hit;
    r.surely_not = r.surely_not & miss;
  };
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    try_edge(a[k], u[k], a_doubt, la * lb * lb, height_a[k], height_a[next], volume[k][0], volume[k][1], volume[k][2]);
    try_edge(b[k], v[k], b_doubt, lb * la * la, height_b[k], height_b[next], volume[0][k], volume[1][k], volume[2][k]);
  }
  return r;
}

} // namespace trigrain
