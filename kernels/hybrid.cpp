// The hybrid in two passes: a cheap separating direction disposes of far pairs; what survives is packed full and
// solved.
#include "kernels/hybrid.hpp"
#include "kernels/brute.hpp"
#include "kernels/certificate.hpp"
#include "kernels/newton.hpp"
#include "kernels/pack.hpp"
#include "kernels/polish.hpp"

namespace trigrain {
namespace {

// Between reach and a bound that decides on contact, in units of TrianglePair::extent, which is at most twice S =
// max(longest edge, largest coordinate): certificate and rounding of brute force's own distance, so that the decision
// is the one brute force takes.
template <class T> constexpr double decision_margin = certificate_rounding<T> + 4 * epsilon_of<T>;

/// Lanes whose separation along u alone exceeds reach.
template <class T> MaskOf<T> beyond(const T& reach, const T& gap, const TrianglePair<T>& pair) {
  return gap > reach + constant<T>(decision_margin<T>) * pair.extent;
}

/// Solves a pack and appends those within reach.
template <class T> [[gnu::noinline, gnu::flatten]] void solve(const PairPack<T>& pack, const PairList& list,
                                                              const Query& query, Hits& hits, KernelCounts& counts) {
  const TrianglePair<T>& pair = pack.pair();
  const T reach = constant<T>(query.reach);
  counts.newton_steps += static_cast<std::int64_t>(query.steps) * pack.size();
  const Weights<T> start = clamped(newton(pair, query));
  const PointPair<T> iterate = points_at(pair, start);
  const T first_gap = gap_along(iterate.p - iterate.q, pair);
  if (all_of(beyond(reach, first_gap, pair))) return;

  const auto [z, points, distance, polished_gap] = polish(pair, start);
  const T gap = max(first_gap, polished_gap), margin = constant<T>(decision_margin<T>) * pair.extent;
  const T lower = min(proven_gap(gap, pair.extent), distance);
  const unsigned far = bits_of(beyond(reach, gap, pair));
  const unsigned proven = bits_of((distance - gap <= constant<T>(query.tolerance) * pair.extent) &
                                  (distance + margin <= reach) & (lower > T(0)));
  const PackAnswer<T> answer{
      points.p,     points.q, distance, lower, distance + constant<T>(certificate_rounding<T>) * pair.extent,
      feature_of(z)};
  const unsigned redo = pack.used() & ~far & ~proven;
  if (redo == 0) return pack.append(answer, proven & ~far & pack.used(), hits);
  for (int lane = 0; lane < pack.size(); ++lane) {
    if (far >> lane & 1) continue;
    if (proven >> lane & 1) {
      pack.append(answer, 1u << lane, hits);
      continue;
    }
    ++counts.fall_backs;
    const auto [i, j] = pack.index(lane);
    Closest closest = closest_by_brute_force(list.a[i], list.b[j]);
    closest.fell_back = true;
    if (closest.distance <= query.reach) hits.push_back({i, j, closest});
  }
}

/// Bits of the lanes that the direction between the triangles' middles proves to be beyond reach.
template <class T> [[gnu::noinline, gnu::flatten]] unsigned apart(const PairPack<T>& pack, double reach) {
  const TrianglePair<T>& pair = pack.pair();
  const Vec3<T> u = pair.a[1] + pair.a[2] - (pair.b[0] + pair.b[1] + pair.b[2]); // a0 is the origin
  return bits_of(beyond(constant<T>(reach), gap_along(u, pair), pair));
}

} // namespace

template <class T> void hybrid_pair(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts) {
  constexpr int lanes = lanes_of<T>;
  std::array<PairIndex, 2 * lanes> waiting;
  int n = 0;
  const auto solve_first = [&](int count) {
    const PairList part{list.a, list.b, std::span<const PairIndex>(waiting).first(count)};
    solve(PairPack<T>(part), list, query, hits, counts);
  };
  for_each_pack<T>(list, [&](const PairPack<T>& pack) {
    const unsigned dropped = apart(pack, query.reach);
    for (int lane = 0; lane < pack.size(); ++lane) {
      waiting[n] = pack.index(lane);
      n += !(dropped >> lane & 1);
    }
    if (n < lanes) return;
    solve_first(lanes);
    std::copy(waiting.begin() + lanes, waiting.begin() + n, waiting.begin());
    n -= lanes;
  });
  if (n > 0) solve_first(n);
  counts.triangle_pairs += list.size();
}

template void hybrid_pair<double>(const PairList&, const Query&, Hits&, KernelCounts&);
template void hybrid_pair<Pack<double, 4>>(const PairList&, const Query&, Hits&, KernelCounts&);
template void hybrid_pair<Pack<double, 8>>(const PairList&, const Query&, Hits&, KernelCounts&);

} // namespace trigrain
