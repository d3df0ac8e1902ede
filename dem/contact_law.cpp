#include "dem/contact_law.hpp"
#include "dem/hertz.hpp"
#include "kernels/name_table.hpp"
#include <cmath>

namespace trigrain {
namespace {

Lanes linear_energy(const ContactParameters& law, const Particles&, const ContactPack& pack, const Lanes& overlap) {
  return Lanes(law.stiffness / 2) * pack.share() * overlap * overlap;
}

Spring spring_dashpot(const ContactParameters& law, const Particles& p, const ContactPack& pack, const Lanes& overlap) {
  const Lanes k(law.stiffness);
  return {.secant = k,
          .tangent = k,
          .tangential = Lanes(law.tangential_ratio) * k,
          .damping = Lanes(2 * law.damping_ratio) * pack.share() * sqrt(k * pack.mass()),
          .energy = linear_energy(law, p, pack, overlap)};
}

double elastic_radius(const Particles& p, int i) {
  return (p.is_sphere(i) ? p.radius[i] : p.mesh[i]->curvature_radius) + p.halo[i];
}

/// Hertz (1882); tangential stiffness of Mindlin (1949) without slip; dashpots of Tsuji, Tanaka & Ishida (1992), whose
/// restitution does not depend on speed. Fixed bodies are rigid.
Spring hertz_mindlin(const ContactParameters& law, const Particles& p, const ContactPack& pack, const Lanes& overlap) {
  std::array<double, lane_count> k{}, tangential{};
  for (int i = 0; i < pack.size(); ++i) {
    const auto [a, b] = std::pair(pack.contacts[i].a, pack.contacts[i].b);
    const HertzPair pair = hertz_pair(law, elastic_radius(p, a), elastic_radius(p, b), p.fixed(a) || p.fixed(b));
    k[i] = pair.k, tangential[i] = pair.tangential;
  }
  const Lanes root = sqrt(overlap), secant = load<Lanes>(k.data()) * root;
  return {.secant = secant,
          .tangent = Lanes(1.5) * secant,
          .tangential = load<Lanes>(tangential.data()) * root,
          .damping = Lanes(2 * law.damping_ratio) * sqrt(Lanes(1.5) * secant * pack.mass()),
          .energy = Lanes(.4) * secant * overlap * overlap};
}

Lanes hertz_energy(const ContactParameters& law, const Particles& p, const ContactPack& pack, const Lanes& overlap) {
  return hertz_mindlin(law, p, pack, overlap).energy;
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
