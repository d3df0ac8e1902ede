#include "kernels/sphere.hpp"
#include "kernels/lanes.hpp"
#include "kernels/point_triangle.hpp"

namespace trigrain {

SphereClosest closest_points(const Sphere& a, const Sphere& b) {
  const Vec3<double> u = a.centre - b.centre;
  const double distance = std::sqrt(squared(u));
  const Vec3<double> n = distance > 0 ? (1 / distance) * u : Vec3<double>{1, 0, 0}; // towards A
  return {a.centre - a.radius * n, b.centre + b.radius * n, distance - a.radius - b.radius};
}

PointOnTriangle closest_point(const Vec3<double>& point, const Triangle& t) {
  const Vec3<double> from_point =
      closest_on_triangle_by_zones({0, 0, 0}, {t.a0 - point, t.a1 - point, t.a2 - point}).point;
  return {from_point + point, squared(from_point)};
}

namespace {

/// Triangles first .. first + lane_count - 1, one per lane; lanes beyond the end hold padding.
Corners<Lanes> load_corners(const TrianglesView& t, int first) {
  const auto at = [&](int k) {
    const auto axis = [&](int c) { return load<Lanes>(t.coordinate[c] + first); };
    return Vec3<Lanes>{axis(k), axis(k + 1), axis(k + 2)};
  };
  return {at(0), at(3), at(6)};
}

/// Squared distance of the origin from the bounding box of a triangle.
Lanes box_distance2(const Corners<Lanes>& t) {
  const auto outside = [](const Lanes& u, const Lanes& v, const Lanes& w) {
    return max(max(min(min(u, v), w), -max(max(u, v), w)), Lanes(0));
  };
  return squared(
      Vec3<Lanes>{outside(t[0].x, t[1].x, t[2].x), outside(t[0].y, t[1].y, t[2].y), outside(t[0].z, t[1].z, t[2].z)});
}

} // namespace

[[gnu::flatten]] void closest_to_origin(TrianglesView t, std::vector<PointOnTriangle>& points) {
  points.resize(t.size);
  for (int first = 0; first < t.size; first += lane_count) {
    const Corners<Lanes> corners = load_corners(t, first);
    const auto [v, w] = closest_on_triangle({Lanes(0), Lanes(0), Lanes(0)}, corners);
    const Vec3<Lanes> point = corners[0] + v * (corners[1] - corners[0]) + w * (corners[2] - corners[0]);
    const Lanes distance2 = squared(point);
    for (int lane = 0; lane < std::min(lane_count, t.size - first); ++lane)
      points[first + lane] = {{point.x[lane], point.y[lane], point.z[lane]}, distance2[lane]};
  }
}

[[gnu::flatten]] void triangles_near_point(TrianglesView t, const Vec3<double>& centre, double reach,
                                           std::vector<int>& indices) {
  // What rounding can add to a distance, in units of the largest coordinate seen from the centre: corners, the point on
  // the triangle and the square root carry a few epsilon each.
  constexpr double slack = 16 * epsilon;
  if (reach < 0) return indices.clear();
  const Vec3<Lanes> c{Lanes(centre.x), Lanes(centre.y), Lanes(centre.z)};
  const Vec3<Lanes> origin{Lanes(0), Lanes(0), Lanes(0)};
  indices.resize(t.size);
  int n = 0;
  for (int first = 0; first < t.size; first += lane_count) {
    Corners<Lanes> local = load_corners(t, first);
    for (auto& corner : local) corner = corner - c;
    const Lanes extent =
        max(max(largest_coordinate(local[0]), largest_coordinate(local[1])), largest_coordinate(local[2]));
    const Lanes limit = Lanes(reach) + Lanes(slack) * extent;
    if (none_of(box_distance2(local) <= limit * limit)) continue;
    const auto [v, w] = closest_on_triangle(origin, local);
    const unsigned near =
        bits_of(squared(local[0] + v * (local[1] - local[0]) + w * (local[2] - local[0])) <= limit * limit);
    for (int lane = 0; lane < std::min(lane_count, t.size - first); ++lane) {
      indices[n] = first + lane;
      n += near >> lane & 1;
    }
  }
  indices.resize(n);
}

} // namespace trigrain
