#include "dem/motion.hpp"
#include "dem/vectors.hpp"
#include "kernels/triangle_pair.hpp"
#include <array>
#include <cmath>
#include <span>

namespace trigrain {
namespace {

/// sin(x) / x and cos(x) from x2 = x^2. A step turns a body by small angles: there the series is exact to round-off and
/// far cheaper.
template <class T> void sin_cos(const T& x2, T& sin_by_x, T& cos) {
  // next terms x^8 / 9! and x^8 / 8!: 2e-18 and 2e-17
  sin_by_x = T(1) - x2 * (T(1 / 6.) - x2 * (T(1 / 120.) - x2 * T(1 / 5040.)));
  cos = T(1) - x2 * (T(1 / 2.) - x2 * (T(1 / 24.) - x2 * T(1 / 720.)));
  const auto wide = x2 >= T(.03 * .03);
  if (none_of(wide)) return;
  for (int lane = 0; lane < lanes_of<T>; ++lane) {
    if (!lane_set(wide, lane)) continue;
    const double x = std::sqrt(lane_of(x2, lane));
    set_lane(sin_by_x, lane, std::sin(x) / x);
    set_lane(cos, lane, std::cos(x));
  }
}

/// Free rotation about principal axis `axis` for time t: turns the body and its momentum in the body frame.
void turn(int axis, double t, const Eigen::Vector3d& inertia, Eigen::Quaterniond& q, Eigen::Vector3d& body_momentum) {
  const double half_angle = t * body_momentum[axis] / inertia[axis] / 2;
  double s, c;
  sin_cos(half_angle * half_angle, s, c);
  s *= half_angle;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const Eigen::Vector4d old = q.coeffs();     // x, y, z, w
  q.coeffs()[3] = c * old[3] - s * old[axis]; // q times (c, s about the axis)
  q.coeffs()[axis] = c * old[axis] + s * old[3];
  q.coeffs()[u] = c * old[u] + s * old[v];
  q.coeffs()[v] = c * old[v] - s * old[u];
  // In the body frame the fixed spatial momentum turns the other way by the full angle.
  const double cos_full = c * c - s * s, sin_full = 2 * s * c;
  const double mu = body_momentum[u], mv = body_momentum[v];
  body_momentum[u] = cos_full * mu + sin_full * mv;
  body_momentum[v] = cos_full * mv - sin_full * mu;
}

/// Symmetric splitting of the free top, second order in t.
void turn_free_top(Eigen::Quaterniond& q, const Eigen::Vector3d& momentum, const Eigen::Vector3d& inertia, double t) {
  Eigen::Vector3d m = q.conjugate() * momentum;
  turn(0, t / 2, inertia, q, m);
  turn(1, t / 2, inertia, q, m);
  turn(2, t, inertia, q, m);
  turn(1, t / 2, inertia, q, m);
  turn(0, t / 2, inertia, q, m);
  q.normalize();
}

/// Up to lane_count spheres turn about their momentum for time t, exactly.
[[gnu::flatten]] void turn_spheres(Particles& p, std::span<const int> spheres, double t) {
  const int count = static_cast<int>(spheres.size());
  const LanesFrom<int> each = lanes_from(spheres.data(), count);
  const auto coefficient = [&](int k) { return gather(each, [&](int i) { return p.orientation[i].coeffs()[k]; }); };
  const Vec3<Lanes> v{coefficient(0), coefficient(1), coefficient(2)};
  const Lanes w = coefficient(3), inertia = gather(each, [&](int i) { return p.inertia[i].x(); });
  const Vec3<Lanes> half = Lanes(t / 2) / inertia *
                           gather_vectors(
                               each, [&](int i) -> auto& { return p.angular_momentum[i]; });
  const Lanes x2 = squared(half);
  Lanes s, c;
  sin_cos(x2, s, c);
  const Vec3<Lanes> by = s * half; // with c: the turn, times v with w
  Vec3<Lanes> turned = c * v + w * by + cross(by, v);
  Lanes turned_w = c * w - dot(by, v);
  const Lanes unit = Lanes(1.5) - (squared(turned) + turned_w * turned_w) / Lanes(2); // Newton's step for the root,
  turned = unit * turned, turned_w = unit * turned_w;                                 // right to (rounding)^2
  scatter(turned, count, [&](int i, const Eigen::Vector3d& x) { p.orientation[spheres[i]].vec() = x; });
  scatter(turned_w, count, [&](int i, double x) { p.orientation[spheres[i]].w() = x; });
}

/// Bodies [begin, end) without any torque for time t.
void turn_freely(Particles& p, double t, int begin, int end) {
  std::array<int, lane_count> spheres;
  int count = 0;
  const auto turn_those = [&] {
    if (count > 0) turn_spheres(p, std::span(spheres).first(count), t);
    count = 0;
  };
  for (int i = begin; i < end; ++i) {
    if (p.fixed(i)) continue;
    if (p.is_sphere(i))
      spheres[count++] = i;
    else
      turn_free_top(p.orientation[i], p.angular_momentum[i], p.inertia[i], t);
    if (count == lane_count) turn_those();
  }
  turn_those();
}

} // namespace

void integrate(Particles& p, const Loads& loads, const Eigen::Vector3d& gravity, StepLength step, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    if (p.fixed(i)) continue;
    p.velocity[i] += step.kick() * (gravity + p.inverse_mass[i] * loads.force[i]);
    p.position[i] += step.now * p.velocity[i];
    p.angular_momentum[i] += step.kick() * loads.torque[i];
  }
  turn_freely(p, step.now, begin, end);
}

double kinetic_energy(const Particles& p) {
  double sum = 0;
  for (int i = 0; i < p.size(); ++i)
    sum += p.mass[i] * p.velocity[i].squaredNorm() / 2 + p.angular_momentum[i].dot(p.angular_velocity(i)) / 2;
  return sum;
}

double potential_energy(const Particles& p, const Eigen::Vector3d& gravity) {
  double sum = 0;
  for (int i = 0; i < p.size(); ++i) sum -= p.mass[i] * gravity.dot(p.position[i]);
  return sum;
}

Particles centred(const Particles& after_step, const Loads& loads, const Eigen::Vector3d& gravity, double step_s) {
  Particles p = after_step;
  for (int i = 0; i < p.size(); ++i) {
    if (p.fixed(i)) continue;
    p.position[i] -= step_s * p.velocity[i];
    p.velocity[i] -= step_s / 2 * (gravity + p.inverse_mass[i] * loads.force[i]);
  }
  turn_freely(p, -step_s, 0, p.size());
  for (int i = 0; i < p.size(); ++i)
    if (!p.fixed(i)) p.angular_momentum[i] -= step_s / 2 * loads.torque[i];
  return p;
}

} // namespace trigrain
