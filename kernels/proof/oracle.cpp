#include "kernels/proof/oracle.hpp"
#include "kernels/proof/bounded.hpp"
#include <array>
#include <bit>
#include <boost/multiprecision/cpp_int.hpp>
#include <climits>
#include <cmath>
#include <optional>

namespace trigrain::oracle {
namespace {

namespace mp = boost::multiprecision;
// 1024 bits without allocation; grows beyond.
using Integer = mp::number<mp::cpp_int_backend<1024, 0, mp::signed_magnitude, mp::unchecked>, mp::et_off>;
int sign(const Integer& x) { return x.sign(); }

template <class N> using Point = std::array<N, 3>;
template <class N> using Corners = std::array<Point<N>, 3>;
template <class N> struct Pair { Corners<N> a, b; };
/// num / den with den > 0.
template <class N> struct Fraction { N num, den; };

template <class N> Point<N> operator-(const Point<N>& a, const Point<N>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class N> N dot(const Point<N>& a, const Point<N>& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
template <class N> Point<N> cross(const Point<N>& a, const Point<N>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class N> N squared(const Point<N>& v) { return dot(v, v); }
template <class N> bool less(const Fraction<N>& x, const Fraction<N>& y) {
  return sign(x.num * y.den - y.num * x.den) < 0;
}

// The critical points of the squared distance; none where they are not inside their features.

/// Point p and edge xy.
template <class N> std::optional<Fraction<N>> on_edge(const Point<N>& p, const Point<N>& x, const Point<N>& y) {
  const Point<N> r = p - x, u = y - x;
  const N uu = squared(u), ru = dot(r, u);
  if (sign(ru) <= 0 || sign(uu - ru) <= 0) return {};
  return Fraction<N>{squared(cross(r, u)), uu};
}

/// Point p and the face of t.
template <class N> std::optional<Fraction<N>> on_face(const Point<N>& p, const Corners<N>& t) {
  const Point<N> e = t[1] - t[0], f = t[2] - t[0], r = p - t[0], n = cross(e, f);
  const N nn = squared(n), v = dot(cross(r, f), n), w = dot(cross(e, r), n), h = dot(r, n);
  if (sign(v) <= 0 || sign(w) <= 0 || sign(nn - v - w) <= 0) return {};
  return Fraction<N>{h * h, nn};
}

/// The lines of edges a0a1 and b0b1.
template <class N>
std::optional<Fraction<N>> on_lines(const Point<N>& a0, const Point<N>& a1, const Point<N>& b0, const Point<N>& b1) {
  const Point<N> u = a1 - a0, v = b1 - b0, r = b0 - a0, n = cross(u, v);
  const N nn = squared(n), s = dot(cross(r, v), n), t = dot(cross(r, u), n), h = dot(r, n);
  if (sign(s) <= 0 || sign(nn - s) <= 0 || sign(t) <= 0 || sign(nn - t) <= 0) return {};
  return Fraction<N>{h * h, nn};
}

/// Does segment pq go from one side of t to the other through its face or border?
template <class N> bool pierces(const Point<N>& p, const Point<N>& q, const Corners<N>& t) {
  const Point<N> n = cross(t[1] - t[0], t[2] - t[0]);
  const N hp = dot(p - t[0], n), hq = dot(q - t[0], n);
  if (sign(hp) * sign(hq) >= 0) return false;
  const int upwards = sign(hp);
  const N span = hp - hq;
  const Point<N> d = q - p;
  for (int k = 0; k < 3; ++k) {
    const Point<N> r = p - t[k];
    const Point<N> x{span * r[0] + hp * d[0], span * r[1] + hp * d[1], span * r[2] + hp * d[2]};
    if (sign(dot(cross(t[(k + 1) % 3] - t[k], x), n)) * upwards < 0) return false;
  }
  return true;
}

constexpr int features = 6 + 9 + 9 + 18 + 6;

/// Squared distance at the critical point of one of the features: 0-5 an edge through the other face, 6-14 edges,
/// 15-23 corners, 24-41 corner and edge, 42-47 corner and face.
template <class N> std::optional<Fraction<N>> critical(const Pair<N>& pair, int number) {
  const auto& [a, b] = pair;
  const auto next = [](int k) { return (k + 1) % 3; };
  const bool of_a = number % 2;
  const Corners<N>&mine = of_a ? a : b, &other = of_a ? b : a;
  if (number < 6) {
    const int k = number / 2;
    return pierces(mine[k], mine[next(k)], other) ? std::optional(Fraction<N>{N(0), N(1)}) : std::nullopt;
  }
  if (number < 15) {
    const int k = (number - 6) / 3, l = (number - 6) % 3;
    return on_lines(a[k], a[next(k)], b[l], b[next(l)]);
  }
  if (number < 24) return Fraction<N>{squared(a[(number - 15) / 3] - b[(number - 15) % 3]), N(1)};
  if (number < 42) {
    const int k = (number - 24) / 2 / 3, l = (number - 24) / 2 % 3;
    return on_edge(mine[k], other[l], other[next(l)]);
  }
  return on_face(mine[(number - 42) / 2], other);
}

template <class N> struct Nearest {
  int number;
  Fraction<N> distance2;
};

template <class N> Nearest<N> nearest(const Pair<N>& pair) {
  std::optional<Nearest<N>> best;
  for (int number = 0; number < features; ++number) {
    const auto d2 = critical(pair, number);
    if (!d2 || (best && !less(*d2, best->distance2))) continue;
    best = {number, *d2};
    if (sign(d2->num) == 0) break;
  }
  return *best;
}

using Coordinates = std::array<double, 18>;
Coordinates coordinates(const Triangle& a, const Triangle& b) {
  return {a.a0.x, a.a0.y, a.a0.z, a.a1.x, a.a1.y, a.a1.z, a.a2.x, a.a2.y, a.a2.z,
          b.a0.x, b.a0.y, b.a0.z, b.a1.x, b.a1.y, b.a1.z, b.a2.x, b.a2.y, b.a2.z};
}
template <class N, class Make> Pair<N> pair_of(const Coordinates& x, Make make) {
  Pair<N> pair;
  for (int c = 0; c < 18; ++c) (c < 9 ? pair.a : pair.b)[c % 9 / 3][c % 3] = make(x[c]);
  return pair;
}

/// The pair as integers, in units of 2^exponent m, the last bit of any coordinate.
struct Whole {
  Pair<Integer> pair;
  int exponent;

  explicit Whole(const Coordinates& x) : exponent(INT_MAX) {
    constexpr int digits = 53;
    for (const double c : x) {
      int e;
      const double m = std::frexp(c, &e);
      if (m == 0) continue;
      const auto bits = static_cast<std::uint64_t>(std::fabs(std::ldexp(m, digits)));
      exponent = std::min(exponent, e - digits + std::countr_zero(bits));
    }
    pair = pair_of<Integer>(x, [&](double c) {
      int e;
      const double m = std::frexp(c, &e);
      if (m == 0) return Integer(0);
      const auto whole = static_cast<std::int64_t>(std::ldexp(m, digits));
      const int shift = e - digits - exponent;
      return shift >= 0 ? Integer(whole) << shift : Integer(whole >> -shift);
    });
  }
  Quad metres(const Fraction<Integer>& d2) const {
    if (d2.num.sign() == 0) return 0;
    return ldexp(sqrt(static_cast<Quad>(d2.num) / static_cast<Quad>(d2.den)), exponent);
  }
};

} // namespace

Quad distance(const Triangle& a, const Triangle& b, Decisions* decisions) {
  const Coordinates x = coordinates(a, b);
  const Whole whole(x);
  try {
    const int number = nearest(pair_of<Bounded>(x, [](double c) { return Bounded(c); })).number;
    if (decisions) ++decisions->filtered;
    return whole.metres(*critical(whole.pair, number));
  } catch (const Doubt&) {
    if (decisions) ++decisions->exact;
    return whole.metres(nearest(whole.pair).distance2);
  }
}

Quad distance_unfiltered(const Triangle& a, const Triangle& b) {
  const Whole whole(coordinates(a, b));
  return whole.metres(nearest(whole.pair).distance2);
}

Quad distance(const Vec3<double>& p, const Triangle& t) { return distance({p, p, p}, t); }

} // namespace trigrain::oracle
