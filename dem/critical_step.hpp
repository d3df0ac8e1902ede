#pragma once
#include "dem/scene.hpp"

namespace trigrain {

/// Largest step (s) at which symplectic Euler is stable for any one contact point of the scene:
/// (2 / w)(sqrt(1 + zeta^2) - zeta), with w and zeta of the effective mass at that point, which turns the bodies too.
/// Infinite if nothing moves. Bodies that touch at several points at once need smaller steps still.
double critical_step(const Scene& scene);

} // namespace trigrain
