// Penalty Newton with a fixed number of steps, over lanes.
#include "kernels/iterative.hpp"
#include "kernels/certificate.hpp"
#include "kernels/newton.hpp"
#include "kernels/pack.hpp"

namespace trigrain {
namespace {

template <class T> [[gnu::noinline, gnu::flatten]] void solve(const PairPack<T>& pack, const Query& query, Hits& hits) {
  const TrianglePair<T>& pair = pack.pair();
  const Weights<T> z = clamped(newton(pair, query));
  const PointPair<T> points = points_at(pair, z);
  const Vec3<T> u = points.p - points.q;
  const T distance = sqrt(squared(u));
  const unsigned within = bits_of(distance <= pack.in_units(query.reach)) & pack.used();
  if (within == 0) return;
  const T lower = min(proven_gap(gap_along(u, pair), pair.extent), distance);
  const T upper = distance + constant<T>(certificate_rounding<T>) * pair.extent;
  pack.append({points.p, points.q, distance, lower, upper, feature_of(z)}, within, hits);
}

} // namespace

template <class T> void iterative(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts) {
  for_each_pack<T>(list, [&](const PairPack<T>& pack) { solve(pack, query, hits); });
  counts.triangle_pairs += list.size();
  counts.newton_steps += static_cast<std::int64_t>(query.steps) * list.size();
}

template void iterative<double>(const PairList&, const Query&, Hits&, KernelCounts&);
template void iterative<Pack<double, 4>>(const PairList&, const Query&, Hits&, KernelCounts&);
template void iterative<Pack<double, 8>>(const PairList&, const Query&, Hits&, KernelCounts&);

} // namespace trigrain
