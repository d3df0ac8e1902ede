#pragma once
#include <algorithm>
#include <cmath>
#include <experimental/simd>

namespace trigrain {

/// The pack of doubles that the vectorised kernels compute with. The instruction set is chosen here and nowhere else:
/// it is what -march allows (AVX2: 4 lanes, AVX-512: 8 lanes).
using Lanes = std::experimental::native_simd<double>;
using LaneMask = Lanes::mask_type;
inline constexpr int lane_count = static_cast<int>(Lanes::size());

// The verbs that a kernel text needs beside + - * / and comparisons, for one double and for a pack. `&` joins masks.
// A call among them would spill every register of the caller, hence always_inline.
[[gnu::always_inline]] inline double select(bool m, double yes, double no) { return m ? yes : no; }
[[gnu::always_inline]] inline double min(double a, double b) { return std::min(a, b); }
[[gnu::always_inline]] inline double max(double a, double b) { return std::max(a, b); }
[[gnu::always_inline]] inline double abs(double a) { return std::fabs(a); }
[[gnu::always_inline]] inline double sqrt(double a) { return std::sqrt(a); }

[[gnu::always_inline]] inline Lanes select(const LaneMask& m, const Lanes& yes, const Lanes& no) {
  Lanes r = no;
  where(m, r) = yes;
  return r;
}
[[gnu::always_inline]] inline Lanes min(const Lanes& a, const Lanes& b) { return std::experimental::min(a, b); }
[[gnu::always_inline]] inline Lanes max(const Lanes& a, const Lanes& b) { return std::experimental::max(a, b); }
[[gnu::always_inline]] inline Lanes abs(const Lanes& a) { return std::experimental::abs(a); }
[[gnu::always_inline]] inline Lanes sqrt(const Lanes& a) { return std::experimental::sqrt(a); }

/// The lanes of a pack from memory, any alignment.
inline Lanes load(const double* from) { return Lanes(from, std::experimental::element_aligned); }

/// x into [0, 1].
template <class T> [[gnu::always_inline]] inline T clamp01(const T& x) { return min(max(x, T(0)), T(1)); }

/// 1 / x where x > 0, else 0: degenerate edges and faces drop out of formulas instead of making NaN.
template <class T> [[gnu::always_inline]] inline T inverse_or_zero(const T& x) {
  const auto positive = x > T(0);
  return select(positive, T(1) / select(positive, x, T(1)), T(0));
}

} // namespace trigrain
