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
/// its last pair. Differences are taken in double before they are rounded to T.
template <class T> class PairPack {
 public:
  static constexpr int lanes = lanes_of<T>;

  explicit PairPack(const PairList& list) : index_(list.pairs) {
    std::array<std::array<double, lanes>, 9> ca, cb;
    gather(list.a, &PairIndex::i, ca);
    gather(list.b, &PairIndex::j, cb);
    for (int axis = 0; axis < 3; ++axis) origin_[axis] = ca[axis];
    pair_ = with_extent<T>({Vec3<T>{T(0), T(0), T(0)}, local(ca, 1), local(ca, 2)},
                           {local(cb, 0), local(cb, 1), local(cb, 2)});
  }

  int size() const { return static_cast<int>(index_.size()); }
  const PairIndex& index(int lane) const { return index_[lane]; }
  const TrianglePair<T>& pair() const { return pair_; }
  /// Bits of the lanes that hold a pair of the list.
  unsigned used() const { return (1u << size()) - 1; }

  /// Appends the answers of the lanes whose bit is set, back in the world's frame.
  void append(const PackAnswer<T>& answer, unsigned bits, Hits& hits) const {
    const Columns columns = columns_of(answer);
    hits.reserve(lanes);
    if (bits == (1u << lanes) - 1)
      append_all(columns, hits);
    else
      for (; bits != 0; bits &= bits - 1) append_one(columns, std::countr_zero(bits), hits);
  }

 private:
  /// px ... qz, distance, lower, upper, feature.
  using Columns = std::array<std::array<ScalarOf<T>, lanes>, Hits::columns + 1>;

  /// Nine coordinates of one triangle per lane. Neighbours and repeated triangles, as in lists of all pairs, are cheap.
  void gather(const TrianglesView& t, int PairIndex::*which, std::array<std::array<double, lanes>, 9>& to) const {
    std::array<int, lanes> k;
    for (int lane = 0; lane < lanes; ++lane) k[lane] = index_[std::min(lane, size() - 1)].*which;
    bool same = true, neighbours = true;
    for (int lane = 0; lane < lanes; ++lane) {
      same &= k[lane] == k[0];
      neighbours &= k[lane] == k[0] + lane;
    }
    for (int c = 0; c < 9; ++c) {
      const double* from = t.coordinate[c];
      if (same)
        to[c].fill(from[k[0]]);
      else if (neighbours)
        std::copy_n(from + k[0], lanes, to[c].begin());
      else
        for (int lane = 0; lane < lanes; ++lane) to[c][lane] = from[k[lane]];
    }
  }

  Vec3<T> local(const std::array<std::array<double, lanes>, 9>& c, int corner) const {
    const auto axis = [&](int k) {
      std::array<ScalarOf<T>, lanes> x;
      for (int lane = 0; lane < lanes; ++lane)
        x[lane] = static_cast<ScalarOf<T>>(c[3 * corner + k][lane] - origin_[k][lane]);
      return load<T>(x.data());
    };
    return {axis(0), axis(1), axis(2)};
  }

  static Columns columns_of(const PackAnswer<T>& answer) {
    Columns to;
    int k = 0;
    for (const T* x : {&answer.p.x, &answer.p.y, &answer.p.z, &answer.q.x, &answer.q.y, &answer.q.z, &answer.distance,
                       &answer.lower, &answer.upper, &answer.feature})
      store(*x, to[k++].data());
    return to;
  }

  void append_all(const Columns& from, Hits& hits) const {
    for (int c = 0; c < Hits::columns; ++c) {
      double* to = hits.next(static_cast<Hits::Column>(c));
      for (int lane = 0; lane < lanes; ++lane)
        to[lane] = c < Hits::distance ? static_cast<double>(from[c][lane]) + origin_[c % 3][lane]
                                      : static_cast<double>(from[c][lane]);
    }
    int *i = hits.next_i(), *j = hits.next_j(), *feature = hits.next_feature();
    for (int lane = 0; lane < lanes; ++lane) {
      i[lane] = index_[lane].i;
      j[lane] = index_[lane].j;
      feature[lane] = static_cast<int>(from[Hits::columns][lane]);
    }
    hits.added(lanes);
  }

  void append_one(const Columns& from, int lane, Hits& hits) const {
    for (int c = 0; c < Hits::columns; ++c)
      *hits.next(static_cast<Hits::Column>(c)) =
          static_cast<double>(from[c][lane]) + (c < Hits::distance ? origin_[c % 3][lane] : 0);
    *hits.next_i() = index_[lane].i;
    *hits.next_j() = index_[lane].j;
    *hits.next_feature() = static_cast<int>(from[Hits::columns][lane]);
    hits.added(1);
  }

  std::span<const PairIndex> index_;
  std::array<std::array<double, lanes>, 3> origin_;
  TrianglePair<T> pair_;
};

/// The list in packs, in order.
template <class T, class Solve> void for_each_pack(const PairList& list, Solve solve) {
  for (int first = 0; first < list.size(); first += lanes_of<T>) solve(PairPack<T>(list.part(first, lanes_of<T>)));
}

} // namespace trigrain
