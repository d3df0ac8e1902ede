#pragma once
#include "kernels/lanes.hpp"
#include <Eigen/Core>
#include <vector>

namespace trigrain {

/// Spheres as structure of arrays, to compare one of them with a run of others, many at once.
class SphereArray {
 public:
  void resize(int size) {
    for (auto* column : {&x_, &y_, &z_, &r_}) column->resize(size + lane_count); // the last load may reach beyond
  }
  void set(int i, const Eigen::Vector3d& centre, double radius) {
    x_[i] = centre.x(), y_[i] = centre.y(), z_[i] = centre.z(), r_[i] = radius;
  }
  bool overlap(int i, const Eigen::Vector3d& centre, double radius) const {
    const double reach = r_[i] + radius;
    return (Eigen::Vector3d(x_[i], y_[i], z_[i]) - centre).squaredNorm() <= reach * reach * wider;
  }

  /// Calls visit(j) for every j in [begin, end) whose sphere overlaps sphere i, in order.
  template <class Visit> void for_overlapping(int i, int begin, int end, const Visit& visit) const {
    const auto load = [](const std::vector<double>& column, int first) {
      return Lanes(column.data() + first, stdx::element_aligned);
    };
    const Lanes x(x_[i]), y(y_[i]), z(z_[i]), r(r_[i]);
    for (int first = begin; first < end; first += lane_count) {
      const Lanes dx = load(x_, first) - x, dy = load(y_, first) - y, dz = load(z_, first) - z;
      const Lanes reach = load(r_, first) + r;
      for_lanes(bits_of(dx * dx + dy * dy + dz * dz <= reach * reach * Lanes(wider)), first, end, visit);
    }
  }

 private:
  static constexpr double wider = 1 + 1e-12; // rounding must lose no pair
  std::vector<double> x_, y_, z_, r_;        // m
};

} // namespace trigrain
