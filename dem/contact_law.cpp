#include "dem/contact_law.hpp"
#include "dem/hertz.hpp"
#include "kernels/name_table.hpp"
#include <cmath>

namespace trigrain {
namespace {

double linear_energy(const ContactParameters& law, const Particles&, const Contact& c, double overlap) {
  return law.stiffness / 2 * c.share * overlap * overlap;
}

Spring spring_dashpot(const ContactParameters& law, const Particles& p, const Contact& c, double overlap) {
  const double k = law.stiffness;
  return {.secant = k,
          .tangent = k,
          .tangential = law.tangential_ratio * k,
          .damping = 2 * law.damping_ratio * c.share * std::sqrt(k * c.mass),
          .energy = linear_energy(law, p, c, overlap)};
}

double elastic_radius(const Particles& p, int i) {
  return (p.is_sphere(i) ? p.radius[i] : p.mesh[i]->curvature_radius) + p.halo[i];
}

/// Hertz (1882); tangential stiffness of Mindlin (1949) without slip; dashpots of Tsuji, Tanaka & Ishida (1992), whose
/// restitution does not depend on speed. Fixed bodies are rigid.
Spring hertz_mindlin(const ContactParameters& law, const Particles& p, const Contact& c, double overlap) {
  const HertzPair pair = hertz_pair(law, elastic_radius(p, c.a), elastic_radius(p, c.b), p.fixed(c.a) || p.fixed(c.b));
  const double root = std::sqrt(overlap), secant = pair.k * root;
  return {.secant = secant,
          .tangent = 1.5 * secant,
          .tangential = pair.tangential * root,
          .damping = 2 * law.damping_ratio * std::sqrt(1.5 * secant * c.mass),
          .energy = .4 * secant * overlap * overlap};
}

double hertz_energy(const ContactParameters& law, const Particles& p, const Contact& c, double overlap) {
  return hertz_mindlin(law, p, c, overlap).energy;
}

constexpr ContactLaw table[] = {
    {"spring-dashpot", "linear spring and dashpot, tangential ones in a fixed ratio (Cundall & Strack 1979)",
     spring_dashpot, linear_energy},
    {"hertz-mindlin",
     "spheres and icospheres of an elastic material; fixed bodies are rigid (Hertz 1882, Mindlin 1949)", hertz_mindlin,
     hertz_energy},
};

} // namespace

std::span<const ContactLaw> contact_laws() { return table; }

const ContactLaw& law_of(const ContactParameters& contact) {
  return row_named(contact_laws(), "contact law", contact.law);
}

void require_law_fits(const Scene& scene) {
  if (&law_of(scene.contact) == &table[0]) return;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& b = scene.bodies[i];
    if (!b.fixed && b.mesh && std::isinf(b.mesh->curvature_radius))
      throw InputError("law 'hertz-mindlin' needs a radius of curvature, which a moving '" + b.mesh->name +
                       "' has not (bodies[" + std::to_string(i) +
                       "]). Take sphere_m, icosphere or law 'spring-dashpot'.");
  }
}

} // namespace trigrain
