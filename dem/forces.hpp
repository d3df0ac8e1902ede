#pragma once
#include "dem/contact.hpp"
#include "dem/loads.hpp"
#include "dem/particles.hpp"
#include <span>

namespace trigrain {

/// Hands the tangential springs of the last step's contacts on to the same contacts of this step; both sorted by
/// (a, b, feature_a, feature_b).
void carry_springs(std::span<const Contact> last, std::span<Contact> contacts);

/// Spring-dashpot with Coulomb friction (Cundall & Strack 1979): normal force
/// max(0, k overlap + 2 zeta sqrt(k m) v_n) with the contact's `mass`, never attractive; tangential spring and dashpot
/// of `tangential_ratio` times the normal ones, capped at mu times the normal force. Sets `force` and `torque` and
/// moves `tangential` on by step_s (s).
void contact_forces(const Particles& particles, const ContactParameters& law, double step_s,
                    std::span<Contact> contacts);

/// Adds the force of a contact to the loads of one of its bodies.
void add_contact_load(const Particles& particles, const Contact& contact, bool to_a, Loads& loads);

/// What the springs hold (J).
double elastic_energy(const ContactParameters& law, std::span<const Contact> contacts);

} // namespace trigrain
