#include "dem/critical_step.hpp"
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace trigrain {
namespace {

using Eigen::Vector3d;
using Twist = Eigen::Matrix<double, 6, 1>; // velocity and angular velocity, or force and torque

/// m M^-1 K / k of a body whose points x (body frame) are pressed in direction n: its largest eigenvalue is how many
/// times smaller than its mass the effective mass of these contacts is.
double turning(const Mesh& mesh, std::span<const Vector3d> points, const Vector3d& n) {
  Eigen::Matrix<double, 6, 6> sum = Eigen::Matrix<double, 6, 6>::Zero();
  const Vector3d root = (mesh.volume * mesh.inertia.cwiseInverse()).cwiseSqrt();
  for (const Vector3d& x : points) {
    Twist row;
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

/// Springs and dashpots of one contact as the bodies feel them.
struct Coupling {
  int a, b;
  Vector3d arm_a, arm_b, normal;
  double k, kt, c, ct;

  Vector3d relative(const std::vector<Twist>& twist) const {
    const Twist &u = twist[a], &v = twist[b];
    return u.head<3>() + u.tail<3>().cross(arm_a) - v.head<3>() - v.tail<3>().cross(arm_b);
  }
};

std::vector<Coupling> couplings(const Particles& p, const ContactParameters& law, std::span<const Contact> contacts) {
  std::vector<Coupling> all;
  for (const Contact& c : contacts) {
    const double k = law.stiffness * c.share,
                 damping = 2 * law.damping_ratio * c.share * std::sqrt(law.stiffness * c.mass);
    const double ratio = law.friction > 0 ? law.tangential_ratio : 0;
    all.push_back({c.a, c.b, c.point - p.position[c.a], c.point - p.position[c.b], c.normal, k, ratio * k, damping,
                   std::sqrt(ratio) * damping});
  }
  return all;
}

Vector3d angular_response(const Particles& p, int i, const Vector3d& torque) {
  const Eigen::Quaterniond& q = p.orientation[i];
  return q * (q.conjugate() * torque).cwiseQuotient(p.inertia[i]);
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
    most = std::max(most, t);
    if (inverse > first) std::swap(first, inverse);
    second = std::max(second, inverse);
  }
  if (first == 0) return std::numeric_limits<double>::infinity();
  // The published rules' dashpots belong to the bodies' masses; on an effective mass t times smaller they damp sqrt(t)
  // times more.
  const double w = std::sqrt(scene.contact.stiffness * (first + second));
  const double zeta = std::sqrt(most) * scene.contact.damping_ratio;
  return 2 / w * (std::sqrt(1 + zeta * zeta) - zeta);
}

double contact_step_limit(const Particles& p, const ContactParameters& law, std::span<const Contact> contacts) {
  constexpr int most_rounds = 200;
  const std::vector<Coupling> all = couplings(p, law, contacts);
  std::vector<Twist> twist(p.size(), Twist::Zero()), load(p.size(), Twist::Zero());
  for (int i = 0; i < p.size(); ++i) // any start that no symmetry of a scene makes blind for a mode
    if (!p.fixed(i))
      for (int d = 0; d < 6; ++d) twist[i][d] = (1 + .1 * std::sin(7. * i + 3. * d)) / (d < 3 ? 1 : p.radius[i]);
  double step = std::numeric_limits<double>::infinity();
  for (int round = 0; round < most_rounds; ++round) {
    double k = 0, c = 0, m = 0; // of this mode: v.K v, v.C v, v.M v
    const double h = std::isfinite(step) ? step : 0;
    for (const Coupling& each : all) {
      const Vector3d v = each.relative(twist), n = v.dot(each.normal) * each.normal, t = v - n;
      k += each.k * n.squaredNorm() + each.kt * t.squaredNorm();
      c += each.c * n.squaredNorm() + each.ct * t.squaredNorm();
      const double wn = h > 0 ? h * each.k + 2 * each.c : each.k, wt = h > 0 ? h * each.kt + 2 * each.ct : each.kt;
      const Vector3d f = wn * n + wt * t;
      load[each.a] += (Twist() << f, each.arm_a.cross(f)).finished();
      load[each.b] -= (Twist() << f, each.arm_b.cross(f)).finished();
    }
    double size = 0;
    for (int i = 0; i < p.size(); ++i) {
      if (p.fixed(i)) continue;
      const Eigen::Quaterniond back = p.orientation[i].conjugate();
      const Vector3d spin = back * twist[i].tail<3>();
      m += p.mass[i] * twist[i].head<3>().squaredNorm() + spin.cwiseProduct(p.inertia[i]).dot(spin);
      twist[i] << p.inverse_mass[i] * load[i].head<3>(), angular_response(p, i, load[i].tail<3>());
      size = std::max(size, twist[i].head<3>().norm() + p.radius[i] * twist[i].tail<3>().norm());
    }
    for (int i = 0; i < p.size(); ++i) {
      twist[i] = p.fixed(i) ? Twist::Zero().eval() : (twist[i] / size).eval();
      load[i].setZero();
    }
    if (!(k > 0)) break;
    k /= m, c /= m;
    const double last = step;
    step = 4 / (c + std::sqrt(c * c + 4 * k)); // h^2 k + 2 h c = 4
    if (round > 10 && std::abs(step - last) < 1e-5 * step) break;
  }
  return step;
}

} // namespace trigrain
