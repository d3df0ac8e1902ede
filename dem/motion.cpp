#include "dem/motion.hpp"
#include <cmath>

namespace trigrain {
namespace {

/// sin(x) / x and cos(x) from x2 = x^2. A step turns a body by small angles: there the series is exact to round-off and
/// far cheaper.
void sin_cos(double x2, double& sin_by_x, double& cos) {
  if (x2 < .03 * .03) { // next terms x^8 / 9! and x^8 / 8!: 2e-18 and 2e-17
    sin_by_x = 1 - x2 * (1 / 6. - x2 * (1 / 120. - x2 * (1 / 5040.)));
    cos = 1 - x2 * (1 / 2. - x2 * (1 / 24. - x2 * (1 / 720.)));
  } else {
    const double x = std::sqrt(x2);
    sin_by_x = std::sin(x) / x;
    cos = std::cos(x);
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

/// A sphere turns about its momentum, exactly.
void turn_sphere(Eigen::Quaterniond& q, const Eigen::Vector3d& momentum, double inertia, double t) {
  const Eigen::Vector3d half = t / (2 * inertia) * momentum;
  double s, c;
  sin_cos(half.squaredNorm(), s, c);
  Eigen::Quaterniond by;
  by.w() = c;
  by.vec() = s * half;
  q = by * q;
  q.coeffs() *= 1.5 - q.squaredNorm() / 2; // a unit again: Newton's step for the root, right to (rounding)^2
}

/// Body i without any torque for time t.
void turn_freely(Particles& p, int i, double t) {
  if (p.is_sphere(i))
    turn_sphere(p.orientation[i], p.angular_momentum[i], p.inertia[i].x(), t);
  else
    turn_free_top(p.orientation[i], p.angular_momentum[i], p.inertia[i], t);
}

} // namespace

void integrate(Particles& p, const Loads& loads, const Eigen::Vector3d& gravity, StepLength step, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    if (p.fixed(i)) continue;
    p.velocity[i] += step.kick() * (gravity + p.inverse_mass[i] * loads.force[i]);
    p.position[i] += step.now * p.velocity[i];
    p.angular_momentum[i] += step.kick() * loads.torque[i];
    turn_freely(p, i, step.now);
  }
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
    turn_freely(p, i, -step_s);
    p.angular_momentum[i] -= step_s / 2 * loads.torque[i];
  }
  return p;
}

} // namespace trigrain
