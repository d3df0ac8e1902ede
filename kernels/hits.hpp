#pragma once
#include "kernels/column.hpp"
#include "kernels/vec3.hpp"
#include <array>
#include <cstdint>

namespace trigrain {

/// Answer for one triangle pair: p on A, q on B, and proven bounds of the distance d(A, B), all in m.
struct Closest {
  Vec3<double> p, q;
  double distance;          ///< |p - q|, the answer
  double lower, upper;      ///< lower <= d(A, B) <= upper, rounding included
  std::uint8_t feature = 0; ///< where p and q lie: see Features
  bool fell_back = false;   ///< a kernel could not prove its own answer and took the exact one
};

/// What p and q lie on, as bits: 1, 2, 4 for the corners of A whose edge, face or self p is on; 8, 16, 32 for those of
/// B. One bit of a triangle is a corner, two are an edge, three the face.
struct Features {
  static constexpr int of_a = 7, of_b = 56, shift_b = 3;
};

/// A triangle pair (i of A, j of B) within reach.
struct Hit {
  int i, j;
  Closest closest;
};

/// Hits as structure of arrays, so that a kernel writes whole packs. Refilling one that has grown does not allocate.
class Hits {
 public:
  /// Columns of doubles, in this order.
  enum Quantity { px, py, pz, qx, qy, qz, distance, lower, upper, columns };

  int size() const { return size_; }
  bool empty() const { return size_ == 0; }
  void clear() { size_ = 0; }
  Hit operator[](int k) const {
    const auto at = [&](Quantity c) { return real_[c][k]; };
    return {i_[k],
            j_[k],
            {{at(px), at(py), at(pz)},
             {at(qx), at(qy), at(qz)},
             at(distance),
             at(lower),
             at(upper),
             static_cast<std::uint8_t>(feature_[k] & 63),
             (feature_[k] & fell_back) != 0}};
  }
  void push_back(const Hit& hit) {
    reserve(1);
    const Closest& c = hit.closest;
    const std::array<double, columns> values{c.p.x, c.p.y, c.p.z, c.q.x, c.q.y, c.q.z, c.distance, c.lower, c.upper};
    for (int k = 0; k < columns; ++k) real_[k][size_] = values[k];
    i_[size_] = hit.i;
    j_[size_] = hit.j;
    feature_[size_++] = c.feature | (c.fell_back ? fell_back : 0);
  }

  /// Drops all but the first `count`.
  void cut(int count) { size_ = count; }
  /// Says of all from number `first` on that their kernel fell back.
  void mark_fallen_back(int first) {
    for (int k = first; k < size_; ++k) feature_[k] |= fell_back;
  }

  // For kernels: room for `count` more, where the next ones go, and that they are there.
  static constexpr int fell_back = 64; ///< bit beside Features in the column of features
  void reserve(int count) {
    if (size_ + count > static_cast<int>(i_.size())) grow(size_ + count);
  }
  double* next(Quantity c) { return real_[c].data() + size_; }
  int* next_i() { return i_.data() + size_; }
  int* next_j() { return j_.data() + size_; }
  int* next_feature() { return feature_.data() + size_; }
  void added(int count) { size_ += count; }

 private:
  [[gnu::noinline, gnu::cold]] void grow(int least) {
    const std::size_t room = 2 * static_cast<std::size_t>(least) + 64;
    for (auto& column : real_) column.resize(room);
    i_.resize(room);
    j_.resize(room);
    feature_.resize(room);
  }

  std::array<Column<double>, columns> real_;
  Column<int> i_, j_, feature_;
  int size_ = 0;
};

} // namespace trigrain
