#pragma once
#include "dem/loads.hpp"
#include "dem/particles.hpp"

namespace trigrain {

/// A step (s): momenta are half a step behind positions, so loads act from the middle of the last step to that of this
/// one. With steps of one length that is symplectic Euler; with others free fall still is the exact parabola.
struct StepLength {
  double last, now;
  StepLength(double equal = 0) : last(equal), now(equal) {} // NOLINT: most steps are equal
  StepLength(double last_s, double now_s) : last(last_s), now(now_s) {}
  double kick() const { return (last + now) / 2; }
};

/// Moves bodies [begin, end) on by step.now (s): the centre of mass is kicked, then drifts; the spatial angular
/// momentum is kicked by the torque, then the free top turns by the splitting into rotations about the principal axes
/// (Dullweber, Leimkuhler & McLachlan 1997), which keeps that momentum to round-off and the orientation a rotation.
void integrate(Particles& particles, const Loads& loads, const Eigen::Vector3d& gravity, StepLength step, int begin,
               int end);

/// Kinetic energy of all bodies (J), translation and rotation.
double kinetic_energy(const Particles& particles);

/// Potential energy in the field `gravity` (m/s2), zero at the world's origin (J).
double potential_energy(const Particles& particles, const Eigen::Vector3d& gravity);

/// The state in the middle of the last step_s: positions before it, momenta half-way through its kick. There the
/// energies of symplectic Euler belong together; taken after the step their sum wavers to first order in step_s.
Particles centred(const Particles& after_step, const Loads& loads, const Eigen::Vector3d& gravity, double step_s);

} // namespace trigrain
