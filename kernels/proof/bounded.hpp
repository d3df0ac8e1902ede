#pragma once
#include <cmath>
#include <limits>

namespace trigrain::oracle {

/// Thrown where rounding leaves a comparison open: ask exact numbers.
struct Doubt {};

/// A real number within `error` of `value`: double arithmetic that knows its own rounding. 2^-53 of every result is
/// charged, and 1e-300 for products that underflow; the factor covers the rounding of the error itself.
struct Bounded {
  double value = 0, error = 0;

  Bounded() = default;
  Bounded(double value, double error = 0) : value(value), error(error) {}

  static Bounded rounded(double value, double inherited) {
    constexpr double unit = std::numeric_limits<double>::epsilon() / 2;
    return {value, (inherited + unit * std::fabs(value)) * (1 + 16 * unit)};
  }
  friend Bounded operator+(const Bounded& a, const Bounded& b) { return rounded(a.value + b.value, a.error + b.error); }
  friend Bounded operator-(const Bounded& a, const Bounded& b) { return rounded(a.value - b.value, a.error + b.error); }
  friend Bounded operator*(const Bounded& a, const Bounded& b) {
    const bool zero = (a.value == 0 && a.error == 0) || (b.value == 0 && b.error == 0);
    if (zero) return {};
    return rounded(a.value * b.value,
                   std::fabs(a.value) * b.error + std::fabs(b.value) * a.error + a.error * b.error + 1e-300);
  }
};

/// -1, 0 or 1.
inline int sign(const Bounded& x) {
  if (std::fabs(x.value) > x.error) return x.value > 0 ? 1 : -1;
  if (x.error > 0 || !(x.value == 0)) throw Doubt();
  return 0;
}

} // namespace trigrain::oracle
