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
inline double select(bool m, double yes, double no) { return m ? yes : no; }
inline double min(double a, double b) { return std::min(a, b); }
inline double max(double a, double b) { return std::max(a, b); }
inline double abs(double a) { return std::fabs(a); }
inline double sqrt(double a) { return std::sqrt(a); }

inline Lanes select(const LaneMask& m, const Lanes& yes, const Lanes& no) {
  Lanes r = no;
  where(m, r) = yes;
  return r;
}
inline Lanes min(const Lanes& a, const Lanes& b) { return std::experimental::min(a, b); }
inline Lanes max(const Lanes& a, const Lanes& b) { return std::experimental::max(a, b); }
inline Lanes abs(const Lanes& a) { return std::experimental::abs(a); }
inline Lanes sqrt(const Lanes& a) { return std::experimental::sqrt(a); }

/// The lanes of a pack from memory, any alignment.
inline Lanes load(const double* from) { return Lanes(from, std::experimental::element_aligned); }

/// x into [0, 1].
template <class T> T clamp01(const T& x) { return min(max(x, T(0)), T(1)); }

/// 1 / x where x > 0, else 0: degenerate edges and faces drop out of formulas instead of making NaN.
template <class T> T inverse_or_zero(const T& x) {
  const auto positive = x > T(0);
  return select(positive, T(1) / select(positive, x, T(1)), T(0));
}

} // namespace trigrain
