#include "pairs.hpp"
#include "oracle.hpp"
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <ios>
#include <sstream>
#include <stdexcept>

namespace trigrain {
namespace {

using Random = std::mt19937_64;
using Point = Vec3<double>;

double uniform(Random& r, double low, double high) {
  return low + (high - low) * (static_cast<double>(r() >> 11) * 0x1p-53);
}
int choose(Random& r, int n) { return static_cast<int>(r() % static_cast<std::uint64_t>(n)); }
Point cube_point(Random& r) { return {uniform(r, -1, 1), uniform(r, -1, 1), uniform(r, -1, 1)}; }
Triangle cube_triangle(Random& r) { return {cube_point(r), cube_point(r), cube_point(r)}; }
Point mix(const Triangle& t, double u, double v) { return t.a0 + u * (t.a1 - t.a0) + v * (t.a2 - t.a0); }
Point inside(const Triangle& t, Random& r) {
  const double u = uniform(r, 0, 1), v = uniform(r, 0, 1);
  return u + v <= 1 ? mix(t, u, v) : mix(t, 1 - u, 1 - v);
}
double tiny(Random& r) { return std::pow(10, uniform(r, -13, -1)); }

Pair general(Random& r) { return {"general", cube_triangle(r), cube_triangle(r)}; }
Pair separated(Random& r) {
  Pair p = general(r);
  const Point by{2.2, uniform(r, -2, 2), 0};
  p.b = {p.b.a0 + by, p.b.a1 + by, p.b.a2 + by};
  return p;
}
/// A corner of B a small gap above the face, an edge or a corner of A.
Pair near_corner(Random& r) {
  const Triangle a = cube_triangle(r);
  const double u = choose(r, 2) ? uniform(r, 0, 1) : 0, v = choose(r, 2) ? uniform(r, 0, 1 - u) : 0;
  const Point n = cross(a.a1 - a.a0, a.a2 - a.a0), foot = mix(a, u, v) + tiny(r) * n;
  return {"near_corner", a, {foot, foot + cube_point(r) + 2. * n, foot + cube_point(r) + 2. * n}};
}
/// Edges that cross a small gap apart.
Pair near_edges(Random& r) {
  const Point u = cube_point(r), v = cube_point(r), n = cross(u, v), gap = tiny(r) * n;
  const double s = uniform(r, 0, 1), t = uniform(r, 0, 1);
  return {"near_edges",
          {-s * u, (1 - s) * u, 0.3 * cube_point(r) - n},
          {gap - t * v, gap + (1 - t) * v, gap + 0.3 * cube_point(r) + n}};
}
Pair touching(Random& r) {
  Pair p{"touching", cube_triangle(r), cube_triangle(r)};
  p.b.a0 = choose(r, 2) ? p.a.a1 : inside(p.a, r); // exactly, or to rounding
  if (choose(r, 3) == 0) p.b.a1 = p.a.a2;
  return p;
}
Pair parallel(Random& r) {
  const Triangle a = cube_triangle(r);
  const Point shift = cube_point(r);
  const double turn = choose(r, 2) ? tiny(r) : 0;
  const auto moved = [&](const Point& x) { return x + shift + turn * cube_point(r); };
  return {"parallel", a, {moved(a.a1), moved(a.a2), moved(a.a0)}};
}
/// In one plane, a corner of B on an edge of A to rounding: the last bit decides whether they touch.
Pair coplanar(Random& r) {
  Pair p{"coplanar", cube_triangle(r), cube_triangle(r)};
  for (Triangle* t : {&p.a, &p.b}) t->a0.z = t->a1.z = t->a2.z = 0;
  const Point foot = mix(p.a, uniform(r, 0, 1), 0), away = foot - p.a.a2;
  p.b = {foot, foot + away + 0.1 * (p.a.a1 - p.a.a0), foot + away - 0.1 * (p.a.a1 - p.a.a0)};
  return p;
}
Pair sliver(Random& r) {
  const auto thin = [&] {
    const Point a = cube_point(r), u = cube_point(r);
    return Triangle{a, a + u, a + uniform(r, 0, 1) * u + std::pow(10, uniform(r, -9, -2)) * cube_point(r)};
  };
  const Triangle a = thin();
  Triangle b = choose(r, 2) ? thin() : cube_triangle(r);
  if (choose(r, 2)) b.a0 = inside(a, r) + tiny(r) * cube_point(r);
  return {"sliver", a, b};
}
Pair degenerate(Random& r) {
  Pair p = choose(r, 2) ? general(r) : near_corner(r);
  p.family = "degenerate";
  for (Triangle* t : {&p.a, &p.b}) {
    const int kind = choose(r, 4); // a triangle, a segment by its ends or by three points, a point
    if (kind == 1) t->a2 = choose(r, 2) ? t->a0 : t->a1;
    if (kind == 2) t->a2 = t->a0 + uniform(r, -1, 2) * (t->a1 - t->a0);
    if (kind == 3) t->a1 = t->a2 = t->a0;
  }
  return p;
}
Pair size_ratio(Random& r) {
  Pair p{"size_ratio", cube_triangle(r), cube_triangle(r)};
  const double f = std::pow(10, uniform(r, -5, -1));
  const Point at = inside(p.a, r) + tiny(r) * cube_point(r);
  p.b = {at + f * p.b.a0, at + f * p.b.a1, at + f * p.b.a2};
  return p;
}

} // namespace

const std::vector<RandomFamily>& random_families() {
  static const std::vector<RandomFamily> families{
      {"general", general},       {"separated", separated},  {"near_corner", near_corner}, {"near_edges", near_edges},
      {"touching", touching},     {"parallel", parallel},    {"coplanar", coplanar},       {"sliver", sliver},
      {"degenerate", degenerate}, {"size_ratio", size_ratio}};
  return families;
}

Pair random_pair(const RandomFamily& family, std::uint64_t k) {
  Random r(k * 7919 + 1);
  Pair p = family.make(r);
  const double factor = choose(r, 2) ? 1 : std::pow(10, uniform(r, -6, 6));
  const Point by = choose(r, 4) ? Point{0, 0, 0} : 1e4 * cube_point(r);
  for (Triangle* t : {&p.a, &p.b})
    for (Point* x : {&t->a0, &t->a1, &t->a2}) *x = factor * (*x + by);
  if (choose(r, 2)) std::swap(p.a, p.b);
  return p;
}

Pair lattice_pair(std::uint64_t k) {
  Random r(k * 104729 + 1);
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
  Pair p{"lattice", triangle(), triangle()};
  if (choose(r, 8) == 0) p.a.a0.z = p.a.a1.z = p.a.a2.z = p.b.a0.z = p.b.a1.z = p.b.a2.z = 0; // coplanar
  return p;
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

std::vector<ReferencePair> reference_pairs() {
  std::ifstream in(TRIGRAIN_TEST_DATA "/tripairs_reference.csv");
  std::string line, field;
  std::getline(in, line); // header
  std::vector<ReferencePair> pairs;
  while (std::getline(in, line)) {
    std::istringstream row(line);
    ReferencePair r;
    std::getline(row, r.pair.family, ',');
    std::getline(row, field, ',');
    std::array<double, 19> x;
    for (double& value : x) {
      if (!std::getline(row, field, ',')) throw std::runtime_error("short row: " + line);
      value = std::strtod(field.c_str(), nullptr);
    }
    r.pair.a = {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}, {x[6], x[7], x[8]}};
    r.pair.b = {{x[9], x[10], x[11]}, {x[12], x[13], x[14]}, {x[15], x[16], x[17]}};
    r.distance = x[18];
    pairs.push_back(r);
  }
  return pairs;
}

Triangles only(const Triangle& t) {
  Triangles triangles;
  triangles.push_back(t);
  return triangles;
}

Closest solve(const Kernel& kernel, const Triangle& a, const Triangle& b) {
  Hits hits;
  KernelCounts counts;
  const Triangles ta = only(a), tb = only(b);
  closest_of_all(kernel, ta.view(), tb.view(), {}, hits, counts);
  if (hits.size() != 1) throw std::runtime_error(std::string(kernel.name) + " did not answer for one pair");
  return hits[0].closest;
}

std::string fault(const Closest& c, const Pair& pair, double distance, double tolerance, bool exact) {
  using Quad = boost::multiprecision::cpp_bin_float_quad;
  const double s = scale(pair);
  for (const double x : {c.distance, c.upper, c.lower, c.p.x, c.p.y, c.p.z, c.q.x, c.q.y, c.q.z})
    if (!std::isfinite(x)) return "not finite";
  const auto in_units = [&](double x) { return " by " + std::to_string(x / s * 1e16) + "e-16 S"; };
  if (c.lower < 0 || c.lower > distance) return "lower bound is above the distance" + in_units(c.lower - distance);
  if (c.upper < distance) return "upper bound is below the distance" + in_units(distance - c.upper);
  const double apart = std::sqrt(dot(c.p - c.q, c.p - c.q));
  if (std::fabs(apart - c.distance) > tolerance * s)
    return "|p - q| is not the distance" + in_units(apart - c.distance);
  const double off_a = static_cast<double>(sqrt(oracle::distance2<Quad>(c.p, pair.a)));
  const double off_b = static_cast<double>(sqrt(oracle::distance2<Quad>(c.q, pair.b)));
  if (off_a > tolerance * s) return "p is off A" + in_units(off_a);
  if (off_b > tolerance * s) return "q is off B" + in_units(off_b);
  if (!exact) return "";
  if (std::fabs(c.distance - distance) > tolerance * s) return "distance is wrong" + in_units(c.distance - distance);
  if ((c.distance == 0) != (distance == 0)) return distance == 0 ? "touching, but not zero" : "false zero";
  return "";
}

} // namespace trigrain
