#pragma once
#include "dem/contact.hpp"
#include "dem/particles.hpp"
#include "dem/scene.hpp"
#include <span>

namespace trigrain {

/// Largest step (s) at which symplectic Euler is stable for any one contact of the scene: a contact point on any
/// vertex, or a flat face on all of its corners, against the lightest other body. (2 / w)(sqrt(1 + zeta^2) - zeta),
/// with w^2 the largest eigenvalue of M^-1 K. Infinite if nothing moves. A body between several others needs smaller
/// steps still: contact_step_limit() knows those that it touches.
double critical_step(const Scene& scene);

/// Largest step (s) at which symplectic Euler is stable with these contacts: h^2 K + 2 h C has no eigenvalue above 4 M.
/// Springs and dashpots of all contacts together, normal and tangential; by power iteration, to a part in a thousand.
/// Infinite without contacts.
double contact_step_limit(const Particles& particles, const ContactParameters& law, std::span<const Contact> contacts);

} // namespace trigrain
