// Brute force with branches: the published baseline of Krestenitis (2018), 15 features and a crossing test.
#include "kernels/brute.hpp"
#include "kernels/certificate.hpp"
#include "kernels/crossing.hpp"
#include "kernels/point_triangle.hpp"
#include "kernels/segment.hpp"

namespace trigrain {
namespace {

/// Points on two triangles and what they lie on (Features).
struct Candidate {
  PointPair<double> points;
  int feature;
};

/// Edge k of A and edge l of B.
Candidate edge_edge(const TrianglePair<double>& pair, int k, int l) {
  const auto corners_of = [](double share, int edge) {
    return share <= 0 ? 1 << edge : share >= 1 ? 1 << (edge + 1) % 3 : 1 << edge | 1 << (edge + 1) % 3;
  };
  const Vec3<double>&a0 = pair.a[k], &a1 = pair.a[(k + 1) % 3], &b0 = pair.b[l], &b1 = pair.b[(l + 1) % 3];
  const auto [s, t] = closest_on_segments(a0, a1, b0, b1);
  return {{a0 + s * (a1 - a0), b0 + t * (b1 - b0)}, corners_of(s, k) | corners_of(t, l) << Features::shift_b};
}

/// Best of 6 corner-triangle and 9 edge-edge features.
Candidate closest_features(const TrianglePair<double>& pair) {
  Candidate best{};
  double best_d2 = std::numeric_limits<double>::max();
  const auto keep_nearer = [&](const Candidate& candidate) {
    const double d2 = squared(candidate.points.p - candidate.points.q);
    if (d2 < best_d2) best = candidate, best_d2 = d2;
  };
  for (int k = 0; k < 3; ++k) {
    const ZonePoint q = closest_on_triangle_by_zones(pair.a[k], pair.b);
    keep_nearer({{pair.a[k], q.point}, 1 << k | q.corners << Features::shift_b});
    const ZonePoint p = closest_on_triangle_by_zones(pair.b[k], pair.a);
    keep_nearer({{p.point, pair.b[k]}, p.corners | 1 << k << Features::shift_b});
  }
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l) keep_nearer(edge_edge(pair, k, l));
  return best;
}

/// Triangles that are apart by less than rounding can show, and came out as one point: moves q by a few epsilon towards
/// the middle of B, so that the answer is not zero and has a direction.
void separate(PointPair<double>& points, const TrianglePair<double>& pair, const Vec3<double>& origin) {
  const Vec3<double> middle = (1. / 3) * (pair.b[0] + pair.b[1] + pair.b[2] - pair.a[1] - pair.a[2]);
  const double x = std::fabs(middle.x), y = std::fabs(middle.y), z = std::fabs(middle.z);
  const auto axis = x >= y && x >= z ? &Vec3<double>::x : y >= z ? &Vec3<double>::y : &Vec3<double>::z;
  points.q.*axis += std::copysign(4 * epsilon * std::max(pair.extent, largest_coordinate(origin)), middle.*axis);
}

} // namespace

Closest closest_by_brute_force(const Triangle& a, const Triangle& b) {
  const TrianglePair<double> pair = local_pair(corners(a), corners(b));
  auto [points, feature] = closest_features(pair);
  const double lower = proven_gap(gap_along(points.p - points.q, pair), pair.extent);
  if (lower == 0) { // not proven apart: ask exactly
    if (const auto common = common_point(a, b, points.p + a.a0))
      return {*common, *common, 0, 0, 0, Features::of_a | Features::of_b};
    if (squared(points.p - points.q) == 0) separate(points, pair, a.a0);
  }
  const double distance = std::sqrt(squared(points.p - points.q));
  return {points.p + a.a0,
          points.q + a.a0,
          distance,
          std::min(lower, distance),
          distance + certificate_rounding<double> * pair.extent,
          static_cast<std::uint8_t>(feature)};
}

void brute(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts) {
  for (const auto& [i, j] : list.pairs) {
    const Closest closest = closest_by_brute_force(list.a[i], list.b[j]);
    if (closest.distance <= query.reach) hits.push_back({i, j, closest});
  }
  counts.triangle_pairs += list.size();
}

} // namespace trigrain
