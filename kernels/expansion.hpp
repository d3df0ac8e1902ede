#pragma once
#include <algorithm>
#include <array>
#include <cmath>

namespace trigrain {

/// An exact number: the unrounded sum of doubles of growing magnitude that do not overlap. Shewchuk (1997), "Adaptive
/// precision floating-point arithmetic and fast robust geometric predicates", sections 2.3-2.7. Exact as long as no
/// product underflows (coordinates between 1e-90 and 1e90). Room for the volume of a tetrahedron: three products of
/// three differences each. Must be compiled without contraction of a * b + c.
class Expansion {
 public:
  Expansion() {} // terms are not initialised
  Expansion(const Expansion& other) : size_(other.size_) { std::copy_n(other.term_.begin(), size_, term_.begin()); }
  Expansion& operator=(const Expansion& other) {
    size_ = other.size_;
    std::copy_n(other.term_.begin(), size_, term_.begin());
    return *this;
  }

  /// a - b
  static Expansion difference(double a, double b) {
    Expansion r;
    const double d = a - b, b_part = a - d, a_part = d + b_part;
    r.append((a - a_part) + (b_part - b));
    r.append(d);
    return r;
  }

  friend Expansion operator+(const Expansion& a, const Expansion& b) {
    if (a.size_ == 0) return b;
    if (b.size_ == 0) return a;
    Expansion r;
    int i = 0, j = 0;
    const auto next = [&] {
      const bool from_a = j == b.size_ || (i < a.size_ && std::fabs(a.term_[i]) <= std::fabs(b.term_[j]));
      return from_a ? a.term_[i++] : b.term_[j++];
    };
    double sum = next();
    while (i < a.size_ || j < b.size_) sum = r.append_error_of_sum(sum, next());
    r.append(sum);
    return r;
  }

  friend Expansion operator*(const Expansion& a, const Expansion& b) {
    Expansion r;
    for (int k = 0; k < b.size_; ++k) r = r + a.scaled(b.term_[k]);
    return r;
  }

  Expansion operator-() const {
    Expansion r = *this;
    for (int k = 0; k < r.size_; ++k) r.term_[k] = -r.term_[k];
    return r;
  }
  friend Expansion operator-(const Expansion& a, const Expansion& b) { return a + -b; }

  /// The nearest double, or one beside it; its sign is the exact sign.
  double value() const {
    double sum = 0;
    for (int k = 0; k < size_; ++k) sum += term_[k];
    return sum;
  }

 private:
  void append(double t) {
    if (t != 0) term_[size_++] = t;
  }
  /// Keeps the rounding error of a + b as a term and returns the rounded sum (Knuth's two-sum).
  double append_error_of_sum(double a, double b) {
    const double sum = a + b, b_part = sum - a, a_part = sum - b_part;
    append((a - a_part) + (b - b_part));
    return sum;
  }
  Expansion scaled(double factor) const {
    Expansion r;
    double sum = 0;
    for (int k = 0; k < size_; ++k) {
      const double t = term_[k];
      const double product = t * factor, error = std::fma(t, factor, -product);
      sum = r.append_error_of_sum(sum, error);
      sum = r.append_error_of_sum(product, sum);
    }
    r.append(sum);
    return r;
  }

  std::array<double, 3 * 64> term_;
  int size_ = 0;
};

} // namespace trigrain
