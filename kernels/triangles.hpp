#pragma once
#include "kernels/column.hpp"
#include "kernels/vec3.hpp"
#include <algorithm>
#include <array>

namespace trigrain {

/// One triangle: corners a0, a1, a2 (m).
struct Triangle {
  Vec3<double> a0, a1, a2;
};

/// Borrowed triangles as structure of arrays: coordinate[3 * corner + axis][i] (m) for triangle i < size. Each array is
/// readable up to the next multiple of Triangles::lanes; the padding holds some finite triangle.
struct TrianglesView {
  std::array<const double*, 9> coordinate{};
  int size = 0;

  Triangle operator[](int i) const {
    const auto& c = coordinate;
    return {{c[0][i], c[1][i], c[2][i]}, {c[3][i], c[4][i], c[5][i]}, {c[6][i], c[7][i], c[8][i]}};
  }
};

/// Triangles as structure of arrays, padded to a multiple of `lanes`. Refilling one that has grown does not allocate.
class Triangles {
 public:
  static constexpr int lanes = 16; ///< the widest pack of any supported machine (16 floats)

  void clear() { size_ = 0; }
  void push_back(const Triangle& t) {
    const std::array<double, 9> c{t.a0.x, t.a0.y, t.a0.z, t.a1.x, t.a1.y, t.a1.z, t.a2.x, t.a2.y, t.a2.z};
    if (size_ == static_cast<int>(coordinate_[0].size()))
      for (auto& column : coordinate_) column.resize(size_ + std::max(size_, lanes));
    if (size_ % lanes == 0) // padding: finite whatever follows
      for (int k = 0; k < 9; ++k) std::fill_n(coordinate_[k].begin() + size_, lanes, c[k]);
    for (int k = 0; k < 9; ++k) coordinate_[k][size_] = c[k];
    ++size_;
  }
  /// Makes room for `size` triangles, to be written into coordinate() whole packs at a time.
  void resize(int size) {
    const std::size_t room = (size + lanes - 1) / lanes * lanes;
    if (coordinate_[0].size() < room)
      for (auto& column : coordinate_) column.resize(2 * room);
    size_ = size;
  }
  double* coordinate(int c) { return coordinate_[c].data(); } ///< TrianglesView::coordinate
  int size() const { return size_; }
  /// Lends the arrays; valid until the next change.
  TrianglesView view() const {
    TrianglesView v{.size = size_};
    for (int k = 0; k < 9; ++k) v.coordinate[k] = coordinate_[k].data();
    return v;
  }

 private:
  std::array<Column<double>, 9> coordinate_;
  int size_ = 0;
};

} // namespace trigrain
