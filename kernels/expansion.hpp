#pragma once
#include <cmath>
#include <vector>

namespace trigrain {

/// An exact number: the unrounded sum of doubles of growing magnitude that do not overlap. Shewchuk (1997), "Adaptive
/// precision floating-point arithmetic and fast robust geometric predicates", sections 2.3-2.7. Exact as long as no
/// product underflows (coordinates between 1e-90 and 1e90). Must be compiled without contraction of a * b + c.
class Expansion {
 public:
  /// a - b
  static Expansion difference(double a, double b) {
    Expansion r;
    const double d = a - b, b_part = a - d, a_part = d + b_part;
    r.append((a - a_part) + (b_part - b));
    r.append(d);
    return r;
  }

  friend Expansion operator+(const Expansion& a, const Expansion& b) {
    if (a.term_.empty()) return b;
    if (b.term_.empty()) return a;
    Expansion r;
    std::size_t i = 0, j = 0;
    const auto next = [&] {
      const bool from_a = j == b.term_.size() || (i < a.term_.size() && std::fabs(a.term_[i]) <= std::fabs(b.term_[j]));
      return from_a ? a.term_[i++] : b.term_[j++];
    };
    double sum = next();
    while (i < a.term_.size() || j < b.term_.size()) sum = r.append_error_of_sum(sum, next());
    r.append(sum);
    return r;
  }

  friend Expansion operator*(const Expansion& a, const Expansion& b) {
    Expansion r;
    for (const double factor : b.term_) r = r + a.scaled(factor);
    return r;
  }

  Expansion operator-() const {
    Expansion r = *this;
    for (double& t : r.term_) t = -t;
    return r;
  }
  friend Expansion operator-(const Expansion& a, const Expansion& b) { return a + -b; }

  /// The nearest double, or one beside it; its sign is the exact sign.
  double value() const {
    double sum = 0;
    for (const double t : term_) sum += t;
    return sum;
  }

 private:
  void append(double t) {
    if (t != 0) term_.push_back(t);
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
    for (const double t : term_) {
      const double product = t * factor, error = std::fma(t, factor, -product);
      sum = r.append_error_of_sum(sum, error);
      sum = r.append_error_of_sum(product, sum);
    }
    r.append(sum);
    return r;
  }

  std::vector<double> term_;
};

} // namespace trigrain
