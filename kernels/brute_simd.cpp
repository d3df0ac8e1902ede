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

/// First half of the work on a pack: where its closest points are.
template <class T> [[gnu::noinline, gnu::flatten]] void weigh(const PairPack<T>& pack, ClosestWeights<T>& weights) {
  weights = closest_weights(pack.pair());
}

template <class T> [[gnu::always_inline]] inline Solved<T> solved(const TrianglePair<T>& pair,
                                                                  const ClosestWeights<T>& weights, const T& reach) {
  const T rounding = constant<T>(certificate_rounding<T>) * pair.extent;
  const Weights<T>& z = weights.z;
  const PointPair<T> points = points_at(pair, z);
  const Vec3<T> p = points.p, q = points.q; // (bound to names at once, they would live in memory)
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
  s.doubtful = bits_of((!decided) | weights.doubtful);
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
    // So close, brute force, in double, may have found one point and moved it apart.
    const MaskOf<T> one_point = distance <= constant<T>(2 * certificate_rounding<double>) * pair.extent;
    s.doubtful = (s.doubtful | bits_of(open & one_point)) & ~bits_of(crossing);
    s.touching = bits_of(open & !pierced.surely & !pierced.surely_not);
  }
  return s;
}

/// Appends a pair in doubt, decided exactly. `hit` is what lanes found.
void decide(const Hit& hit, bool doubtful, bool within, const PairList& list, const Query& query, Hits& hits) {
  const Triangle a = list.a[hit.i], b = list.b[hit.j];
  Closest closest;
  if (doubtful) {
    closest = closest_by_brute_force(a, b);
  } else if (const auto common = common_point(a, b, hit.closest.p)) {
    closest = {*common, *common, 0, 0, 0, Features::of_a | Features::of_b};
  } else {
    if (within) hits.push_back(hit);
    return;
  }
  closest.fell_back = true;
  if (closest.distance <= query.reach) hits.push_back({hit.i, hit.j, closest});
}

/// Goes once more over the hits from number `first` on, of the lanes `appended`, and decides those of `redo`.
[[gnu::noinline, gnu::cold]] void settle(int first, unsigned appended, unsigned redo, unsigned doubtful,
                                         unsigned within, const PairList& list, const Query& query, Hits& hits) {
  std::array<Hit, Triangles::lanes> found;
  for (int k = first; k < hits.size(); ++k) found[k - first] = hits[k];
  hits.cut(first);
  for (const Hit* hit = found.data(); appended != 0; appended &= appended - 1, ++hit) {
    const int lane = std::countr_zero(appended);
    if (redo >> lane & 1)
      decide(*hit, doubtful >> lane & 1, within >> lane & 1, list, query, hits);
    else
      hits.push_back(*hit);
  }
}

/// Second half: what they prove, and the hits.
template <class T> [[gnu::noinline, gnu::flatten]] void finish(const PairPack<T>& pack,
                                                               const ClosestWeights<T>& weights, const PairList& list,
                                                               const Query& query, Hits& hits, KernelCounts& counts) {
  const Solved<T> s = solved(pack.pair(), weights, pack.in_units(query.reach));
  const unsigned redo = (s.doubtful | s.touching) & pack.used(), appended = (s.within & pack.used()) | redo;
  const int first = hits.size();
  pack.append(s.answer, appended, hits);
  if (redo == 0) return;
  counts.fall_backs += std::popcount(redo);
  settle(first, appended, redo, s.doubtful, s.within, list, query, hits);
}

} // namespace

template <class T> void brute_simd(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts) {
  // A pack is finished after the next one is loaded: its last roots and divisions, which wait for each other, overlap
  // with the first ones of the next.
  std::array<PairPack<T>, 2> packs;
  std::array<ClosestWeights<T>, 2> weights;
  const auto finish_pack = [&](int n) { finish(packs[n % 2], weights[n % 2], list, query, hits, counts); };
  const int count = (list.size() + lanes_of<T> - 1) / lanes_of<T>;
  for (int n = 0; n < count; ++n) {
    packs[n % 2].load(list, n * lanes_of<T>);
    if (n > 0) finish_pack(n - 1);
    weigh(packs[n % 2], weights[n % 2]);
  }
  if (count > 0) finish_pack(count - 1);
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
