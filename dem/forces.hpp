#pragma once
#include "dem/contact.hpp"
#include "dem/loads.hpp"
#include "dem/particles.hpp"
#include <span>

namespace trigrain {

/// Hands the tangential springs of a body pair's contacts in the last step on to the same contacts of this step; both
/// sorted by (feature_a, feature_b).
void carry_springs(std::span<const HeldSpring> last, std::span<Contact> contacts);

/// Normal force max(0, spring + dashpot) of the contact law, never attractive; tangential spring and dashpot, capped at
/// mu times the normal force. Sets `force` and `torque`, what the springs hold, and moves `tangential` on by step_s
/// (s).
void contact_forces(const Particles& particles, const ContactParameters& law, double step_s,
                    std::span<Contact> contacts);

/// Adds the force of a contact to the loads of one of its bodies.
void add_contact_load(const Particles& particles, const Contact& contact, bool to_a, Loads& loads);

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
