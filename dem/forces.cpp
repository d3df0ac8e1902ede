#include "dem/forces.hpp"
#include "dem/contact_law.hpp"
#include <algorithm>
#include <cmath>
#include <tuple>

namespace trigrain {
namespace {

using Eigen::Vector3d;

auto key(const auto& c) { return std::tie(c.feature_a, c.feature_b); }

/// Of the material point of body i that is at x (m/s); spin in rad/s.
Vector3d velocity_at(const Particles& p, int i, const Vector3d& spin, const Vector3d& x) {
  return p.velocity[i] + spin.cross(x - p.position[i]);
}

} // namespace

void carry_springs(std::span<const HeldSpring> last, std::span<const Contact> contacts, std::span<HeldSpring> springs) {
  auto old = last.begin();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    springs[i] = {contacts[i].feature_a, contacts[i].feature_b};
    while (old != last.end() && key(*old) < key(springs[i])) ++old;
    if (old != last.end() && key(*old) == key(springs[i])) springs[i] = *old;
  }
}

namespace {

/// The spring turned into the plane of `normal`, at its length; and loaded at constant force where the contact has
/// become stiffer, so that pressing a sheared contact does not create energy (Thornton et al. 2013).
Vector3d turned_spring(const HeldSpring& spring, const Vector3d& normal, double stiffness) {
  const Vector3d in_plane = spring.stretch - spring.stretch.dot(normal) * normal;
  const double length2 = in_plane.squaredNorm();
  if (!(length2 > 0)) return Vector3d::Zero();
  return std::min(1., spring.stiffness / stiffness) * std::sqrt(spring.stretch.squaredNorm() / length2) * in_plane;
}

/// What the undamped spring still takes up (J) until the surfaces cross. What a share leaves out, other contacts hold.
double energy_to_crossing(const ContactParameters& parameters, const ContactLaw& law, const Particles& p,
                          const Contact& c, double energy) {
  return std::max(0., law.energy(parameters, p, c, p.halo[c.a] + p.halo[c.b]) - energy);
}

/// The dashpot's coefficient (kg/s) in this step, so that the rebound is right to second order in the step. Velocities
/// are those of half a step ago: with the force that has acted since, spring and dashpot are stiffer by 1 + z, which a
/// dashpot smaller by the root of that makes up for. A contact that opened since the last step has pressed for the part
/// of a step that its overlap tells, at first with a dashpot that grows as overlap to the power q.
double dashpot(const Spring& s, const Contact& c, const HeldSpring& tangential, double separation_speed,
               double step_s) {
  const double z = lag(s, c, step_s), way = -separation_speed * step_s;
  const bool opens = tangential.stiffness == 0 && c.overlap < way;
  if (!opens) return s.damping / std::sqrt(1 + z);
  double part = .5 + c.overlap / way;
  const double q = (s.tangent / s.secant - 1) / 2;
  if (q > 0) part *= std::pow(part * way / c.overlap, q) / (1 + q);
  return part * s.damping / (1 + part * z);
}

} // namespace

FastContact fast_contact(const Particles& p, const ContactParameters& parameters, const Contact& c, double time) {
  const ContactLaw& law = law_of(parameters);
  const Vector3d relative =
      velocity_at(p, c.a, p.angular_velocity(c.a), c.point) - velocity_at(p, c.b, p.angular_velocity(c.b), c.point);
  const double left = energy_to_crossing(parameters, law, p, c, law.energy(parameters, p, c, c.overlap));
  return {time, c.a, c.b, -relative.dot(c.normal), std::sqrt(2 * left / (c.share * c.mass))};
}

void contact_forces(const Particles& p, std::span<const Vector3d> spin, const ContactLaw& law,
                    const ContactParameters& parameters, double step_s, std::span<Contact> contacts,
                    std::span<HeldSpring> springs) {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    Contact& c = contacts[i];
    HeldSpring& tangential = springs[i];
    const Spring s = law.spring(parameters, p, c, c.overlap);
    const double k = s.secant, kt = s.tangential;
    const Vector3d relative = velocity_at(p, c.a, spin[c.a], c.point) - velocity_at(p, c.b, spin[c.b], c.point);
    const double separation_speed = relative.dot(c.normal);
    const double damping = dashpot(s, c, tangential, separation_speed, step_s);
    const double damping_t = damping * std::sqrt(kt / s.tangent);
    const double pressed = c.push.dot(c.normal);
    const double f_n = std::max(0., k * pressed - damping * separation_speed);
    const Vector3d slip = relative - separation_speed * c.normal;
    const double held = tangential.stiffness / 2 * tangential.stretch.squaredNorm();
    Vector3d spring = (kt > 0 ? turned_spring(tangential, c.normal, kt) : Vector3d::Zero()) + step_s * slip;
    Vector3d f_t = -kt * spring - damping_t * slip;
    const double most = parameters.friction * f_n, size2 = f_t.squaredNorm();
    c.slides = size2 > most * most;
    if (c.slides) { // the spring gives way until it alone carries mu f_n, and stores no more than that
      f_t *= most / std::sqrt(size2);
      spring = kt > 0 ? (-f_t / kt).eval() : Vector3d::Zero().eval();
    }
    tangential.stretch = spring;
    tangential.stiffness = kt;
    c.held = kt / 2 * spring.squaredNorm();
    c.released = held - c.held;
    c.spring_energy = s.energy;
    c.stiffness = k;
    c.fast = separation_speed < 0 && c.share * c.mass / 2 * separation_speed * separation_speed >
                                         energy_to_crossing(parameters, law, p, c, s.energy);
    c.force = k * (c.push - pressed * c.normal) + f_n * c.normal + f_t;
  }
}

Reaction reaction_of(const Particles& p, std::span<const Contact> contacts) {
  Reaction sum{contacts.front().a, contacts.front().b};
  const Vector3d centre = p.position[sum.a];
  for (const Contact& c : contacts) {
    sum.force += c.force;
    sum.torque += (c.point - centre).cross(c.force) + c.torque();
  }
  return sum;
}

void add_reaction(const Particles& p, const Reaction& r, bool to_a, Loads& loads) {
  if (to_a) {
    loads.force[r.a] += r.force;
    loads.torque[r.a] += r.torque;
  } else {
    loads.force[r.b] -= r.force;
    loads.torque[r.b] -= r.torque + (p.position[r.a] - p.position[r.b]).cross(r.force);
  }
}

double elastic_energy(std::span<const Contact> contacts) {
  double sum = 0;
  for (const Contact& c : contacts) sum += c.spring_energy + c.held;
  return sum;
}

} // namespace trigrain
