#pragma once
#include "dem/scene.hpp"

namespace trigrain {

/// Largest step (s) at which symplectic Euler is stable for any one contact of the scene: a contact point on any
/// vertex, or a flat face on all of its corners, against the lightest other body. (2 / w)(sqrt(1 + zeta^2) - zeta),
/// with w^2 the largest eigenvalue of M^-1 K; a little more is stable, since dashpots are taken smaller for long steps.
/// Infinite if nothing moves. A body between several others needs smaller
/// steps still: contact_step_limit() knows those that it touches.
double critical_step(const Scene& scene);

} // namespace trigrain
