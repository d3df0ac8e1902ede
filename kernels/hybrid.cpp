// The hybrid in two passes: a cheap separating direction disposes of far pairs; what survives is packed full and
// solved.
#include "kernels/hybrid.hpp"
#include "kernels/brute.hpp"
#include "kernels/certificate.hpp"
#include "kernels/newton.hpp"
#include "kernels/pack.hpp"
#include "kernels/polish.hpp"
#include <span>

namespace trigrain {
namespace {

// In units of TrianglePair::extent, which is at most twice S = max(longest edge, largest coordinate).
// Between reach and a bound that decides on contact: certificate and rounding of brute force's own distance, so that
// the decision is the one brute force takes.
constexpr double decision_margin = certificate_rounding + 4 * epsilon;
// Upper minus lower bound of an accepted answer. Its error is at most this plus certificate_rounding: 2 (6 + 12)
// epsilon = 0.8e-14 S.
constexpr double tolerance = 6 * epsilon;

struct PairIndex {
  int i, j;
};

/// Lanes whose separation along u alone exceeds reach.
LaneMask beyond(const Lanes& reach, const Lanes& gap, const TrianglePair<Lanes>& pair) {
  return gap > reach + Lanes(decision_margin) * pair.extent;
}

/// Solves up to lane_count pairs; appends those within reach.
[[gnu::noinline]] void solve_pack(TrianglesView a, TrianglesView b, std::span<const PairIndex> pairs, double reach,
                                  std::vector<Hit>& hits, KernelCounts& counts) {
  const int last = static_cast<int>(pairs.size()) - 1;
  const TrianglePair<Lanes> pair =
      local_pair(gather_corners(a, [&](int lane) { return pairs[std::min(lane, last)].i; }),
                 gather_corners(b, [&](int lane) { return pairs[std::min(lane, last)].j; }));
  counts.newton_steps += static_cast<std::int64_t>(pairs.size()) * Penalty::steps;
  const Weights<Lanes> z = clamped(newton(pair));
  const PointPair<Lanes> iterate = points_at(pair, z);
  const Lanes first_gap = gap_along(iterate.p - iterate.q, pair);
  if (all_of(beyond(reach, first_gap, pair))) return;

  const auto [points, upper, polished_gap] = polish(pair, z);
  const Lanes gap = max(first_gap, polished_gap);
  const Lanes margin = Lanes(decision_margin) * pair.extent;
  const LaneMask far = beyond(reach, gap, pair);
  const Lanes lower = min(proven_gap(gap, pair.extent), upper);
  const LaneMask proven = (upper - gap <= Lanes(tolerance) * pair.extent) & (upper + margin <= reach) & (lower > 0);
  for (int lane = 0; lane <= last; ++lane) {
    if (far[lane]) continue;
    const auto [i, j] = pairs[lane];
    if (proven[lane]) {
      hits.push_back({i, j, answer_of(lane, pair, points, upper, lower)});
      continue;
    }
    ++counts.fall_backs;
    Closest closest = closest_by_brute_force(a[i], b[j]);
    closest.fell_back = true;
    if (closest.upper <= reach) hits.push_back({i, j, closest});
  }
}

/// Lanes that the direction between the triangles' middles proves to be beyond reach.
LaneMask apart(const TrianglePair<Lanes>& pair, double reach) {
  const Vec3<Lanes> u = pair.a[1] + pair.a[2] - (pair.b[0] + pair.b[1] + pair.b[2]); // a0 is the origin
  return beyond(reach, gap_along(u, pair), pair);
}

} // namespace

void hybrid_pair(TrianglesView a, TrianglesView b, double reach, std::vector<Hit>& hits, KernelCounts& counts) {
  std::array<PairIndex, 2 * lane_count> waiting;
  int n = 0;
  for (int i = 0; i < a.size; ++i) {
    const Corners<Lanes> ta = broadcast(a[i]);
    for (int first = 0; first < b.size; first += lane_count) {
      const LaneMask dropped = apart(local_pair(ta, load_corners(b, first)), reach);
      if (all_of(dropped)) continue;
      for (int lane = 0; lane < std::min(lane_count, b.size - first); ++lane) {
        waiting[n] = {i, first + lane};
        n += !dropped[lane];
      }
      if (n < lane_count) continue;
      solve_pack(a, b, std::span(waiting).first(lane_count), reach, hits, counts);
      std::copy(waiting.begin() + lane_count, waiting.begin() + n, waiting.begin());
      n -= lane_count;
    }
  }
  if (n > 0) solve_pack(a, b, std::span(waiting).first(n), reach, hits, counts);
  counts.triangle_pairs += static_cast<std::int64_t>(a.size) * b.size;
}

} // namespace trigrain
