#pragma once
#include "kernels/column.hpp"
#include "kernels/lanes.hpp"
#include "kernels/vec3.hpp"
#include <array>

namespace trigrain {

/// Edges as structure of arrays (m): one is compared with a pack of them at once. Refilling one that has grown does not
/// allocate.
class EdgeArray {
 public:
  struct Ends {
    Vec3<Lanes> from, to;
  };
  void clear() { size_ = 0; }
  void push_back(const Vec3<double>& from, const Vec3<double>& to) {
    if (size_ + lane_count > static_cast<int>(column_[0].size())) // the last pack may reach beyond
      for (auto& column : column_) column.resize(2 * size_ + 8 * lane_count);
    const std::array<double, 6> x{from.x, from.y, from.z, to.x, to.y, to.z};
    for (int k = 0; k < 6; ++k) column_[k][size_] = x[k];
    ++size_;
  }
  int size() const { return size_; }
  /// Of the edges first, first + 1, ...; what is beyond the last of them is undefined.
  Ends at(int first) const {
    const auto point = [&](int k) {
      return Vec3<Lanes>{load<Lanes>(&column_[k][first]), load<Lanes>(&column_[k + 1][first]),
                         load<Lanes>(&column_[k + 2][first])};
    };
    return {point(0), point(3)};
  }

 private:
  std::array<Column<double>, 6> column_; // m
  int size_ = 0;
};

} // namespace trigrain
