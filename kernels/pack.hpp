#pragma once
#include "kernels/column.hpp"
#include "kernels/kernels.hpp"
#include "kernels/triangle_pair.hpp"
#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <utility>

namespace trigrain {

/// Answers of one pack of pairs, in the frames of the pairs (m); `feature` holds the bits of Features as a number.
template <class T> struct PackAnswer {
  Vec3<T> p, q;
  T distance, lower, upper, feature;
};

/// Up to N pairs of a list, one per lane, each in its own frame (origin a[0]); lanes beyond the end of the list repeat
/// its last pair. Differences are taken in double before they are rounded to T. In float each pair also has its own
/// unit of length, a power of two that puts its extent between 1 and 2: products of six lengths stay in range.
template <class T> class PairPack {
 public:
  static constexpr int lanes = lanes_of<T>;

  PairPack() { pair_.a[0] = {broadcast<T>(0), broadcast<T>(0), broadcast<T>(0)}; }
  PairPack(const PairList& list, int first) : PairPack() { load(list, first); }

  /// Takes the pairs of the list from number `first` on. (A function of its own: is_run() becomes vectors then.)
  [[gnu::noinline]] void load(const PairList& list, int first) {
    index_ = list.pairs.subspan(first, std::min(lanes, list.size() - first));
    // Sorted lists and lists of all pairs give packs of one triangle, or of neighbours, of either side: these are
    // cheap.
    const auto [i, j] = index_[0];
    if (is_run(0, 1))
      take(One{list.a, i}, Run{list.b, j});
    else if (is_run(1, 1))
      take(Run{list.a, i}, Run{list.b, j});
    else
      take(Scattered(list.a, index_, &PairIndex::i), Scattered(list.b, index_, &PairIndex::j));
  }

  int size() const { return static_cast<int>(index_.size()); }
  const PairIndex& index(int lane) const { return index_[lane]; }
  const TrianglePair<T>& pair() const { return pair_; }
  /// Bits of the lanes that hold a pair of the list.
  unsigned used() const { return (1u << size()) - 1; }

  /// A length (m) in the units of the pairs.
  T in_units(double length) const {
    if constexpr (has_unit)
      return constant<T>(length) * per_unit_;
    else
      return constant<T>(length);
  }

  /// Appends the answers of the lanes whose bit is set, back in the world's frame.
  [[gnu::flatten]] void append(const PackAnswer<T>& from, unsigned bits, Hits& hits) const {
    if (bits == 0) return;
    hits.reserve(lanes);
    const int count = std::popcount(bits);
    std::array<int, lanes> feature;
    store(from.feature, feature.data());
    int *const i = hits.next_i(), *const j = hits.next_j(), *const feature_bits = hits.next_feature();
    const PairIndex* const index = index_.data();
    const auto note = [&](int k, int lane) {
      i[k] = index[lane].i;
      j[k] = index[lane].j;
      feature_bits[k] = feature[lane];
    };
    if (count == lanes) {
      put<true>(from, bits, hits);
#pragma GCC ivdep
      for (int lane = 0; lane < lanes; ++lane) note(lane, lane);
    } else {
      put<false>(from, bits, hits);
      for (int k = 0; k < count; ++k, bits &= bits - 1) note(k, std::countr_zero(bits));
    }
    hits.added(count);
  }

 private:
  using Column = std::array<double, lanes>;

  /// Do the lanes hold triangles i, i + step_i, i + 2 step_i, ... and j, j + step_j, j + 2 step_j, ...?
  bool is_run(int step_i, int step_j) const {
    if (size() < lanes) return false;
    const auto [i, j] = index_[0];
    int other = 0;
    for (int lane = 0; lane < lanes; ++lane)
      other |= (index_[lane].i ^ (i + step_i * lane)) | (index_[lane].j ^ (j + step_j * lane));
    return other == 0;
  }

  // Where the triangles of one side are: coordinate c of half k of the lanes.
  using Doubles = Wide<T>;
  static constexpr int width = lanes_of<Doubles>;

  struct One {
    const TrianglesView& t;
    int first;
    [[gnu::always_inline]] Doubles operator()(int c, int) const { return broadcast<Doubles>(t.coordinate[c][first]); }
  };
  struct Run {
    const TrianglesView& t;
    int first;
    [[gnu::always_inline]] Doubles operator()(int c, int k) const {
      return trigrain::load<Doubles>(t.coordinate[c] + first + k * width);
    }
  };
  struct Scattered {
    std::array<std::array<Doubles, halves<T>>, 9> x;
    Scattered(const TrianglesView& t, std::span<const PairIndex> index, int PairIndex::*side) {
      std::array<int, lanes> number;
      for (int lane = 0; lane < lanes; ++lane) number[lane] = index[std::min<int>(lane, index.size() - 1)].*side;
      for (int c = 0; c < 9; ++c)
        for (int k = 0; k < halves<T>; ++k)
          x[c][k] = gathered<Doubles>([&](int lane) { return t.coordinate[c][number[k * width + lane]]; });
    }
    [[gnu::always_inline]] Doubles operator()(int c, int k) const { return x[c][k]; }
  };

  static constexpr bool has_unit = std::is_same_v<ScalarOf<T>, float>;

  [[gnu::always_inline]] T in_metres(const T& x) const {
    if constexpr (has_unit)
      return x * unit_;
    else
      return x;
  }

  template <bool all> [[gnu::always_inline]] void put(const PackAnswer<T>& from, unsigned bits, Hits& hits) const {
    const auto column = [&](Hits::Quantity c, const T& x, const double* origin = nullptr) {
      store_doubles<all>(in_metres(x), origin, bits, hits.next(c));
    };
    column(Hits::px, from.p.x, origin_[0].data());
    column(Hits::py, from.p.y, origin_[1].data());
    column(Hits::pz, from.p.z, origin_[2].data());
    column(Hits::qx, from.q.x, origin_[0].data());
    column(Hits::qy, from.q.y, origin_[1].data());
    column(Hits::qz, from.q.z, origin_[2].data());
    column(Hits::distance, from.distance);
    column(Hits::lower, from.lower);
    column(Hits::upper, from.upper);
  }

  template <class A, class B> [[gnu::flatten]] void take(const A& a, const B& b) {
    for (int axis = 0; axis < 3; ++axis)
      for (int k = 0; k < halves<T>; ++k) store(a(axis, k), origin_[axis].data() + k * width);
    const Corners<T> in_a{pair_.a[0], corner(a, a, 1), corner(a, a, 2)},
        in_b{corner(b, a, 0), corner(b, a, 1), corner(b, a, 2)};
    const T extent = extent_of(in_a, in_b);
    T scale = broadcast<T>(1);
    if constexpr (has_unit) {
      power_of_two_below(extent, unit_, per_unit_);
      scale = per_unit_;
    }
    pair_.a[1] = scale * in_a[1];
    pair_.a[2] = scale * in_a[2];
    pair_.b = {scale * in_b[0], scale * in_b[1], scale * in_b[2]};
    pair_.extent = scale * extent;
  }

  /// Corner of triangle `of` seen from corner 0 of triangle `a`.
  template <class Of, class A> [[gnu::always_inline]] static Vec3<T> corner(const Of& of, const A& a, int number) {
    return {difference(of, a, 3 * number, 0), difference(of, a, 3 * number + 1, 1),
            difference(of, a, 3 * number + 2, 2)};
  }
  template <class Of, class A> [[gnu::always_inline]] static T difference(const Of& of, const A& a, int c, int axis) {
    if constexpr (std::is_same_v<T, Doubles>)
      return of(c, 0) - a(axis, 0);
    else
      return rounded<T>([&](int k) { return of(c, k) - a(axis, k); });
  }

  std::span<const PairIndex> index_;
  alignas(cache_line) std::array<Column, 3> origin_; ///< a[0] of every lane (m)
  TrianglePair<T> pair_;
  T unit_, per_unit_; ///< m, 1/m; in float only
};

/// The list in packs, in order.
template <class T, class Solve> void for_each_pack(const PairList& list, Solve solve) {
  PairPack<T> pack;
  for (int first = 0; first < list.size(); first += lanes_of<T>) {
    pack.load(list, first);
    solve(std::as_const(pack));
  }
}

} // namespace trigrain
