#include "dem/forces.hpp"
#include <algorithm>
#include <cmath>
#include <tuple>

namespace trigrain {
namespace {

using Eigen::Vector3d;

auto key(const Contact& c) { return std::tie(c.a, c.b, c.feature_a, c.feature_b); }

/// Of the material point of body i that is at x (m/s).
Vector3d velocity_at(const Particles& p, int i, const Vector3d& x) {
  return p.velocity[i] + p.angular_velocity(i).cross(x - p.position[i]);
}

} // namespace

void carry_springs(std::span<const Contact> last, std::span<Contact> contacts) {
  auto old = last.begin();
  for (Contact& c : contacts) {
    while (old != last.end() && key(*old) < key(c)) ++old;
    if (old != last.end() && key(*old) == key(c)) c.tangential = old->tangential;
  }
}

void contact_forces(const Particles& p, const ContactParameters& law, double step_s, std::span<Contact> contacts) {
  const double k = law.stiffness, kt = law.tangential_ratio * k;
  for (Contact& c : contacts) {
    const double damping = 2 * law.damping_ratio * c.share * std::sqrt(k * c.mass);
    const double damping_t = damping * std::sqrt(law.tangential_ratio);
    const Vector3d relative = velocity_at(p, c.a, c.point) - velocity_at(p, c.b, c.point);
    const double separation_speed = relative.dot(c.normal);
    const double pressed = c.push.dot(c.normal);
    const double f_n = std::max(0., k * pressed - damping * separation_speed);
    const Vector3d slip = relative - separation_speed * c.normal;
    // The spring turns with the contact plane and keeps its length.
    const Vector3d in_plane = c.tangential - c.tangential.dot(c.normal) * c.normal;
    const double length = in_plane.norm();
    Vector3d spring =
        length > 0 ? (c.tangential.norm() / length * in_plane + step_s * slip).eval() : (step_s * slip).eval();
    Vector3d f_t = -kt * spring - damping_t * slip;
    const double most = law.friction * f_n, size = f_t.norm();
    if (size > most) { // sliding: the spring gives way until it alone carries mu f_n, and stores no more than that
      f_t *= most / size;
      spring = kt > 0 ? (-f_t / kt).eval() : Vector3d::Zero().eval();
    }
    c.tangential = spring;
    c.force = k * (c.push - pressed * c.normal) + f_n * c.normal + f_t;
    c.torque = k * c.couple;
  }
}

void add_contact_load(const Particles& p, const Contact& c, bool to_a, Loads& loads) {
  const int body = to_a ? c.a : c.b;
  const double sign = to_a ? 1 : -1;
  loads.force[body] += sign * c.force;
  loads.torque[body] += sign * ((c.point - p.position[body]).cross(c.force) + c.torque);
}

double elastic_energy(const ContactParameters& law, std::span<const Contact> contacts) {
  double sum = 0;
  for (const Contact& c : contacts)
    sum += law.stiffness / 2 * (c.share * c.overlap * c.overlap + law.tangential_ratio * c.tangential.squaredNorm());
  return sum;
}

} // namespace trigrain
