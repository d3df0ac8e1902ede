#include "dem/budget.hpp"
#include "dem/contact_pack.hpp"

namespace trigrain {

using Eigen::Vector3d;

Momentum momentum_of(const Particles& p) {
  Momentum sum;
  for (int i = 0; i < p.size(); ++i) {
    sum.linear += p.mass[i] * p.velocity[i];
    sum.angular += p.mass[i] * p.position[i].cross(p.velocity[i]) + p.angular_momentum[i];
  }
  return sum;
}

void MiddleMotion::resize(int bodies) {
  velocity.resize(bodies, Vector3d::Zero());
  angular_velocity.resize(bodies, Vector3d::Zero());
}

void MiddleMotion::update(const Particles& p, const Loads& loads, const Vector3d& gravity, double kick_s, int begin,
                          int end) {
  for (int i = begin; i < end; ++i) {
    if (p.fixed(i)) continue;
    velocity[i] = p.velocity[i] + kick_s / 2 * (gravity + p.inverse_mass[i] * loads.force[i]);
    angular_velocity[i] = p.angular_velocity(i, p.angular_momentum[i] + kick_s / 2 * loads.torque[i]);
  }
}

Budget& Budget::operator+=(const Budget& o) {
  damping += o.damping;
  friction += o.friction;
  outside += o.outside;
  impulse += o.impulse;
  angular_impulse += o.angular_impulse;
  return *this;
}

KickSums& KickSums::operator+=(const KickSums& o) {
  budget += o.budget;
  pending += o.pending;
  held += o.held;
  released += o.released;
  fast_bodies += o.fast_bodies, fast_contacts += o.fast_contacts;
  return *this;
}

namespace {

/// What the contacts of a pack dissipate.
[[gnu::flatten]] void add_dissipation(const ContactPack& pack, const Particles& p, const MiddleMotion& motion,
                                      double kick_s, KickSums& sums) {
  const Vec3<Lanes> normal = pack.normal(), force = pack.vectors([](const Contact&c) -> auto& { return c.force; }),
                    relative = pack.relative_velocity(p.position, motion.velocity, motion.angular_velocity);
  const Lanes stiffness = pack.numbers([](const Contact& c) { return c.stiffness; });
  const Vec3<Lanes> other = force - stiffness * pack.push(); // dashpots and the tangential spring
  const Lanes along = dot(other, normal), kick(kick_s);
  const Lanes normal_part = -kick * along * dot(relative, normal);
  const Lanes tangential = -kick * dot(other - along * normal, relative);
  for (int i = 0; i < pack.size(); ++i) {
    const Contact& c = pack.contacts[i];
    const double dissipated = tangential[i] + c.released;
    sums.budget.damping += normal_part[i] + (c.slides ? 0 : dissipated);
    sums.budget.friction += c.slides ? dissipated : 0;
    sums.pending += (normal_part[i] + tangential[i]) / 2;
  }
}

void add_wall_impulse(const Particles& p, const Contact& c, double kick_s, Budget& budget) {
  if (!p.fixed(c.a) && !p.fixed(c.b)) return; // what one loses the other gets
  const double sign = p.fixed(c.b) ? kick_s : -kick_s;
  budget.impulse += sign * c.force;
  budget.angular_impulse += sign * (c.point.cross(c.force) + c.torque());
}

} // namespace

void add_contacts(std::span<const Contact> contacts, const Particles& p, const MiddleMotion& motion, double kick_s,
                  KickSums& sums) {
  for_packs(contacts, [&](std::size_t, const ContactPack& pack) { add_dissipation(pack, p, motion, kick_s, sums); });
  for (const Contact& c : contacts) {
    add_wall_impulse(p, c, kick_s, sums.budget);
    sums.released += c.released;
    sums.held += c.held;
    sums.fast_contacts += c.fast;
  }
}

void add_weight(const Particles& p, const Vector3d& gravity, double kick_s, int begin, int end, Budget& budget) {
  for (int i = begin; i < end; ++i) {
    const Vector3d impulse = kick_s * p.mass[i] * gravity; // fixed bodies have mass 0
    budget.impulse += impulse;
    budget.angular_impulse += p.position[i].cross(impulse);
  }
}

void add_outside(const Particles& p, const Loads& outside, const MiddleMotion& motion, double kick_s, int begin,
                 int end, Budget& budget) {
  budget.outside += work_of(outside, motion, kick_s, begin, end);
  for (int i = begin; i < end; ++i) {
    if (p.fixed(i)) continue;
    budget.impulse += kick_s * outside.force[i];
    budget.angular_impulse += kick_s * (p.position[i].cross(outside.force[i]) + outside.torque[i]);
  }
}

double work_of(const Loads& outside, const MiddleMotion& motion, double kick_s, int begin, int end) {
  double sum = 0;
  for (int i = begin; i < end; ++i)
    sum += outside.force[i].dot(motion.velocity[i]) + outside.torque[i].dot(motion.angular_velocity[i]);
  return kick_s * sum;
}

} // namespace trigrain
