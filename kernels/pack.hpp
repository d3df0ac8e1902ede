#pragma once
#include "kernels/kernels.hpp"
#include "kernels/triangle_pair.hpp"

namespace trigrain {

/// One triangle in all lanes.
inline Corners<Lanes> broadcast(const Triangle& t) {
  const auto all = [](const Vec3<double>& v) { return Vec3<Lanes>{Lanes(v.x), Lanes(v.y), Lanes(v.z)}; };
  return {all(t.a0), all(t.a1), all(t.a2)};
}

/// Triangles first .. first + lane_count - 1, one per lane; lanes beyond the end hold padding.
inline Corners<Lanes> load_corners(const TrianglesView& t, int first) {
  const auto& c = t.coordinate;
  const auto at = [&](int k) {
    return Vec3<Lanes>{load(c[k] + first), load(c[k + 1] + first), load(c[k + 2] + first)};
  };
  return {at(0), at(3), at(6)};
}

/// Triangles index(0) .. index(lane_count - 1), one per lane.
template <class Index> Corners<Lanes> gather_corners(const TrianglesView& t, Index index) {
  const auto at = [&](int k) {
    const auto axis = [&](int c) {
      return Lanes([&](auto lane) { return t.coordinate[c][index(static_cast<int>(lane))]; });
    };
    return Vec3<Lanes>{axis(k), axis(k + 1), axis(k + 2)};
  };
  return {at(0), at(3), at(6)};
}

/// One lane's answer, back in the world's frame.
inline Closest answer_of(int lane, const TrianglePair<Lanes>& pair, const PointPair<Lanes>& points, const Lanes& upper,
                         const Lanes& lower) {
  const auto one = [&](const Vec3<Lanes>& v) { return Vec3<double>{v.x[lane], v.y[lane], v.z[lane]}; };
  const Vec3<double> origin = one(pair.origin);
  return {one(points.p) + origin, one(points.q) + origin, upper[lane], lower[lane]};
}

} // namespace trigrain
