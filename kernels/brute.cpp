// Brute force with branches: the published baseline of Krestenitis (2018), 15 features and a crossing test.
#include "kernels/brute.hpp"
#include "kernels/certificate.hpp"
#include "kernels/crossing.hpp"
#include "kernels/point_triangle.hpp"
#include "kernels/segment.hpp"

namespace trigrain {
namespace {

/// Best of 6 corner-triangle and 9 edge-edge features.
PointPair<double> closest_features(const TrianglePair<double>& pair) {
  PointPair<double> best{};
  double best_d2 = std::numeric_limits<double>::max();
  const auto keep_nearer = [&](const PointPair<double>& candidate) {
    const double d2 = squared(candidate.p - candidate.q);
    if (d2 < best_d2) best = candidate, best_d2 = d2;
  };
  for (int k = 0; k < 3; ++k) {
    keep_nearer({pair.a[k], closest_on_triangle_by_zones(pair.a[k], pair.b)});
    keep_nearer({closest_on_triangle_by_zones(pair.b[k], pair.a), pair.b[k]});
  }
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l)
      keep_nearer(closest_on_segments(pair.a[k], pair.a[(k + 1) % 3], pair.b[l], pair.b[(l + 1) % 3]));
  return best;
}

/// Triangles that are apart by less than rounding can show, and came out as one point: moves q by a few epsilon towards
/// the middle of B, so that the answer is not zero and has a direction.
void separate(PointPair<double>& points, const TrianglePair<double>& pair) {
  const Vec3<double> middle = (1. / 3) * (pair.b[0] + pair.b[1] + pair.b[2] - pair.a[1] - pair.a[2]);
  const double x = std::fabs(middle.x), y = std::fabs(middle.y), z = std::fabs(middle.z);
  const auto axis = x >= y && x >= z ? &Vec3<double>::x : y >= z ? &Vec3<double>::y : &Vec3<double>::z;
  points.q.*axis += std::copysign(4 * epsilon * std::max(pair.extent, largest_coordinate(pair.origin)), middle.*axis);
}

} // namespace

Closest closest_by_brute_force(const Triangle& a, const Triangle& b) {
  const TrianglePair<double> pair = local_pair(corners(a), corners(b));
  PointPair<double> points = closest_features(pair);
  const double lower = proven_gap(gap_along(points.p - points.q, pair), pair.extent);
  if (lower == 0) { // not proven apart: ask exactly
    if (const auto common = common_point(a, b, points.p + pair.origin)) return {*common, *common, 0, 0};
    if (squared(points.p - points.q) == 0) separate(points, pair);
  }
  const double upper = std::sqrt(squared(points.p - points.q));
  return {points.p + pair.origin, points.q + pair.origin, upper, std::min(lower, upper)};
}

void brute(TrianglesView a, TrianglesView b, double reach, std::vector<Hit>& hits, KernelCounts& counts) {
  for (int i = 0; i < a.size; ++i) {
    const Triangle ta = a[i];
    for (int j = 0; j < b.size; ++j) {
      const Closest closest = closest_by_brute_force(ta, b[j]);
      if (closest.upper <= reach) hits.push_back({i, j, closest});
    }
  }
  counts.triangle_pairs += static_cast<std::int64_t>(a.size) * b.size;
}

} // namespace trigrain
