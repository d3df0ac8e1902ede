#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
// GCC 12 warns about its own AVX-512 headers.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wuninitialized"
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <experimental/simd>
#ifdef __AVX512F__
#include <immintrin.h>
#endif
#pragma GCC diagnostic pop

namespace trigrain {

namespace stdx = std::experimental;

/// N numbers that are computed with at once; one is a plain number, so that one text serves any width. The instruction
/// set is chosen here and nowhere else: it is what -march allows.
template <class Scalar, int N> struct PackOf { using type = stdx::simd<Scalar, stdx::simd_abi::deduce_t<Scalar, N>>; };
template <class Scalar> struct PackOf<Scalar, 1> { using type = Scalar; };
template <class Scalar, int N> using Pack = typename PackOf<Scalar, N>::type;

/// The widest packs of this build (AVX2: 4 doubles, 8 floats; AVX-512: 8 and 16).
using Lanes = stdx::native_simd<double>;
using FloatLanes = stdx::native_simd<float>;
inline constexpr int lane_count = static_cast<int>(Lanes::size());
inline constexpr int float_lane_count = static_cast<int>(FloatLanes::size());

template <class T> struct PackTraits {
  using Scalar = typename T::value_type;
  using Mask = typename T::mask_type;
  static constexpr int lanes = static_cast<int>(T::size());
};
template <> struct PackTraits<double> {
  using Scalar = double;
  using Mask = bool;
  static constexpr int lanes = 1;
};
template <> struct PackTraits<float> {
  using Scalar = float;
  using Mask = bool;
  static constexpr int lanes = 1;
};
template <class T> using ScalarOf = typename PackTraits<T>::Scalar;
template <class T> using MaskOf = typename PackTraits<T>::Mask;
template <class T> inline constexpr int lanes_of = PackTraits<T>::lanes;
template <class T> inline constexpr bool is_pack = lanes_of<T> > 1;

/// Spacing of the numbers at 1 in T's precision: 2^-52 or 2^-23.
template <class T> inline constexpr double epsilon_of = std::numeric_limits<ScalarOf<T>>::epsilon();

/// A number in all lanes. (GCC 12 calls a function per lane for simd's own constructor where it does not inline it.)
template <class T> [[gnu::always_inline]] inline T broadcast(ScalarOf<T> x) {
  using Vector [[gnu::vector_size(lanes_of<T> * sizeof(ScalarOf<T>))]] = ScalarOf<T>;
  if constexpr (is_pack<T> && std::is_constructible_v<T, Vector>)
    return T(x - Vector{});
  else
    return T(x);
}

/// A constant in all lanes, rounded to T's precision.
template <class T> [[gnu::always_inline]] inline T constant(double x) {
  return broadcast<T>(static_cast<ScalarOf<T>>(x));
}

// The verbs that a kernel text needs beside + - * / and comparisons, for one number and for a pack. `&` joins masks.
// A call among them would spill every register of the caller, hence always_inline.
[[gnu::always_inline]] inline double select(bool m, double yes, double no) { return m ? yes : no; }
[[gnu::always_inline]] inline double min(double a, double b) { return std::min(a, b); }
[[gnu::always_inline]] inline double max(double a, double b) { return std::max(a, b); }
[[gnu::always_inline]] inline double abs(double a) { return std::fabs(a); }
[[gnu::always_inline]] inline double sqrt(double a) { return std::sqrt(a); }
[[gnu::always_inline]] inline float select(bool m, float yes, float no) { return m ? yes : no; }
[[gnu::always_inline]] inline float min(float a, float b) { return std::min(a, b); }
[[gnu::always_inline]] inline float max(float a, float b) { return std::max(a, b); }
[[gnu::always_inline]] inline float abs(float a) { return std::fabs(a); }
[[gnu::always_inline]] inline float sqrt(float a) { return std::sqrt(a); }
[[gnu::always_inline]] inline bool any_of(bool m) { return m; }
[[gnu::always_inline]] inline bool all_of(bool m) { return m; }
[[gnu::always_inline]] inline bool none_of(bool m) { return !m; }

template <class S, class A> [[gnu::always_inline]] inline stdx::simd<S, A>
select(const stdx::simd_mask<S, A>& m, const stdx::simd<S, A>& yes, const stdx::simd<S, A>& no) {
  stdx::simd<S, A> r = no;
  where(m, r) = yes;
  return r;
}

/// The lanes of a pack from memory, any alignment; doubles are rounded to float where T is one.
template <class T, class From> [[gnu::always_inline]] inline T load(const From* from) {
  if constexpr (!is_pack<T>)
    return static_cast<T>(*from);
  else
    return T(from, stdx::element_aligned);
}
template <class T, class To> [[gnu::always_inline]] inline void store(const T& x, To* to) {
  if constexpr (!is_pack<T>)
    *to = static_cast<To>(x);
  else
    x.copy_to(to, stdx::element_aligned);
}

/// A pack of get(0), get(1), ...
template <class T, class Get> [[gnu::always_inline]] inline T gathered(const Get& get) {
  if constexpr (!is_pack<T>)
    return get(0);
  else
    return T([&](auto lane) { return get(lane); });
}

/// Doubles that go into a pack of T, in one pack of doubles or in `halves` of them.
template <class T> inline constexpr int halves = lanes_of<T> > lane_count ? lanes_of<T> / lane_count : 1;
template <class T> using Wide = Pack<double, lanes_of<T> / halves<T>>;

/// A pack of T from part(0), part(1), ... of doubles (Wide<T>), rounded where T is of floats.
template <class T, class Part> [[gnu::always_inline]] inline T rounded(Part part) {
  if constexpr (std::is_same_v<T, Wide<T>>) return part(0);
#ifdef __AVX512F__
  else if constexpr (lanes_of<T> == 16) {
    const __m256 low = _mm512_cvtpd_ps(static_cast<__m512d>(part(0))),
                 high = _mm512_cvtpd_ps(static_cast<__m512d>(part(1)));
    return T(
        _mm512_castpd_ps(_mm512_insertf64x4(_mm512_castps_pd(_mm512_castps256_ps512(low)), _mm256_castps_pd(high), 1)));
  }
#endif
  else {
    std::array<ScalarOf<T>, lanes_of<T>> each;
    for (int k = 0; k < halves<T>; ++k) store(part(k), each.data() + k * lanes_of<Wide<T>>);
    return load<T>(each.data());
  }
}

/// Half k of a pack (the pack itself where it is of doubles), in double.
template <class T> [[gnu::always_inline]] inline Wide<T> half(const T& x, int k) {
  if constexpr (std::is_same_v<T, Wide<T>>) return x;
#ifdef __AVX512F__
  else if constexpr (lanes_of<T> == 16) {
    const __m512 all = static_cast<__m512>(x);
    return Wide<T>(_mm512_cvtps_pd(k == 0 ? _mm512_castps512_ps256(all)
                                          : _mm256_castpd_ps(_mm512_extractf64x4_pd(_mm512_castps_pd(all), 1))));
  }
#endif
  else {
    std::array<ScalarOf<T>, lanes_of<T>> each;
    store(x, each.data());
    return load<Wide<T>>(each.data() + k * lanes_of<Wide<T>>);
  }
}

/// to[0], to[1], ... = those of the lanes whose bit is set. Writes a whole pack: what follows the last of them is
/// undefined.
template <class W> [[gnu::always_inline]] inline void store_selected(const W& x, unsigned bits, double* to) {
#ifdef __AVX512F__
  if constexpr (lanes_of<W> == 8) {
    store(W(_mm512_maskz_compress_pd(static_cast<__mmask8>(bits), static_cast<__m512d>(x))), to);
    return;
  }
#endif
  std::array<double, lanes_of<W>> each;
  store(x, each.data());
  for (; bits != 0; bits &= bits - 1) *to++ = each[std::countr_zero(bits)];
}

/// to[0], to[1], ... = x[lane] + plus[lane], in double, for all lanes or those whose bit is set; writes like
/// store_selected(). No `plus` is 0.
template <bool all, class T>
[[gnu::always_inline]] inline void store_doubles(const T& x, const double* plus, unsigned bits, double* to) {
  constexpr int width = lanes_of<Wide<T>>;
  for (int k = 0; k < halves<T>; ++k) {
    const Wide<T> part = plus ? half(x, k) + load<Wide<T>>(plus + k * width) : half(x, k);
    if constexpr (all) {
      store(part, to + k * width);
    } else {
      const unsigned of_half = bits >> (k * width) & ((1u << width) - 1);
      store_selected(part, of_half, to);
      to += std::popcount(of_half);
    }
  }
}

template <class T> [[gnu::always_inline]] inline ScalarOf<T> lane_of(const T& x, int lane) {
  if constexpr (!is_pack<T>)
    return x;
  else
    return x[lane];
}
template <class T> [[gnu::always_inline]] inline void set_lane(T& x, int lane, ScalarOf<T> to) {
  if constexpr (!is_pack<T>)
    x = to;
  else
    x[lane] = to;
}
template <class Mask> [[gnu::always_inline]] inline bool lane_set(const Mask& m, int lane) {
  if constexpr (std::is_same_v<Mask, bool>)
    return m;
  else
    return m[lane];
}

/// x into [0, 1].
template <class T> [[gnu::always_inline]] inline T clamp01(const T& x) { return min(max(x, T(0)), T(1)); }

/// 1 / x where x > 0, else 0: degenerate edges and faces drop out of formulas instead of making NaN.
template <class T> [[gnu::always_inline]] inline T inverse_or_zero(const T& x) {
  const auto positive = x > T(0);
  return select(positive, T(1) / select(positive, x, T(1)), T(0));
}

/// The powers of two p <= x < 2 p of floats, and 1 / p; 1 for numbers that have none within a float's range.
template <class T> [[gnu::always_inline]] inline void power_of_two_below(const T& x, T& p, T& inverse) {
  if constexpr (std::is_trivially_copyable_v<T>) {
    constexpr std::uint32_t exponent = 0x7f800000, one = 0x3f800000;
    using Bits [[gnu::vector_size(sizeof(T))]] = std::uint32_t;
    Bits bits = std::bit_cast<Bits>(x) & exponent;
    bits = bits - 1 < 2 * one - 1 ? bits : Bits{} + one; // neither zero nor 2^127 and more
    p = std::bit_cast<T>(bits);
    inverse = std::bit_cast<T>(2 * one - bits);
  } else // a pack of several registers, as 16 floats are on AVX2
    for (int lane = 0; lane < static_cast<int>(T::size()); ++lane) {
      float p_here, inverse_here;
      power_of_two_below<float>(x[lane], p_here, inverse_here);
      p[lane] = p_here;
      inverse[lane] = inverse_here;
    }
}

/// The lanes of m as bits.
template <class Mask> [[gnu::always_inline]] inline unsigned bits_of(const Mask& m) {
  if constexpr (std::is_arithmetic_v<Mask>) // bool, or int where two of them were joined
    return m;
  else {
    unsigned bits = 0;
#ifdef __AVX512F__
    if constexpr (Mask::size() >= 8 && sizeof(m) <= 2)
      bits = static_cast<unsigned>(m.__to_bitset().to_ulong());
    else
#endif
      for (int lane = 0; lane < static_cast<int>(Mask::size()); ++lane) bits |= static_cast<unsigned>(m[lane]) << lane;
    return bits;
  }
}

/// Calls visit(first + lane) for the lanes whose bit is set, in order; those from `end` on do not count.
template <class Visit>
[[gnu::always_inline]] inline void for_lanes(unsigned bits, int first, int end, const Visit& visit) {
  if (end - first < lane_count) bits &= (1u << (end - first)) - 1;
  for (; bits != 0; bits &= bits - 1) visit(first + std::countr_zero(bits));
}

/// to[0], to[1], ... = those of the eight elements whose bit is set; returns how many. Writes eight: what follows the
/// last of them is undefined. Without branches where the machine can compress a register.
template <class E> [[gnu::always_inline]] inline int store_selected(const std::array<E, 8>& x, unsigned bits, E* to) {
  static_assert(sizeof(E) == 4 || sizeof(E) == 8);
#if defined(__AVX512VL__)
  if constexpr (sizeof(E) == 8)
    _mm512_storeu_si512(to, _mm512_maskz_compress_epi64(static_cast<__mmask8>(bits), _mm512_loadu_si512(x.data())));
  else
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to),
                        _mm256_maskz_compress_epi32(static_cast<__mmask8>(bits),
                                                    _mm256_loadu_si256(reinterpret_cast<const __m256i*>(x.data()))));
  return std::popcount(bits);
#else
  int n = 0;
  for (; bits != 0; bits &= bits - 1) to[n++] = x[std::countr_zero(bits)];
  return n;
#endif
}

} // namespace trigrain
