#pragma once
#include "dem/contact.hpp"
#include "dem/contact_law.hpp"
#include "dem/loads.hpp"
#include "dem/particles.hpp"
#include <span>

namespace trigrain {

/// Normal force max(0, spring + dashpot) of the contacts' law, never attractive; tangential spring and dashpot, capped
/// at mu times the normal force. Sets what follows the touch in `contacts`, and moves their `springs` on by step_s (s).
/// `spin`: angular velocity of each body (rad/s).
void contact_forces(const Particles& particles, std::span<const Eigen::Vector3d> spin, const ContactLaw& law,
                    const ContactParameters& parameters, double step_s, std::span<Contact> contacts,
                    std::span<HeldSpring> springs);

/// What the contacts of one body pair do to A.
Reaction reaction_of(const Particles& particles, std::span<const Contact> contacts);
/// Adds a reaction to the loads of one of its bodies.
void add_reaction(const Particles& particles, const Reaction& reaction, bool to_a, Loads& loads);

/// A contact that its springs cannot stop before the surfaces cross.
struct FastContact {
  double time = 0; ///< s
  int a = -1, b = -1;
  double speed = 0, limit = 0; ///< of approach; the fastest that undamped springs stop from here (m/s)
};
FastContact fast_contact(const Particles& particles, const ContactParameters& law, const Contact& contact,
                         double time_s);

/// What the springs hold (J).
double elastic_energy(std::span<const Contact> contacts);

} // namespace trigrain
