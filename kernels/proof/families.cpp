#include "kernels/proof/families.hpp"
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>
#include <utility>

namespace trigrain {
namespace {

using Point = Vec3<double>;

double uniform(Random& r, double low, double high) {
  return low + (high - low) * (static_cast<double>(r() >> 11) * 0x1p-53);
}
int choose(Random& r, int n) { return static_cast<int>(r() % static_cast<std::uint64_t>(n)); }
/// Any order of magnitude between the two.
double magnitude(Random& r, double low, double high) { return low * std::pow(high / low, uniform(r, 0, 1)); }
Point cube_point(Random& r) {
  const double x = uniform(r, -1, 1), y = uniform(r, -1, 1), z = uniform(r, -1, 1);
  return {x, y, z};
}
Point direction(Random& r) {
  const double z = uniform(r, -1, 1), phi = uniform(r, 0, 2 * std::numbers::pi), rho = std::sqrt(1 - z * z);
  return {rho * std::cos(phi), rho * std::sin(phi), z};
}
Triangle cube_triangle(Random& r) {
  const Point a = cube_point(r), b = cube_point(r), c = cube_point(r);
  return {a, b, c};
}
Triangle map(const Triangle& t, auto f) { return {f(t.a0), f(t.a1), f(t.a2)}; }
TwoTriangles map(const TwoTriangles& p, auto f) { return {map(p.a, f), map(p.b, f)}; }
Triangle moved(const Triangle& t, const Point& by) {
  return map(t, [&](const Point& x) { return x + by; });
}
Point mix(const Triangle& t, double v, double w) { return t.a0 + v * (t.a1 - t.a0) + w * (t.a2 - t.a0); }
Point inside(const Triangle& t, Random& r) {
  const double v = uniform(r, 0, 1), w = uniform(r, 0, 1);
  return v + w <= 1 ? mix(t, v, w) : mix(t, 1 - v, 1 - w);
}
Point unit_normal(const Triangle& t) {
  const Point n = cross(t.a1 - t.a0, t.a2 - t.a0);
  return 1 / std::sqrt(dot(n, n)) * n;
}
double gap(Random& r) { return magnitude(r, 1e-13, 1e-1); }

/// Coordinates with 20 bits after the point: sums, differences and halves of few of them are exact.
double coarse(double x) { return std::round(x * 0x1p20) * 0x1p-20; }
Point coarse(const Point& x) { return {coarse(x.x), coarse(x.y), coarse(x.z)}; }
double eighths(Random& r, int least, int most) { return (least + choose(r, most - least + 1)) / 8.; }

TwoTriangles random_sep(Random& r) {
  const Triangle a = cube_triangle(r), b = cube_triangle(r);
  return {a, moved(b, 2 * std::numbers::sqrt3 * direction(r))};
}
TwoTriangles random_mixed(Random& r) {
  const Triangle a = cube_triangle(r);
  return {a, cube_triangle(r)};
}
TwoTriangles random_far(Random& r) {
  const Triangle a = cube_triangle(r), b = cube_triangle(r);
  const double away = magnitude(r, 10, 1e6);
  return {a, moved(b, away * direction(r))};
}

/// A corner of B above point `foot` of A, the rest of B further up.
Triangle above(const Triangle& a, const Point& foot, double height, Random& r) {
  const Point n = unit_normal(a), tip = foot + height * n;
  const auto up = [&] { return tip + cube_point(r) + 2. * n; };
  const Point b = up(), c = up();
  return {tip, b, c};
}
TwoTriangles near_vf(Random& r) {
  const Triangle a = cube_triangle(r);
  return {a, above(a, inside(a, r), gap(r), r)};
}
TwoTriangles near_ve(Random& r) {
  const Triangle a = cube_triangle(r);
  const Point outwards = cross(a.a1 - a.a0, unit_normal(a)), foot = mix(a, uniform(r, 0, 1), 0) + gap(r) * outwards;
  return {a, {foot, foot + outwards + .3 * cube_point(r), foot + outwards + .3 * cube_point(r)}};
}
TwoTriangles near_vv(Random& r) {
  const Triangle a = cube_triangle(r);
  const Point outwards = a.a0 - .5 * (a.a1 + a.a2), tip = a.a0 + gap(r) * direction(r);
  return {a, {tip, tip + outwards + .3 * cube_point(r), tip + outwards + .3 * cube_point(r)}};
}
TwoTriangles edges_crossing(Random& r, double height) {
  const Point u = direction(r), v = direction(r), n = cross(u, v);
  const double s = uniform(r, 0, 1), t = uniform(r, 0, 1);
  const Point lift = height * n;
  return {{-s * u, (1 - s) * u, .3 * cube_point(r) - n},
          {lift - t * v, lift + (1 - t) * v, lift + .3 * cube_point(r) + n}};
}
TwoTriangles near_ee(Random& r) { return edges_crossing(r, gap(r)); }

Triangle coarse_triangle(Random& r) {
  return map(cube_triangle(r), [](const Point& x) { return coarse(x); });
}
/// A corner of B at `tip`, the rest on the upper side of A.
TwoTriangles resting(const Triangle& a, const Point& tip, Random& r) {
  const Point n = coarse(unit_normal(a));
  const auto up = [&] { return tip + coarse(cube_point(r)) + 2. * n; };
  const Point b = up(), c = up();
  return {a, {tip, b, c}};
}
TwoTriangles touch_vf(Random& r) {
  const Triangle a = coarse_triangle(r);
  const double v = eighths(r, 1, 6), w = eighths(r, 1, static_cast<int>(7 - 8 * v));
  return resting(a, mix(a, v, w), r);
}
TwoTriangles touch_ve(Random& r) {
  const Triangle a = coarse_triangle(r);
  return resting(a, mix(a, eighths(r, 1, 7), 0), r);
}
TwoTriangles touch_vv(Random& r) {
  const Triangle a = coarse_triangle(r);
  return resting(a, a.a1, r);
}
TwoTriangles touch_ee(Random& r) {
  const Point u = coarse(direction(r)), v = coarse(direction(r)), n = coarse(cross(u, v));
  const double s = eighths(r, 1, 7), t = eighths(r, 1, 7);
  return {{-s * u, (1 - s) * u, coarse(.3 * cube_point(r)) - n}, {-t * v, (1 - t) * v, coarse(.3 * cube_point(r)) + n}};
}
TwoTriangles touch_rounded(Random& r) { // the last bit decides
  const Triangle a = cube_triangle(r);
  return {a, above(a, choose(r, 2) ? inside(a, r) : mix(a, uniform(r, 0, 1), 0), 0, r)};
}
TwoTriangles shared_corner(Random& r) {
  const Triangle a = cube_triangle(r);
  return {a, {a.a1, cube_point(r), cube_point(r)}};
}
TwoTriangles shared_edge(Random& r) {
  const Triangle a = cube_triangle(r);
  return {a, {a.a2, a.a1, cube_point(r)}};
}
TwoTriangles identical(Random& r) {
  const Triangle a = cube_triangle(r);
  return {a, a};
}

/// An edge of B through the face of A, deep by `depth`.
TwoTriangles crossing(Random& r, double depth) {
  const Triangle a = cube_triangle(r);
  return {a, above(a, inside(a, r), -depth, r)};
}
TwoTriangles cross_deep(Random& r) { return crossing(r, uniform(r, .1, 1)); }
TwoTriangles cross_shallow(Random& r) { return choose(r, 2) ? crossing(r, gap(r)) : edges_crossing(r, -gap(r)); }

TwoTriangles parallel_to(Random& r, double noise) {
  const Triangle a = cube_triangle(r);
  const Point shift = cube_point(r);
  return {a, map(Triangle{a.a1, a.a2, a.a0}, [&](const Point& x) { return x + shift + noise * cube_point(r); })};
}
TwoTriangles parallel_exact(Random& r) {
  TwoTriangles p{coarse_triangle(r), coarse_triangle(r)};
  for (Point* x : {&p.a.a0, &p.a.a1, &p.a.a2}) x->z = 0;
  const double height = choose(r, 2) ? coarse(uniform(r, 0, 1)) : gap(r);
  for (Point* x : {&p.b.a0, &p.b.a1, &p.b.a2}) x->z = height;
  return p;
}
TwoTriangles parallel_near(Random& r) { return parallel_to(r, magnitude(r, 1e-17, 1e-2)); }
TwoTriangles parallel_edges(Random& r) { // an edge of each, side by side, from exactly parallel to nearly so
  const Point u = direction(r), n = cross(u, direction(r)), at = uniform(r, -1, 1) * u + magnitude(r, 1e-12, 1) * n;
  const Point v = uniform(r, .1, 1) * u + (choose(r, 3) ? magnitude(r, 1e-17, 1e-3) : 0) * cube_point(r);
  return {{{0, 0, 0}, u, .3 * cube_point(r) - n}, {at, at + v, at + .3 * cube_point(r) + n}};
}

TwoTriangles flattened(TwoTriangles p) {
  for (Triangle* t : {&p.a, &p.b}) t->a0.z = t->a1.z = t->a2.z = 0;
  return p;
}
TwoTriangles coplanar_sep(Random& r) { // a corner of B beside an edge of A: the last bit may decide whether they touch
  TwoTriangles p = flattened(random_mixed(r));
  const Point away = mix(p.a, uniform(r, 0, 1), 0) - p.a.a2, foot = p.a.a2 + (choose(r, 2) ? 1 + gap(r) : 1) * away;
  p.b = {foot, foot + away + .1 * (p.a.a1 - p.a.a0), foot + away - .1 * (p.a.a1 - p.a.a0)};
  return p;
}
TwoTriangles coplanar_mixed(Random& r) { return flattened(random_mixed(r)); }
TwoTriangles contained(Random& r) { // B in the plane of A and inside, exactly where three binary digits suffice
  const Triangle a = coarse_triangle(r);
  return {a, {mix(a, .125, .125), mix(a, eighths(r, 2, 6), .125), mix(a, .125, eighths(r, 2, 6))}};
}

Triangle sliver(Random& r) { // aspect ratio 1e2 to 1e9
  const Point a = cube_point(r), u = cube_point(r);
  return {a, a + u, a + uniform(r, 0, 1) * u + magnitude(r, 1e-9, 1e-2) * cube_point(r)};
}
TwoTriangles sliver_near(Random& r) {
  const Triangle a = sliver(r);
  const Triangle b = choose(r, 2) ? sliver(r) : cube_triangle(r);
  return {a, moved(b, inside(a, r) + gap(r) * direction(r) - b.a0)};
}
TwoTriangles sliver_cross(Random& r) {
  const Triangle a = sliver(r);
  const Triangle b = choose(r, 2) ? sliver(r) : cube_triangle(r);
  return {a, moved(b, inside(a, r) - inside(b, r))};
}
TwoTriangles sliver_mixed(Random& r) {
  const Triangle a = sliver(r);
  return {a, choose(r, 2) ? sliver(r) : cube_triangle(r)};
}

TwoTriangles any_near(Random& r) {
  static constexpr std::array makers{near_vf, near_ee, near_ve, near_vv, random_mixed, touch_vf, cross_shallow};
  return makers[choose(r, makers.size())](r);
}
void degenerate(Triangle& t, int kind, Random& r) {
  if (kind == 1) t.a2 = choose(r, 2) ? t.a0 : t.a1;
  if (kind == 2) t.a2 = t.a0 + uniform(r, -1, 2) * (t.a1 - t.a0);
  if (kind == 3) t.a1 = t.a2 = t.a0;
}
TwoTriangles degenerate_seg(Random& r) { // by two corners or by three on a line, to rounding; one or both triangles
  TwoTriangles p = any_near(r);
  degenerate(p.a, 1 + choose(r, 2), r);
  if (choose(r, 2)) degenerate(p.b, 1 + choose(r, 2), r);
  return p;
}
TwoTriangles degenerate_pt(Random& r) {
  TwoTriangles p = any_near(r);
  degenerate(p.b, 3, r);
  degenerate(p.a, choose(r, 4), r);
  return p;
}

TwoTriangles scaled(const TwoTriangles& p, double factor) {
  return map(p, [&](const Point& x) { return factor * x; });
}
template <int power> TwoTriangles scale_1e(Random& r) {
  const double factor = std::pow(10, power);
  return scaled(any_near(r), factor);
}
TwoTriangles offset_1e4(Random& r) {
  const Point by = 1e4 * cube_point(r);
  return map(any_near(r), [&](const Point& x) { return x + by; });
}
TwoTriangles size_ratio(Random& r) { // up to 1e6
  const Triangle a = cube_triangle(r), b = cube_triangle(r);
  const double factor = magnitude(r, 1e-6, 1e-1);
  const Point at = inside(a, r) + gap(r) * cube_point(r);
  return {a, map(b, [&](const Point& x) { return at + factor * x; })};
}
TwoTriangles mesh_near(Random& r) { // facets of two round bodies that nearly touch
  const auto facet = [&](const Point& pole) {
    const double half = magnitude(r, 1e-2, .5);
    const auto corner = [&] {
      const Point x = pole + half * cube_point(r);
      return 1 / std::sqrt(dot(x, x)) * x;
    };
    const Point a = corner(), b = corner(), c = corner();
    return Triangle{a, b, c};
  };
  const Point pole = direction(r);
  const Triangle a = facet(pole), b = facet(-1. * pole);
  return {a, moved(b, (2 + magnitude(r, 1e-6, .1)) * pole)};
}
TwoTriangles lattice(Random& r) { // small integers touch, cross, coincide and degenerate all the time
  const int half = 1 + choose(r, 4);
  const auto corner = [&] {
    const auto c = [&] { return static_cast<double>(choose(r, 2 * half + 1) - half); };
    const double x = c(), y = c(), z = c();
    return Point{x, y, z};
  };
  const auto triangle = [&] {
    const Point a = corner(), b = corner(), c = corner();
    return Triangle{a, b, c};
  };
  TwoTriangles p{triangle(), triangle()};
  return choose(r, 8) == 0 ? flattened(p) : p;
}

constexpr std::array families{
    RandomFamily{"random_mixed", "both in a cube: two in five cross", random_mixed},
    RandomFamily{"random_sep", "in cubes beside one another", random_sep},
    RandomFamily{"random_far", "1e1 to 1e6 edges apart", random_far},
    RandomFamily{"near_vf", "a corner 1e-13 to .1 above a face", near_vf},
    RandomFamily{"near_ee", "edges that cross 1e-13 to .1 apart", near_ee},
    RandomFamily{"near_vv", "corners 1e-13 to .1 apart", near_vv},
    RandomFamily{"near_ve", "a corner 1e-13 to .1 beside an edge", near_ve},
    RandomFamily{"touch_vf", "a corner exactly on a face", touch_vf},
    RandomFamily{"touch_ee", "edges that meet exactly", touch_ee},
    RandomFamily{"touch_ve", "a corner exactly on an edge", touch_ve},
    RandomFamily{"touch_vv", "a corner in common, B above A", touch_vv},
    RandomFamily{"touch_rounded", "touching to rounding: the last bit decides", touch_rounded},
    RandomFamily{"shared_corner", "a corner in common", shared_corner},
    RandomFamily{"shared_edge", "an edge in common", shared_edge},
    RandomFamily{"identical", "the same triangle twice", identical},
    RandomFamily{"cross_deep", "an edge through a face", cross_deep},
    RandomFamily{"cross_shallow", "a corner or an edge 1e-13 to .1 through the other", cross_shallow},
    RandomFamily{"parallel_exact", "in parallel planes, heights 1e-13 to 1", parallel_exact},
    RandomFamily{"parallel_near", "copies moved, with noise 1e-17 to 1e-2", parallel_near},
    RandomFamily{"parallel_edges", "edges at angles of 0 and 1e-17 to 1e-3", parallel_edges},
    RandomFamily{"coplanar_sep", "in one plane, at gaps of 0 and 1e-13 to .1", coplanar_sep},
    RandomFamily{"coplanar_mixed", "in one plane, most overlap", coplanar_mixed},
    RandomFamily{"contained", "B in the plane of A and inside", contained},
    RandomFamily{"sliver_near", "aspect ratio 1e2 to 1e9, 1e-13 to .1 apart", sliver_near},
    RandomFamily{"sliver_cross", "aspect ratio 1e2 to 1e9, through one another", sliver_cross},
    RandomFamily{"sliver_mixed", "aspect ratio 1e2 to 1e9, anywhere", sliver_mixed},
    RandomFamily{"degenerate_seg", "zero area: segments", degenerate_seg},
    RandomFamily{"degenerate_pt", "zero area: points", degenerate_pt},
    RandomFamily{"offset_1e4", "coordinates of 1e4", offset_1e4},
    RandomFamily{"scale_1em6", "edges of 1e-6 m", scale_1e<-6>},
    RandomFamily{"scale_1em3", "edges of 1e-3 m", scale_1e<-3>},
    RandomFamily{"scale_1e3", "edges of 1e3 m", scale_1e<3>},
    RandomFamily{"scale_1e6", "edges of 1e6 m", scale_1e<6>},
    RandomFamily{"size_ratio", "edges 1e1 to 1e6 times as long", size_ratio},
    RandomFamily{"mesh_near", "facets of two round bodies", mesh_near},
    RandomFamily{"lattice", "corners are small integers", lattice},
};

} // namespace

std::span<const RandomFamily> random_families() { return families; }

Pair random_pair(const RandomFamily& family, std::uint64_t k) {
  Random r(k * 7919 + 1);
  TwoTriangles p = family.make(r);
  if (choose(r, 2)) p = scaled(p, std::ldexp(1, choose(r, 41) - 20));
  for (Triangle* t : {&p.a, &p.b}) {
    if (choose(r, 2)) std::swap(t->a0, t->a1);
    for (int turns = choose(r, 3); turns > 0; --turns) *t = {t->a1, t->a2, t->a0};
  }
  if (choose(r, 2)) std::swap(p.a, p.b);
  return {std::string(family.name), p.a, p.b};
}

std::ostream& operator<<(std::ostream& out, const Pair& pair) {
  std::ostringstream text;
  text << pair.family << std::hexfloat;
  for (const Triangle& t : {pair.a, pair.b})
    for (const Point& x : {t.a0, t.a1, t.a2}) text << ',' << x.x << ',' << x.y << ',' << x.z;
  return out << text.str();
}

double scale(const Pair& pair) {
  double s = 0;
  for (const Triangle& t : {pair.a, pair.b})
    for (const auto& [u, v] : {std::pair{t.a0, t.a1}, {t.a1, t.a2}, {t.a2, t.a0}})
      s = std::max({s, std::sqrt(dot(u - v, u - v)), std::fabs(u.x), std::fabs(u.y), std::fabs(u.z)});
  return s;
}

} // namespace trigrain
