#pragma once
#include "dem/contact.hpp"
#include "dem/particles.hpp"
#include <span>
#include <string_view>

namespace trigrain {

/// What a contact does at an overlap (m).
struct Spring {
  double secant;     ///< normal force over overlap (N/m)
  double tangent;    ///< its slope (N/m)
  double tangential; ///< stiffness of the tangential spring (N/m)
  double damping;    ///< of the normal dashpot (N s/m)
  double energy;     ///< held by the normal spring (J)
};

/// By how much, relative, a spring and its dashpot are stiffer in a step (s) for the force that has acted since
/// velocities were those of half a step ago.
inline double lag(const Spring& spring, const Contact& contact, double step_s) {
  return spring.damping * step_s / (2 * contact.share * contact.mass);
}

/// A way to turn the overlap of two bodies into a force.
struct ContactLaw {
  std::string_view name;
  std::string_view about;
  Spring (*spring)(const ContactParameters& law, const Particles& particles, const Contact& contact, double overlap);
  /// Spring::energy alone.
  double (*energy)(const ContactParameters& law, const Particles& particles, const Contact& contact, double overlap);
};

std::span<const ContactLaw> contact_laws();

/// The law of that name; InputError for an unknown one.
const ContactLaw& law_of(const ContactParameters& contact);

/// InputError if the law cannot be used for a body of the scene.
void require_law_fits(const Scene& scene);

} // namespace trigrain
