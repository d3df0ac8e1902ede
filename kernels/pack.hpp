#pragma once
#include "kernels/kernels.hpp"
#include "kernels/triangle_pair.hpp"
#include <algorithm>
#include <array>
#include <bit>
#include <span>

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

  explicit PairPack(const PairList& list) : index_(list.pairs) {
    if (is_row())
      load_row(list);
    else
      load_scattered(list);
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

  /// Point p of one lane, in the world's frame (m).
  Vec3<double> p_of(const PackAnswer<T>& answer, int lane) const {
    const auto axis = [&](const T& x, int k) {
      return static_cast<double>(lane_of(in_metres(x), lane)) + origin_[k][lane];
    };
    return {axis(answer.p.x, 0), axis(answer.p.y, 1), axis(answer.p.z, 2)};
  }

  /// Appends the answers of the lanes whose bit is set, back in the world's frame.
  [[gnu::flatten]] void append(const PackAnswer<T>& from, unsigned bits, Hits& hits) const {
    if (bits == 0) return;
    hits.reserve(lanes);
    static constexpr Column zero{};
    int c = 0;
    for (const T* x : {&from.p.x, &from.p.y, &from.p.z, &from.q.x, &from.q.y, &from.q.z}) {
      store_sum(in_metres(*x), origin_[c % 3].data(), bits, hits.next(static_cast<Hits::Column>(c)));
      ++c;
    }
    store_sum(in_metres(from.distance), zero.data(), bits, hits.next(Hits::distance));
    store_sum(in_metres(from.lower), zero.data(), bits, hits.next(Hits::lower));
    store_sum(in_metres(from.upper), zero.data(), bits, hits.next(Hits::upper));
    std::array<int, lanes> feature;
    store(from.feature, feature.data());
    const int count = std::popcount(bits);
    for (int k = 0; k < count; ++k, bits &= bits - 1) {
      const int lane = std::countr_zero(bits);
      hits.next_i()[k] = index_[lane].i;
      hits.next_j()[k] = index_[lane].j;
      hits.next_feature()[k] = feature[lane];
    }
    hits.added(count);
  }

 private:
  using Column = std::array<double, lanes>;

  /// One triangle of A against neighbours of B, as in a list of all pairs.
  bool is_row() const {
    if (size() < lanes) return false;
    const auto [i, j] = index_[0];
    int other = 0;
    for (int lane = 0; lane < lanes; ++lane) other |= (index_[lane].i ^ i) | (index_[lane].j ^ (j + lane));
    return other == 0;
  }

  static constexpr bool has_unit = std::is_same_v<ScalarOf<T>, float>;

  [[gnu::always_inline]] T in_metres(const T& x) const {
    if constexpr (has_unit)
      return x * unit_;
    else
      return x;
  }

  /// Sets the extent and, in float, goes over to the units of the pairs.
  [[gnu::always_inline]] void finish() {
    pair_.extent = extent_of(pair_.a, pair_.b);
    if constexpr (has_unit) {
      power_of_two_below(pair_.extent, unit_, per_unit_);
      for (Corners<T>* t : {&pair_.a, &pair_.b})
        for (Vec3<T>& corner : *t) corner = per_unit_ * corner;
      pair_.extent = per_unit_ * pair_.extent;
    }
  }

  [[gnu::flatten]] void load_row(const PairList& list) {
    const auto [i, j] = index_[0];
    const Triangle a = list.a[i];
    const std::array<double, 3> a0{a.a0.x, a.a0.y, a.a0.z};
    for (int axis = 0; axis < 3; ++axis) origin_[axis].fill(a0[axis]);
    const auto seen_from_a0 = [&](const Vec3<double>& x) {
      return Vec3<T>{constant<T>(x.x - a.a0.x), constant<T>(x.y - a.a0.y), constant<T>(x.z - a.a0.z)};
    };
    pair_.a = {seen_from_a0(a.a0), seen_from_a0(a.a1), seen_from_a0(a.a2)};
    for (int k = 0; k < 3; ++k) {
      const auto axis = [&, j = j](int x) { return load_difference<T>(list.b.coordinate[3 * k + x] + j, a0[x]); };
      pair_.b[k] = {axis(0), axis(1), axis(2)};
    }
    finish();
  }

  [[gnu::flatten]] void load_scattered(const PairList& list) {
    std::array<Column, 9> a, b;
    for (int lane = 0; lane < lanes; ++lane) {
      const auto [i, j] = index_[std::min(lane, size() - 1)];
      for (int c = 0; c < 9; ++c) {
        a[c][lane] = list.a.coordinate[c][i];
        b[c][lane] = list.b.coordinate[c][j];
      }
    }
    for (int axis = 0; axis < 3; ++axis) origin_[axis] = a[axis];
    for (int k = 0; k < 3; ++k) {
      const auto corner = [&](const std::array<Column, 9>& of) {
        const auto axis = [&](int x) { return load_difference<T>(of[3 * k + x].data(), origin_[x].data()); };
        return Vec3<T>{axis(0), axis(1), axis(2)};
      };
      pair_.a[k] = corner(a);
      pair_.b[k] = corner(b);
    }
    finish();
  }

  std::span<const PairIndex> index_;
  std::array<Column, 3> origin_; ///< a[0] of every lane (m)
  TrianglePair<T> pair_;
  T unit_, per_unit_; ///< m, 1/m; in float only
};

/// The list in packs, in order.
template <class T, class Solve> void for_each_pack(const PairList& list, Solve solve) {
  for (int first = 0; first < list.size(); first += lanes_of<T>) solve(PairPack<T>(list.part(first, lanes_of<T>)));
}

} // namespace trigrain
