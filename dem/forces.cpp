#include "dem/forces.hpp"
#include "dem/contact_law.hpp"
#include <algorithm>
#include <cmath>
#include <tuple>

namespace trigrain {
namespace {

using Eigen::Vector3d;

auto key(const auto& c) { return std::tie(c.feature_a, c.feature_b); }

/// Of the material point of body i that is at x (m/s).
Vector3d velocity_at(const Particles& p, int i, const Vector3d& x) {
  return p.velocity[i] + p.angular_velocity(i).cross(x - p.position[i]);
}

} // namespace

void carry_springs(std::span<const HeldSpring> last, std::span<Contact> contacts) {
  auto old = last.begin();
  for (Contact& c : contacts) {
    while (old != last.end() && key(*old) < key(c)) ++old;
    if (old == last.end() || key(*old) != key(c)) continue;
    c.tangential = old->tangential;
    c.tangential_stiffness = old->stiffness;
  }
}

namespace {

/// The tangential spring of c turned into the present contact plane, at its length; and loaded at constant force where
/// the contact has become stiffer, so that pressing a sheared contact does not create energy (Thornton et al. 2013).
Vector3d turned_spring(const Contact& c, double stiffness) {
  const Vector3d in_plane = c.tangential - c.tangential.dot(c.normal) * c.normal;
  const double length = in_plane.norm();
  if (!(length > 0)) return Vector3d::Zero();
  return std::min(1., c.tangential_stiffness / stiffness) * c.tangential.norm() / length * in_plane;
}

/// The largest speed of approach (m/s) that the undamped spring stops before it has taken up the sum of halos.
double fastest_stopped(const ContactParameters& parameters, const ContactLaw& law, const Particles& p, const Contact& c,
                       double energy) {
  const double all = law.spring(parameters, p, c, p.halo[c.a] + p.halo[c.b]).energy;
  return std::sqrt(2 * std::max(0., all - energy) / (c.share * c.mass)); // what a share leaves out, other contacts hold
}

} // namespace

FastContact fast_contact(const Particles& p, const ContactParameters& parameters, const Contact& c, double time) {
  const ContactLaw& law = law_of(parameters);
  const Vector3d relative = velocity_at(p, c.a, c.point) - velocity_at(p, c.b, c.point);
  return {time, c.a, c.b, -relative.dot(c.normal),
          fastest_stopped(parameters, law, p, c, law.spring(parameters, p, c, c.overlap).energy)};
}

void contact_forces(const Particles& p, const ContactParameters& parameters, double step_s,
                    std::span<Contact> contacts) {
  const ContactLaw& law = law_of(parameters);
  for (Contact& c : contacts) {
    const Spring s = law.spring(parameters, p, c, c.overlap);
    const double k = s.secant, kt = s.tangential;
    const double damping_t = s.damping * std::sqrt(kt / s.tangent);
    const Vector3d relative = velocity_at(p, c.a, c.point) - velocity_at(p, c.b, c.point);
    const double separation_speed = relative.dot(c.normal);
    const double pressed = c.push.dot(c.normal);
    const double f_n = std::max(0., k * pressed - s.damping * separation_speed);
    const Vector3d slip = relative - separation_speed * c.normal;
    const double held = c.tangential_stiffness / 2 * c.tangential.squaredNorm();
    Vector3d spring = (kt > 0 ? turned_spring(c, kt) : Vector3d::Zero()) + step_s * slip;
    Vector3d f_t = -kt * spring - damping_t * slip;
    const double most = parameters.friction * f_n, size = f_t.norm();
    c.slides = size > most;
    if (c.slides) { // the spring gives way until it alone carries mu f_n, and stores no more than that
      f_t *= most / size;
      spring = kt > 0 ? (-f_t / kt).eval() : Vector3d::Zero().eval();
    }
    c.tangential = spring;
    c.tangential_stiffness = kt;
    const double holds = kt / 2 * spring.squaredNorm();
    c.released = held - holds;
    c.spring_energy = s.energy + holds;
    c.elastic = k * c.push;
    c.fast = separation_speed < 0 && separation_speed < -fastest_stopped(parameters, law, p, c, s.energy);
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

double elastic_energy(std::span<const Contact> contacts) {
  double sum = 0;
  for (const Contact& c : contacts) sum += c.spring_energy;
  return sum;
}

} // namespace trigrain
