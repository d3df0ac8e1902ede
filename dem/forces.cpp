#include "dem/forces.hpp"
#include "dem/contact_law.hpp"
#include "dem/vectors.hpp"
#include "kernels/triangle_pair.hpp"
#include <algorithm>
#include <cmath>

namespace trigrain {
namespace {

using Eigen::Vector3d;

/// Of the material point of body i that is at x (m/s); spin in rad/s.
Vector3d velocity_at(const Particles& p, int i, const Vector3d& spin, const Vector3d& x) {
  return p.velocity[i] + spin.cross(x - p.position[i]);
}

/// Springs turned into the planes of `normal`, at their length; and loaded at constant force where a contact has become
/// stiffer, so that pressing a sheared contact does not create energy (Thornton et al. 2013). None at stiffness 0.
Vec3<Lanes> turned_springs(const Vec3<Lanes>& stretch, const Lanes& old_stiffness, const Vec3<Lanes>& normal,
                           const Lanes& stiffness) {
  const Vec3<Lanes> in_plane = stretch - dot(stretch, normal) * normal;
  const Lanes length2 = squared(in_plane);
  const Lanes scale = min(Lanes(1), old_stiffness / stiffness) * sqrt(squared(stretch) / length2);
  return select((length2 > Lanes(0)) & (stiffness > Lanes(0)), scale, Lanes(0)) * in_plane;
}

/// What undamped springs still take up (J) until the surfaces cross. What a share leaves out, other contacts hold.
Lanes energy_to_crossing(const ContactParameters& parameters, const ContactLaw& law, const Particles& p,
                         const ContactPack& pack, const Lanes& energy) {
  const Lanes halos = pack.numbers([&](const Contact& c) { return p.halo[c.a] + p.halo[c.b]; });
  return max(Lanes(0), law.energy(parameters, p, pack, halos) - energy);
}

/// The dashpots' coefficients (kg/s) in this step, so that the rebound is right to second order in the step. Velocities
/// are those of half a step ago: with the force that has acted since, spring and dashpot are stiffer by 1 + z, which a
/// dashpot smaller by the root of that makes up for. A contact that opened since the last step has pressed for the part
/// of a step that its overlap tells, at first with a dashpot that grows as overlap to the power q.
Lanes dashpots(const Spring& s, const ContactPack& pack, const Lanes& overlap, const Lanes& old_stiffness,
               const Lanes& separation_speed, double step_s) {
  const Lanes z = lag(s, pack, step_s), way = -separation_speed * Lanes(step_s);
  Lanes damping = s.damping / sqrt(Lanes(1) + z);
  const auto opens = (old_stiffness == Lanes(0)) & (overlap < way);
  if (none_of(opens)) return damping;
  const Lanes q = (s.tangent / s.secant - Lanes(1)) / Lanes(2);
  for (int i = 0; i < pack.size(); ++i) {
    if (!opens[i]) continue;
    double part = .5 + overlap[i] / way[i];
    if (q[i] > 0) part *= std::pow(part * way[i] / overlap[i], q[i]) / (1 + q[i]);
    damping[i] = part * s.damping[i] / (1 + part * z[i]);
  }
  return damping;
}

} // namespace

FastContact fast_contact(const Particles& p, const ContactParameters& parameters, const Contact& c, double time) {
  const ContactLaw& law = law_of(parameters);
  const Vector3d relative =
      velocity_at(p, c.a, p.angular_velocity(c.a), c.point) - velocity_at(p, c.b, p.angular_velocity(c.b), c.point);
  const ContactPack pack({&c, 1});
  const Lanes left = energy_to_crossing(parameters, law, p, pack, law.energy(parameters, p, pack, pack.overlap()));
  return {time, c.a, c.b, -relative.dot(c.normal), std::sqrt(2 * left[0] / (c.share * c.mass))};
}

namespace {

/// contact_forces() of one pack: the first of `contacts` and `springs`.
[[gnu::flatten]] void forces_of_pack(const Particles& p, std::span<const Vector3d> spin, const ContactLaw& law,
                                     const ContactParameters& parameters, double step_s, const ContactPack& pack,
                                     std::span<Contact> contacts, std::span<HeldSpring> springs) {
  const int count = pack.size();
  const Vec3<Lanes> normal = pack.normal(), push = pack.push(),
                    relative = pack.relative_velocity(p.position, p.velocity, spin);
  const Lanes overlap = pack.overlap();
  const LanesFrom<HeldSpring> old = lanes_from(springs.data(), count);
  const Vec3<Lanes> stretch = gather_vectors(
      old, [](const HeldSpring& s) -> auto& { return s.stretch; });
  const Lanes old_stiffness = gather(old, [](const HeldSpring& s) { return s.stiffness; });

  const Spring s = law.spring(parameters, p, pack, overlap);
  const Lanes &k = s.secant, &kt = s.tangential, zero(0), step(step_s);
  const Lanes separation_speed = dot(relative, normal);
  const Lanes damping = dashpots(s, pack, overlap, old_stiffness, separation_speed, step_s);
  const Lanes damping_t = damping * sqrt(kt / s.tangent);
  const Lanes pressed = dot(push, normal);
  const Lanes f_n = max(zero, k * pressed - damping * separation_speed);
  const Vec3<Lanes> slip = relative - separation_speed * normal;
  const Lanes held = old_stiffness / Lanes(2) * squared(stretch);
  Vec3<Lanes> spring = turned_springs(stretch, old_stiffness, normal, kt) + step * slip;
  Vec3<Lanes> f_t = -kt * spring - damping_t * slip;
  const Lanes most = Lanes(parameters.friction) * f_n, size2 = squared(f_t);
  const auto slides = size2 > most * most; // the spring gives way until it alone carries mu f_n, and stores no more
  const Lanes kept = select(slides, most / sqrt(size2), Lanes(1));
  f_t = kept * f_t;
  const Lanes give = select(kt > zero, Lanes(-1) / kt, zero);
  const auto after = [&](const Lanes& f, const Lanes& x) { return select(slides, give * f, x); };
  spring = {after(f_t.x, spring.x), after(f_t.y, spring.y), after(f_t.z, spring.z)};
  const Lanes now_held = kt / Lanes(2) * squared(spring);
  const auto fast =
      (separation_speed < zero) & (pack.share() * pack.mass() / Lanes(2) * separation_speed * separation_speed >
                                   energy_to_crossing(parameters, law, p, pack, s.energy));
  const Vec3<Lanes> force = k * (push - pressed * normal) + f_n * normal + f_t;

  scatter(spring, count, [&](int i, const Vector3d& x) { springs[i].stretch = x; });
  scatter(kt, count, [&](int i, double x) { springs[i].stiffness = x; });
  scatter(now_held, count, [&](int i, double x) { contacts[i].held = x; });
  scatter(held - now_held, count, [&](int i, double x) { contacts[i].released = x; });
  scatter(s.energy, count, [&](int i, double x) { contacts[i].spring_energy = x; });
  scatter(k, count, [&](int i, double x) { contacts[i].stiffness = x; });
  scatter(force, count, [&](int i, const Vector3d& x) { contacts[i].force = x; });
  const unsigned sliding = bits_of(slides), too_fast = bits_of(fast);
  for (int i = 0; i < count; ++i) contacts[i].slides = sliding >> i & 1, contacts[i].fast = too_fast >> i & 1;
}

} // namespace

void contact_forces(const Particles& p, std::span<const Vector3d> spin, const ContactLaw& law,
                    const ContactParameters& parameters, double step_s, std::span<Contact> contacts,
                    std::span<HeldSpring> springs) {
  for_packs(contacts, [&](std::size_t first, const ContactPack& pack) {
    forces_of_pack(p, spin, law, parameters, step_s, pack, contacts.subspan(first), springs.subspan(first));
  });
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
