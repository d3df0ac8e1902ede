// Penalty Newton with a fixed number of steps over lanes: all pairs of one triangle of A with a pack of B at a time.
#include "kernels/iterative.hpp"
#include "kernels/certificate.hpp"
#include "kernels/newton.hpp"
#include "kernels/pack.hpp"

namespace trigrain {

[[gnu::flatten]] void iterative(TrianglesView a, TrianglesView b, double reach, std::vector<Hit>& hits,
                                KernelCounts& counts) {
  for (int i = 0; i < a.size; ++i) {
    const Corners<Lanes> ta = broadcast(a[i]);
    for (int first = 0; first < b.size; first += lane_count) {
      const TrianglePair<Lanes> pair = local_pair(ta, load_corners(b, first));
      const PointPair<Lanes> points = points_at(pair, clamped(newton(pair)));
      const Vec3<Lanes> u = points.p - points.q;
      const Lanes upper = sqrt(squared(u));
      const Lanes lower = min(proven_gap(gap_along(u, pair), pair.extent), upper);
      if (none_of(upper <= Lanes(reach))) continue;
      for (int lane = 0; lane < std::min(lane_count, b.size - first); ++lane)
        if (upper[lane] <= reach) hits.push_back({i, first + lane, answer_of(lane, pair, points, upper, lower)});
    }
  }
  const std::int64_t pairs = static_cast<std::int64_t>(a.size) * b.size;
  counts.triangle_pairs += pairs;
  counts.newton_steps += pairs * Penalty::steps;
}

} // namespace trigrain
