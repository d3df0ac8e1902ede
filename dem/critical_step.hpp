#pragma once
#include "dem/scene.hpp"

namespace trigrain {

/// Largest step (s) at which symplectic Euler is stable for any one contact of the scene: a contact point on any
/// vertex, or a flat face on all of its corners, against the lightest other body. (2 / w)(sqrt(1 + zeta^2) - zeta),
/// with w^2 the largest eigenvalue of M^-1 K; a little more is stable, since dashpots are taken smaller for long steps.
/// Infinite if nothing moves. A body between several others needs smaller
/// steps still: contact_step_limit() knows those that it touches.
double critical_step(const Scene& scene);

/// Largest step h (s) at which symplectic Euler is stable for an oscillator of stiffness k and damping c per mass
/// (1/s2, 1/s), its dashpot fed with the velocity of half a step ago: h^2 k + 2 h c = 4.
double stable_step(double k, double c);

} // namespace trigrain
