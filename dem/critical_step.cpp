#include "dem/critical_step.hpp"
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace trigrain {
namespace {

/// How many times smaller than its mass a body's effective mass at one contact point can be: 1 + m n.[x]^T I^-1 [x] n
/// at a vertex x for the normal n that turns it most. 1 for a ball.
double turning(const Body& body) {
  double most = 1;
  if (!body.mesh) return most;
  const Mesh& mesh = *body.mesh;
  for (const Eigen::Vector3d& x : mesh.vertices) {
    Eigen::Matrix3d cross;
    cross << 0, -x.z(), x.y(), x.z(), 0, -x.x(), -x.y(), x.x(), 0;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(cross.transpose() * mesh.inertia.cwiseInverse().asDiagonal() * cross, Eigen::EigenvaluesOnly);
    most = std::max(most, 1 + mesh.volume * solver.eigenvalues()[2]);
  }
  return most;
}

} // namespace

double critical_step(const Scene& scene) {
  double first = 0, second = 0; // the two largest inverse effective masses (1/kg); fixed bodies have 0
  double most = 1;
  for (const Body& b : scene.bodies) {
    if (b.fixed) continue;
    const double volume = b.mesh ? b.mesh->volume : 4. / 3. * std::numbers::pi * std::pow(b.sphere_radius, 3);
    const double t = turning(b);
    double inverse = t / (b.density * volume);
    if (inverse > first) std::swap(first, inverse);
    second = std::max(second, inverse);
    most = std::max(most, t);
  }
  if (first == 0) return std::numeric_limits<double>::infinity();
  // The dashpot belongs to the bodies' masses; against an effective mass t times smaller it damps sqrt(t) times more.
  const double w = std::sqrt(scene.contact.stiffness * (first + second));
  const double zeta = std::sqrt(most) * scene.contact.damping_ratio;
  return 2 / w * (std::sqrt(1 + zeta * zeta) - zeta);
}

} // namespace trigrain
