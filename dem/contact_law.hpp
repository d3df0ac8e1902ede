#pragma once
#include "dem/contact_pack.hpp"
#include "dem/particles.hpp"
#include <span>
#include <string_view>

namespace trigrain {

/// What contacts do at an overlap (m).
struct Spring {
  Lanes secant;     ///< normal force over overlap (N/m)
  Lanes tangent;    ///< its slope (N/m)
  Lanes tangential; ///< stiffness of the tangential spring (N/m)
  Lanes damping;    ///< of the normal dashpot (N s/m)
  Lanes energy;     ///< held by the normal spring (J)
};

/// By how much, relative, springs and their dashpots are stiffer in a step (s) for the force that has acted since
/// velocities were those of half a step ago.
inline Lanes lag(const Spring& spring, const ContactPack& pack, double step_s) {
  return spring.damping * Lanes(step_s / 2) / (pack.share() * pack.mass());
}

/// A way to turn the overlap of two bodies into a force.
struct ContactLaw {
  std::string_view name;
  std::string_view about;
  Spring (*spring)(const ContactParameters& law, const Particles& particles, const ContactPack& pack,
                   const Lanes& overlap);
  /// Spring::energy alone.
  Lanes (*energy)(const ContactParameters& law, const Particles& particles, const ContactPack& pack,
                  const Lanes& overlap);
};

std::span<const ContactLaw> contact_laws();

/// The law of that name; InputError for an unknown one.
const ContactLaw& law_of(const ContactParameters& contact);

/// InputError if the law cannot be used for a body of the scene.
void require_law_fits(const Scene& scene);

} // namespace trigrain
