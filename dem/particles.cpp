#include "dem/particles.hpp"
#include "kernels/name_table.hpp"
#include <cmath>
#include <cstring>

namespace trigrain {
namespace {

constexpr double pi = 3.14159265358979323846;

void require(bool fine, int body, const char* problem) {
  if (!fine) throw InputError(std::string(problem) + " (bodies[" + std::to_string(body) + "]).");
}

} // namespace

Eigen::Vector3d Particles::angular_velocity(int i, const Eigen::Vector3d& momentum) const {
  if (fixed(i)) return Eigen::Vector3d::Zero();
  if (is_sphere(i)) return 1 / inertia[i].x() * momentum;
  const Eigen::Quaterniond& q = orientation[i];
  return q * ((q.conjugate() * momentum).cwiseQuotient(inertia[i]));
}

void Particles::reserve(int bodies) {
  for (auto* column : {&position, &velocity, &angular_momentum, &inertia}) column->reserve(bodies);
  for (auto* column : {&mass, &inverse_mass, &halo, &radius}) column->reserve(bodies);
  orientation.reserve(bodies);
  mesh.reserve(bodies);
}

void Particles::add(const Body& b) {
  const int n = size();
  require(b.position.allFinite() && b.orientation.coeffs().allFinite() && b.velocity.allFinite() &&
              b.angular_velocity.allFinite(),
          n, "position, orientation and velocities must be finite numbers");
  require(std::abs(b.orientation.norm() - 1) < 1e-6, n, "orientation must be a unit quaternion");
  require(std::isfinite(b.halo) && b.halo >= 0, n, "halo must be a finite number that is not negative");
  require(b.fixed || (std::isfinite(b.density) && b.density > 0), n, "density must be a positive number");
  require(b.mesh || (std::isfinite(b.sphere_radius) && b.sphere_radius > 0), n, "a sphere needs a positive radius");
  require(b.fixed || !b.mesh || b.mesh->volume > 0, n, "an open mesh has no mass: fix the body or close its surface");

  const double r = b.mesh ? b.mesh->radius : b.sphere_radius;
  const Eigen::Quaterniond body_axes = b.mesh ? b.mesh->axes : Eigen::Quaterniond::Identity();
  const Eigen::Vector3d origin = b.mesh ? b.mesh->origin : Eigen::Vector3d::Zero();
  const double volume = b.mesh ? b.mesh->volume : 4. / 3. * pi * r * r * r;
  const Eigen::Vector3d unit_inertia =
      b.mesh ? b.mesh->inertia : Eigen::Vector3d::Constant(2. / 5. * volume * r * r).eval();
  const double m = b.fixed ? 0 : b.density * volume;

  position.push_back(b.position + b.orientation * origin);
  velocity.push_back(b.fixed ? Eigen::Vector3d::Zero() : b.velocity);
  orientation.push_back((b.orientation * body_axes).normalized());
  mass.push_back(m);
  inverse_mass.push_back(b.fixed ? 0 : 1 / m);
  inertia.push_back(b.fixed ? Eigen::Vector3d::Zero() : (b.density * unit_inertia).eval());
  const Eigen::Quaterniond& q = orientation.back();
  angular_momentum.push_back(q * (q.conjugate() * b.angular_velocity).cwiseProduct(inertia.back()));
  halo.push_back(b.halo);
  radius.push_back(r);
  mesh.push_back(b.mesh);
}

Body Particles::body(int i) const {
  Body b;
  b.mesh = mesh[i];
  b.sphere_radius = mesh[i] ? 0 : radius[i];
  b.orientation = mesh[i] ? orientation[i] * mesh[i]->axes.conjugate() : orientation[i];
  b.position = mesh[i] ? position[i] - b.orientation * mesh[i]->origin : position[i];
  b.velocity = velocity[i];
  b.angular_velocity = angular_velocity(i);
  b.halo = halo[i];
  b.fixed = fixed(i);
  if (!b.fixed) b.density = mass[i] / (mesh[i] ? mesh[i]->volume : 4. / 3. * pi * std::pow(radius[i], 3));
  return b;
}

/// FNV-1a over 8-byte words.
std::uint64_t Particles::hash() const {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&hash](const double* values, int count) {
    for (int i = 0; i < count; ++i) {
      std::uint64_t word;
      std::memcpy(&word, values + i, sizeof word);
      hash = (hash ^ word) * 0x100000001b3u;
      hash ^= hash >> 29; // spreads the high bits, which one multiplication leaves alone
    }
  };
  for (int i = 0; i < size(); ++i) {
    add(position[i].data(), 3);
    add(orientation[i].coeffs().data(), 4);
    add(velocity[i].data(), 3);
    add(angular_momentum[i].data(), 3);
  }
  return hash;
}

} // namespace trigrain
