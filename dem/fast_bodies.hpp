#pragma once
#include "dem/particles.hpp"

namespace trigrain {

/// How far (m) each body may move in a step without missing a contact: two bodies see each other within the sum of
/// their halos, so neither gets past the other while each moves by no more than its own halo and the smallest of the
/// others'. Infinite for bodies that cannot touch.
std::vector<double> seen_within(const Particles& particles);

/// No point of body i is faster than this about its centre (m/s).
double turning_speed(const Particles& particles, int i);

/// No point of body i is faster than this (m/s); 0 for fixed bodies.
double fastest_point(const Particles& particles, int i);

} // namespace trigrain
