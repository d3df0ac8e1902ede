// Brute force in mixed precision: float drops, double answers.
#include "kernels/brute_mixed.hpp"
#include "kernels/all_features.hpp"
#include "kernels/brute_simd.hpp"
#include "kernels/certificate.hpp"
#include "kernels/pack.hpp"
#include <cmath>

namespace trigrain {
namespace {

/// Bits of the lanes that float cannot prove to be beyond reach.
template <class T> [[gnu::noinline, gnu::flatten]] unsigned undecided(const PairPack<T>& pack, double reach_of_query) {
  const TrianglePair<T>& pair = pack.pair();
  const T reach = pack.in_units(reach_of_query);
  if (const unsigned near = pack.used() & ~bits_of(apart_by_middles(pair, reach)); near == 0) return 0;
  const auto [p, q] = points_at(pair, closest_weights(pair).z);
  return pack.used() & ~bits_of(beyond(gap_along(p - q, pair), reach, pair));
}

} // namespace

template <class Float, class Double>
void brute_mixed(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts) {
  if (std::isinf(query.reach)) return brute_simd<Double>(list, query, hits, counts);
  constexpr int room = 256;
  std::array<PairIndex, room + lanes_of<Float>> left;
  int n = 0;
  KernelCounts solved;
  const auto solve = [&] {
    brute_simd<Double>({list.a, list.b, std::span<const PairIndex>(left).first(n)}, query, hits, solved);
    n = 0;
  };
  for_each_pack<Float>(list, [&](const PairPack<Float>& pack) {
    const unsigned bits = undecided(pack, query.reach);
    for (int lane = 0; lane < pack.size(); ++lane) {
      left[n] = pack.index(lane);
      n += bits >> lane & 1;
    }
    if (n >= room) solve();
  });
  if (n > 0) solve();
  counts.triangle_pairs += list.size();
  counts.fall_backs += solved.fall_backs;
}

template void brute_mixed<float, double>(const PairList&, const Query&, Hits&, KernelCounts&);
template void brute_mixed<Pack<float, 8>, Pack<double, 4>>(const PairList&, const Query&, Hits&, KernelCounts&);
template void brute_mixed<Pack<float, 16>, Pack<double, 8>>(const PairList&, const Query&, Hits&, KernelCounts&);

} // namespace trigrain
