// The hybrids in two passes: a cheap separating direction disposes of far pairs; what survives is packed full and
// solved.
#include "kernels/hybrid.hpp"
#include "kernels/brute_simd.hpp"
#include "kernels/certificate.hpp"
#include "kernels/newton.hpp"
#include "kernels/pack.hpp"
#include "kernels/polish.hpp"
#include <algorithm>
#include <vector>

namespace trigrain {
namespace {

/// A pack's answers and which of them hold (bits of lanes).
template <class T> struct Solved {
  PackAnswer<T> answer;
  unsigned contact = 0;  ///< proven to be within reach
  unsigned unproven = 0; ///< neither that nor beyond reach
};

template <class T> [[gnu::noinline, gnu::flatten]] Solved<T> solve(const PairPack<T>& pack, const Query& query) {
  const TrianglePair<T>& pair = pack.pair();
  const T reach = pack.in_units(query.reach);
  const Weights<T> start = clamped(newton(pair, query));
  const PointPair<T> iterate = points_at(pair, start);
  const T first_gap = gap_along(iterate.p - iterate.q, pair);
  if (all_of(beyond(first_gap, reach, pair))) return {};

  const auto [z, points, distance, polished_gap] = polish(pair, start);
  const T gap = max(first_gap, polished_gap), rounding = constant<T>(certificate_rounding<T>) * pair.extent;
  const T lower = min(proven_gap(gap, pair.extent), distance);
  const unsigned far = bits_of(beyond(gap, reach, pair));
  const unsigned proven = bits_of((distance - gap <= constant<T>(query.tolerance) * pair.extent) &
                                  (distance + rounding <= reach) & (lower > T(0)));
  return {.answer = {points.p, points.q, distance, lower, distance + rounding, feature_of(z)},
          .contact = pack.used() & proven & ~far,
          .unproven = pack.used() & ~proven & ~far};
}

template <class T> [[gnu::noinline, gnu::flatten]] unsigned apart(const PairPack<T>& pack, double reach) {
  return bits_of(apart_by_middles(pack.pair(), pack.in_units(reach)));
}

template <class T> void redo(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts) {
  const int first = hits.size();
  KernelCounts inner;
  brute_simd<T>(list, query, hits, inner);
  hits.mark_fallen_back(first);
  counts.fall_backs += list.size();
}

/// Up to `lanes` pairs, each redone on its own where it is not proven.
template <class T> void solve_pairs(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts) {
  const PairPack<T> pack(list, 0);
  const Solved<T> s = solve(pack, query);
  counts.newton_steps += static_cast<std::int64_t>(query.steps) * pack.size();
  if (s.unproven == 0) return pack.append(s.answer, s.contact, hits);
  for (int lane = 0; lane < pack.size(); ++lane)
    if (s.unproven >> lane & 1)
      redo<T>(list.part(lane, 1), query, hits, counts);
    else
      pack.append(s.answer, s.contact & 1u << lane, hits);
}

/// A batch, redone as a whole where one pair is not proven.
template <class T> void solve_batch(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts) {
  const int first = hits.size();
  for (int k = 0; k < list.size(); k += lanes_of<T>) {
    const PairPack<T> pack(list, k);
    const Solved<T> s = solve(pack, query);
    counts.newton_steps += static_cast<std::int64_t>(query.steps) * pack.size();
    if (s.unproven != 0) {
      hits.cut(first);
      return redo<T>(list, query, hits, counts);
    }
    pack.append(s.answer, s.contact, hits);
  }
}

} // namespace

template <class T> void hybrid_pair(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts) {
  constexpr int lanes = lanes_of<T>;
  std::array<PairIndex, 2 * lanes> waiting;
  int n = 0;
  const auto solve_first = [&](int count) {
    solve_pairs<T>({list.a, list.b, std::span<const PairIndex>(waiting).first(count)}, query, hits, counts);
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

template <class T> void hybrid_batch(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts) {
  std::array<PairIndex, largest_batch> left;
  const int batch = std::clamp(query.batch, 1, largest_batch);
  for (int first = 0; first < list.size(); first += batch) {
    int n = 0;
    for_each_pack<T>(list.part(first, batch), [&](const PairPack<T>& pack) {
      const unsigned dropped = apart(pack, query.reach);
      for (int lane = 0; lane < pack.size(); ++lane)
        if (!(dropped >> lane & 1)) left[n++] = pack.index(lane);
    });
    if (n > 0) solve_batch<T>({list.a, list.b, std::span<const PairIndex>(left).first(n)}, query, hits, counts);
  }
  counts.triangle_pairs += list.size();
}

template void hybrid_pair<double>(const PairList&, const Query&, Hits&, KernelCounts&);
template void hybrid_pair<Pack<double, 4>>(const PairList&, const Query&, Hits&, KernelCounts&);
template void hybrid_pair<Pack<double, 8>>(const PairList&, const Query&, Hits&, KernelCounts&);
template void hybrid_batch<double>(const PairList&, const Query&, Hits&, KernelCounts&);
template void hybrid_batch<Pack<double, 4>>(const PairList&, const Query&, Hits&, KernelCounts&);
template void hybrid_batch<Pack<double, 8>>(const PairList&, const Query&, Hits&, KernelCounts&);

} // namespace trigrain
