#pragma once
#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <random>

namespace trigrain {

/// Seeded random numbers that are the same bits with every compiler and library: the engine is specified by the C++
/// standard, its distributions are not. Directions are drawn on integers whose squares a double holds exactly, so that
/// fused multiply-adds cannot change them either.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  std::uint64_t bits() { return engine_(); }
  /// Uniform in [0, 1), a multiple of 2^-53.
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  /// Uniform on the unit sphere, by rejection from the cube.
  Eigen::Vector3d direction() {
    for (;;) {
      const double x = coordinate(), y = coordinate(), z = coordinate(); // in this order; arguments have none
      const Eigen::Vector3d v(x, y, z);
      const double length2 = v.squaredNorm();
      if (length2 > 0 && length2 <= unit * unit) return v * (1 / std::sqrt(length2));
    }
  }
  /// Uniform rotation (Marsaglia 1972, "Choosing a point from the surface of a sphere", in four dimensions).
  Eigen::Quaterniond rotation() {
    const Disc a = disc(), b = disc();
    const double factor = std::sqrt((unit * unit - a.length2) / b.length2);
    return {a.x * (1 / unit), a.y * (1 / unit), b.x * (factor / unit), b.y * (factor / unit)};
  }

 private:
  static constexpr double unit = 0x1p25; ///< squares of such integers, and sums of three, are exact

  struct Disc {
    double x, y, length2;
  };
  /// An odd integer in (-unit, unit).
  double coordinate() { return static_cast<double>(static_cast<std::int64_t>(engine_() >> 39) * 2 + 1) - unit; }
  Disc disc() {
    for (;;) {
      const double x = coordinate(), y = coordinate(), length2 = x * x + y * y;
      if (length2 < unit * unit) return {x, y, length2};
    }
  }
  std::mt19937_64 engine_;
};

} // namespace trigrain
