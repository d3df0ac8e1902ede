#include "dem/contact_step_limit.hpp"
#include "dem/contact_law.hpp"
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace trigrain {
namespace {

using Eigen::Vector3d;
using Twist = Eigen::Matrix<double, 6, 1>; // velocity and angular velocity, or force and torque

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

void couplings(const Particles& p, const ContactParameters& law, std::span<const Contact> contacts,
               std::vector<Coupling>& all) {
  all.clear();
  const ContactLaw& row = law_of(law);
  for (const Contact& c : contacts) {
    const Spring s = row.spring(law, p, c, c.overlap);
    const double kt = law.friction > 0 ? s.tangential : 0;
    all.push_back({c.a, c.b, c.point - p.position[c.a], c.point - p.position[c.b], c.normal, c.share * s.tangent,
                   c.share * kt, s.damping, std::sqrt(kt / s.tangent) * s.damping});
  }
}

Vector3d angular_response(const Particles& p, int i, const Vector3d& torque) {
  const Eigen::Quaterniond& q = p.orientation[i];
  return q * (q.conjugate() * torque).cwiseQuotient(p.inertia[i]);
}

} // namespace

double contact_step_limit(const Particles& p, const ContactParameters& law, std::span<const Contact> contacts) {
  constexpr int most_rounds = 200;
  static thread_local std::vector<Coupling> all; // scratch memory that has grown stays
  static thread_local std::vector<Twist> twist, load;
  couplings(p, law, contacts, all);
  twist.assign(p.size(), Twist::Zero());
  load.assign(p.size(), Twist::Zero());
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
    if (round > 10 && std::abs(step - last) < 1e-6 * step) break;
  }
  return step;
}

} // namespace trigrain
