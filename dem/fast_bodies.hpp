#pragma once
#include "dem/particles.hpp"

namespace trigrain {

/// How far (m) each body may move in a step without missing a contact: two bodies see each other within the sum of
/// their halos, so neither gets past the other while each moves by no more than its own halo and the smallest of the
/// others'. Infinite for bodies that cannot touch.
std::vector<double> seen_within(const Particles& particles);

/// No point of body i is faster than this about its centre (m/s).
inline double turning_speed(const Particles& p, int i) {
  return p.is_sphere(i) ? 0 : p.angular_velocity(i).norm() * p.radius[i];
}

/// No point of body i is faster than this (m/s); 0 for fixed bodies.
inline double fastest_point(const Particles& p, int i) {
  return p.fixed(i) ? 0 : p.velocity[i].norm() + turning_speed(p, i);
}

} // namespace trigrain
