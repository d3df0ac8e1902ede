// Brute force over lanes: every pair of a pack takes the same path through all 15 features.
#include "kernels/brute_simd.hpp"
#include "kernels/all_features.hpp"
#include "kernels/brute.hpp"
#include "kernels/certificate.hpp"
#include "kernels/crossing.hpp"
#include "kernels/pack.hpp"
#include "kernels/pierce.hpp"

namespace trigrain {
namespace {

/// The answer of a pack, and the lanes (bits) that rounding leaves in doubt: whether they are within reach (the points
/// found prove that they are, the separating plane that they are not), or whether they touch.
template <class T> struct Solved {
  PackAnswer<T> answer;
  unsigned within, doubtful, touching;
};

template <class T> [[gnu::always_inline]] inline Solved<T> solved(const TrianglePair<T>& pair, const T& reach) {
  const T rounding = constant<T>(certificate_rounding<T>) * pair.extent;
  const auto [z, thin] = closest_weights(pair);
  const auto [p, q] = points_at(pair, z);
  const T distance = sqrt(squared(p - q)), lower = min(proven_gap(gap_along(p - q, pair), pair.extent), distance);
  Solved<T> s;
  s.answer.p = p;
  s.answer.q = q;
  s.answer.distance = distance;
  s.answer.lower = lower;
  s.answer.upper = distance + rounding;
  s.answer.feature = feature_of(z);
  s.within = bits_of(distance <= reach);
  const MaskOf<T> decided = (distance + rounding + rounding <= reach) | (lower > reach + rounding);
  s.doubtful = bits_of((!decided) | (thin & (distance <= reach + rounding)));
  s.touching = 0;
  if (const auto open = !(lower > T(0)); any_of(open)) {
    const Pierced<T> pierced = pierce(pair);
    const auto crossing = open & pierced.surely;
    s.answer.p = select(crossing, pierced.point, p);
    s.answer.q = select(crossing, pierced.point, q);
    s.answer.distance = select(crossing, T(0), distance);
    s.answer.upper = select(crossing, T(0), s.answer.upper);
    s.answer.feature = select(crossing, T(Features::of_a | Features::of_b), s.answer.feature);
    s.within |= bits_of(crossing);
    s.doubtful &= ~bits_of(crossing);
    s.touching = bits_of(open & !pierced.surely & !(pierced.surely_not & (distance > T(0))));
  }
  return s;
}

/// Appends a pair in doubt, decided exactly.
template <class T> void decide(const PairPack<T>& pack, int lane, const Solved<T>& s, const PairList& list,
                               const Query& query, Hits& hits) {
  const auto [i, j] = pack.index(lane);
  const Triangle a = list.a[i], b = list.b[j];
  Closest closest;
  if (s.doubtful >> lane & 1 || !(lane_of(s.answer.distance, lane) > 0)) {
    closest = closest_by_brute_force(a, b);
  } else if (const auto common = common_point(a, b, pack.p_of(s.answer, lane))) {
    closest = {*common, *common, 0, 0, 0, Features::of_a | Features::of_b};
  } else {
    if (s.within >> lane & 1) pack.append(s.answer, 1u << lane, hits);
    return;
  }
  closest.fell_back = true;
  if (closest.distance <= query.reach) hits.push_back({i, j, closest});
}

template <class T> [[gnu::noinline, gnu::flatten]] void solve(const PairPack<T>& pack, const PairList& list,
                                                              const Query& query, Hits& hits, KernelCounts& counts) {
  const Solved<T> s = solved(pack.pair(), pack.in_units(query.reach));
  const unsigned redo = (s.doubtful | s.touching) & pack.used(), within = s.within & pack.used();
  if (redo == 0) return pack.append(s.answer, within, hits);
  counts.fall_backs += std::popcount(redo);
  for (int lane = 0; lane < pack.size(); ++lane)
    if (redo >> lane & 1)
      decide(pack, lane, s, list, query, hits);
    else if (within >> lane & 1)
      pack.append(s.answer, 1u << lane, hits);
}

} // namespace

template <class T> void brute_simd(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts) {
  for_each_pack<T>(list, [&](const PairPack<T>& pack) { solve(pack, list, query, hits, counts); });
  counts.triangle_pairs += list.size();
}

template void brute_simd<double>(const PairList&, const Query&, Hits&, KernelCounts&);
template void brute_simd<Pack<double, 4>>(const PairList&, const Query&, Hits&, KernelCounts&);
template void brute_simd<Pack<double, 8>>(const PairList&, const Query&, Hits&, KernelCounts&);
template void brute_simd<float>(const PairList&, const Query&, Hits&, KernelCounts&);
template void brute_simd<Pack<float, 4>>(const PairList&, const Query&, Hits&, KernelCounts&);
template void brute_simd<Pack<float, 8>>(const PairList&, const Query&, Hits&, KernelCounts&);
template void brute_simd<Pack<float, 16>>(const PairList&, const Query&, Hits&, KernelCounts&);

} // namespace trigrain
