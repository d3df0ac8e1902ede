#include "dem/critical_step.hpp"
#include "dem/hertz.hpp"
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace trigrain {
namespace {

using Eigen::Vector3d;

/// m M^-1 K / k of a body whose points x (body frame) are pressed in direction n: its largest eigenvalue is how many
/// times smaller than its mass the effective mass of these contacts is.
double turning(const Mesh& mesh, std::span<const Vector3d> points, const Vector3d& n) {
  Eigen::Matrix<double, 6, 6> sum = Eigen::Matrix<double, 6, 6>::Zero();
  const Vector3d root = (mesh.volume * mesh.inertia.cwiseInverse()).cwiseSqrt();
  for (const Vector3d& x : points) {
    Eigen::Matrix<double, 6, 1> row;
    row << n, root.cwiseProduct(x.cross(n));
    sum += row * row.transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(sum, Eigen::EigenvaluesOnly).eigenvalues()[5];
}

/// The same for the one vertex x and the normal that turns the body most: 1 + m n.[x]^T I^-1 [x] n.
double turning(const Mesh& mesh, const Vector3d& x) {
  Eigen::Matrix3d cross;
  cross << 0, -x.z(), x.y(), x.z(), 0, -x.x(), -x.y(), x.x(), 0;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(cross.transpose() * mesh.inertia.cwiseInverse().asDiagonal() * cross, Eigen::EigenvaluesOnly);
  return 1 + mesh.volume * solver.eigenvalues()[2];
}

/// The largest of both over the vertices and the flat faces of a body. 1 for a ball.
double turning(const Body& body) {
  if (!body.mesh) return 1;
  const Mesh& mesh = *body.mesh;
  double most = 1;
  for (const Vector3d& x : mesh.vertices) most = std::max(most, turning(mesh, x));
  std::vector<Vector3d> points;
  for (const std::vector<int>& flat : mesh.features.flats) {
    points.clear();
    for (const int v : flat) points.push_back(mesh.vertices[v]);
    Vector3d normal = Vector3d::Zero(); // corners of a flat face have no order: the largest cross product will do
    for (const Vector3d& x : points) {
      const Vector3d n = (points[1] - points[0]).cross(x - points[0]);
      if (n.squaredNorm() > normal.squaredNorm()) normal = n;
    }
    most = std::max(most, turning(mesh, points, normal.normalized()));
  }
  return most;
}

} // namespace

double stable_step(double k, double c) { return 4 / (c + std::sqrt(c * c + 4 * k)); }

double critical_step(const Scene& scene) {
  double first = 0, second = 0; // the two largest inverse effective masses (1/kg); fixed bodies have 0
  double most = 1;
  for (const Body& b : scene.bodies) {
    if (b.fixed) continue;
    const double volume = b.mesh ? b.mesh->volume : 4. / 3. * std::numbers::pi * std::pow(b.sphere_radius, 3);
    const double t = turning(b);
    double inverse = t / (b.density * volume);
    most = std::max(most, t);
    if (inverse > first) std::swap(first, inverse);
    second = std::max(second, inverse);
  }
  if (first == 0) return std::numeric_limits<double>::infinity();
  // The published rules' dashpots belong to the bodies' masses; on an effective mass t times smaller they damp sqrt(t)
  // times more.
  const double w = std::sqrt(largest_stiffness(scene) * (first + second));
  const double zeta = std::sqrt(most) * scene.contact.damping_ratio;
  return 2 / w * (std::sqrt(1 + zeta * zeta) - zeta);
}

} // namespace trigrain
