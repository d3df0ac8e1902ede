#pragma once
#include "dem/contact.hpp"
#include "dem/particles.hpp"
#include <span>

namespace trigrain {

/// Largest step (s) at which symplectic Euler is stable with these contacts: h^2 K + 2 h C has no eigenvalue above 4 M.
/// Springs and dashpots of all contacts together, normal and tangential; by power iteration, to a part in a thousand.
/// Infinite without contacts.
double contact_step_limit(const Particles& particles, const ContactParameters& law, std::span<const Contact> contacts);

} // namespace trigrain
