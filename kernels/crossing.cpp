// Exact triangle-triangle intersection by the signs of determinants: floating point where an error bound allows,
// Expansion otherwise. Compiled without contraction (CMakeLists.txt), which Expansion needs.
#include "kernels/crossing.hpp"
#include "kernels/expansion.hpp"
#include "kernels/triangle_pair.hpp"
#include <cmath>

namespace trigrain {
namespace {

using Point = Vec3<double>;

struct Point2 {
  double x, y;
};

Point2 without(int axis, const Point& p) {
  return axis == 0 ? Point2{p.y, p.z} : axis == 1 ? Point2{p.z, p.x} : Point2{p.x, p.y};
}

/// Twice the signed area of pqr; the sign is exact.
double turn(const Point2& p, const Point2& q, const Point2& r) {
  const double left = (p.x - r.x) * (q.y - r.y), right = (p.y - r.y) * (q.x - r.x), area = left - right;
  if (std::fabs(area) > 4 * epsilon * (std::fabs(left) + std::fabs(right))) return area; // Shewchuk (1997) needs 1.5
  using E = Expansion;
  return (E::difference(p.x, r.x) * E::difference(q.y, r.y) - E::difference(p.y, r.y) * E::difference(q.x, r.x))
      .value();
}

/// Six times the signed volume of abcd, exact up to the last rounding.
double exact_volume(const Point& a, const Point& b, const Point& c, const Point& d) {
  using E = Expansion;
  const E ax = E::difference(a.x, d.x), ay = E::difference(a.y, d.y), az = E::difference(a.z, d.z);
  const E bx = E::difference(b.x, d.x), by = E::difference(b.y, d.y), bz = E::difference(b.z, d.z);
  const E cx = E::difference(c.x, d.x), cy = E::difference(c.y, d.y), cz = E::difference(c.z, d.z);
  return (az * (bx * cy - cx * by) + bz * (cx * ay - ax * cy) + cz * (ax * by - bx * ay)).value();
}

/// Six times the signed volume of a tetrahedron; `error` bounds what is wrong with it, and its sign is exact.
struct Volume {
  double value, error;
};

Volume volume(const Point& a, const Point& b, const Point& c, const Point& d) {
  const Point u = a - d, v = b - d, w = c - d;
  const double vxwy = v.x * w.y, wxvy = w.x * v.y, wxuy = w.x * u.y, uxwy = u.x * w.y, uxvy = u.x * v.y,
               vxuy = v.x * u.y;
  const double value = u.z * (vxwy - wxvy) + v.z * (wxuy - uxwy) + w.z * (uxvy - vxuy);
  const double magnitude = std::fabs(u.z) * (std::fabs(vxwy) + std::fabs(wxvy)) +
                           std::fabs(v.z) * (std::fabs(wxuy) + std::fabs(uxwy)) +
                           std::fabs(w.z) * (std::fabs(uxvy) + std::fabs(vxuy));
  const double error = 4 * epsilon * magnitude; // Shewchuk (1997) needs 3.5
  return std::fabs(value) > error ? Volume{value, error} : Volume{exact_volume(a, b, c, d), 0};
}

bool same_side(double a, double b, double c) { return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0); }

bool in_box(const Point2& p, const Point2& q, const Point2& r) {
  return std::min(q.x, r.x) <= p.x && p.x <= std::max(q.x, r.x) && std::min(q.y, r.y) <= p.y &&
         p.y <= std::max(q.y, r.y);
}

int sign(double x) { return (x > 0) - (x < 0); }

bool segments_meet(const Point2& p, const Point2& q, const Point2& r, const Point2& s) {
  const int pq_r = sign(turn(p, q, r)), pq_s = sign(turn(p, q, s));
  const int rs_p = sign(turn(r, s, p)), rs_q = sign(turn(r, s, q));
  if (pq_r != pq_s && rs_p != rs_q) return true;
  return (pq_r == 0 && in_box(r, p, q)) || (pq_s == 0 && in_box(s, p, q)) || (rs_p == 0 && in_box(p, r, s)) ||
         (rs_q == 0 && in_box(q, r, s));
}

bool boxes_meet(const Corners<double>& a, const Corners<double>& b) {
  for (const auto axis : {&Point::x, &Point::y, &Point::z}) {
    const auto [a_min, a_max] = std::minmax({a[0].*axis, a[1].*axis, a[2].*axis});
    const auto [b_min, b_max] = std::minmax({b[0].*axis, b[1].*axis, b[2].*axis});
    if (a_max < b_min || b_max < a_min) return false;
  }
  return true;
}

/// An axis along which the triangle has a shadow of positive area; -1 if its area is zero.
int shadow_axis(const Corners<double>& t) {
  for (int axis = 0; axis < 3; ++axis)
    if (turn(without(axis, t[0]), without(axis, t[1]), without(axis, t[2])) != 0) return axis;
  return -1;
}

/// Segments in space, each possibly a point.
bool segments_meet(const Point& p, const Point& q, const Point& r, const Point& s) {
  if (!boxes_meet({p, q, q}, {r, s, s}) || volume(p, q, r, s).value != 0) return false;
  // In one plane, or on one line: they meet in space where all three shadows do.
  for (int axis = 0; axis < 3; ++axis)
    if (!segments_meet(without(axis, p), without(axis, q), without(axis, r), without(axis, s))) return false;
  return true;
}

/// Segment pq, in the plane of t, whose shadow along `axis` has area.
bool meets_in_plane(const Point& p, const Point& q, const Corners<double>& t, int axis) {
  const Point2 p2 = without(axis, p), q2 = without(axis, q);
  const Point2 t2[]{without(axis, t[0]), without(axis, t[1]), without(axis, t[2])};
  for (int k = 0; k < 3; ++k)
    if (segments_meet(p2, q2, t2[k], t2[(k + 1) % 3])) return true;
  return same_side(turn(t2[0], t2[1], p2), turn(t2[1], t2[2], p2), turn(t2[2], t2[0], p2));
}

/// Point that segment pq has in common with t, a triangle of positive area.
std::optional<Point> meeting_point(const Point& p, const Point& q, const Corners<double>& t, int axis,
                                   const Point& guess) {
  const Volume below = volume(t[0], t[1], t[2], p), above = volume(t[0], t[1], t[2], q);
  if (sign(below.value) * sign(above.value) > 0) return {};
  if (below.value == 0 && above.value == 0) return meets_in_plane(p, q, t, axis) ? std::optional(guess) : std::nullopt;
  if (!same_side(volume(p, q, t[0], t[1]).value, volume(p, q, t[1], t[2]).value, volume(p, q, t[2], t[0]).value))
    return {};
  double height_p = below.value, height_q = above.value;                           // of opposite signs
  if (below.error + above.error > 16 * epsilon * std::fabs(height_p - height_q)) { // pq nearly lies in the plane
    height_p = exact_volume(t[0], t[1], t[2], p);
    height_q = exact_volume(t[0], t[1], t[2], q);
  }
  const double s = height_p / (height_p - height_q);
  return s < 0.5 ? p + s * (q - p) : q + (1 - s) * (p - q);
}

} // namespace

std::optional<Point> common_point(const Triangle& ta, const Triangle& tb, const Point& guess) {
  const Corners<double> a = corners(ta), b = corners(tb);
  if (!boxes_meet(a, b)) return {};
  const int axis_a = shadow_axis(a), axis_b = shadow_axis(b);
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3;
    if (axis_b >= 0)
      if (const auto point = meeting_point(a[k], a[l], b, axis_b, guess)) return point;
    if (axis_a >= 0)
      if (const auto point = meeting_point(b[k], b[l], a, axis_a, guess)) return point;
  }
  if (axis_a >= 0 || axis_b >= 0) return {};
  for (int k = 0; k < 3; ++k) // both are segments or points
    for (int l = 0; l < 3; ++l)
      if (segments_meet(a[k], a[(k + 1) % 3], b[l], b[(l + 1) % 3])) return guess;
  return {};
}

} // namespace trigrain
