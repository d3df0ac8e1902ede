#include "dem/hertz.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace trigrain {
namespace {

/// Restitution of the clipped dashpot (Schwager & Poeschel 2007).
double linear_restitution(double zeta) {
  if (zeta >= 1)
    return std::exp(-zeta * std::log((zeta + std::sqrt(zeta * zeta - 1)) / (zeta - std::sqrt(zeta * zeta - 1))) /
                    std::sqrt(zeta * zeta - 1));
  const double w = std::sqrt(1 - zeta * zeta);
  return std::exp(-zeta / w * (std::numbers::pi - std::atan2(2 * zeta * w, w * w - zeta * zeta)));
}

/// The same of x'' = -x^3/2 - 2 zeta sqrt(3/2) x^1/4 x', from x = 0, x' = 1 until the sum is no longer a push.
double hertz_restitution(double zeta) {
  const auto pull = [&](double x, double v) {
    x = std::max(0., x);
    return x * std::sqrt(x) + 2 * zeta * std::sqrt(1.5) * std::sqrt(std::sqrt(x)) * v;
  };
  double x = 0, v = 1;
  for (const double h = 1e-3; v > 0 || pull(x, v) > 0;) {
    const double v1 = -pull(x, v), v2 = -pull(x + h / 2 * v, v + h / 2 * v1);
    const double v3 = -pull(x + h / 2 * (v + h / 2 * v1), v + h / 2 * v2);
    const double v4 = -pull(x + h * (v + h / 2 * v2), v + h * v3);
    x += h * v + h * h / 6 * (v1 + v2 + v3);
    v += h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
  }
  return std::max(0., -v);
}

template <double restitution(double)> double damping_for(double e) {
  double low = 0, high = 10;
  for (int i = 0; i < 40; ++i) (restitution((low + high) / 2) > e ? low : high) = (low + high) / 2;
  return e >= 1 ? 0 : (low + high) / 2;
}

double hertz_stiffness(const Scene& scene) {
  double radius = 0, halo = 0, wall_halo = 0;
  for (const Body& b : scene.bodies) {
    if (b.fixed) {
      wall_halo = std::max(wall_halo, b.halo);
      continue;
    }
    radius = std::max(radius, (b.mesh ? b.mesh->curvature_radius : b.sphere_radius) + b.halo);
    halo = std::max(halo, b.halo);
  }
  const double wall = hertz_pair(scene.contact, radius, std::numeric_limits<double>::infinity(), true).k,
               pair = hertz_pair(scene.contact, radius, radius, false).k;
  return 1.5 * std::max(wall * std::sqrt(halo + wall_halo), pair * std::sqrt(2 * halo));
}

} // namespace

HertzPair hertz_pair(const ContactParameters& law, double radius_a, double radius_b, bool one_is_rigid) {
  const double bodies = one_is_rigid ? 1 : 2, nu = law.poisson_ratio, e = law.youngs_modulus;
  const double radius = 1 / (1 / radius_a + 1 / radius_b);
  const double modulus = e / (bodies * (1 - nu * nu)), shear = e / (2 * (1 + nu)) / (bodies * (2 - nu));
  return {4. / 3. * modulus * std::sqrt(radius), 8 * shear * std::sqrt(radius)};
}

double largest_stiffness(const Scene& scene) {
  return scene.contact.law == "hertz-mindlin" ? hertz_stiffness(scene) : scene.contact.stiffness;
}

double damping_ratio_for(const std::string& law, double restitution) {
  return law == "hertz-mindlin" ? damping_for<hertz_restitution>(restitution)
                                : damping_for<linear_restitution>(restitution);
}

} // namespace trigrain
