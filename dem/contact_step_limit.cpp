#include "dem/contact_step_limit.hpp"
#include "dem/block_sum.hpp"
#include "dem/contact_law.hpp"
#include "dem/critical_step.hpp"
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace trigrain {
namespace {

constexpr int grain = 64; // contacts or bodies a worker takes at a time

} // namespace

ContactStepLimit::Mode& ContactStepLimit::Mode::operator+=(const Mode& o) {
  k += o.k;
  c += o.c;
  m += o.m;
  size = std::max(size, o.size);
  return *this;
}

void ContactStepLimit::couple(const Particles& p, const ContactParameters& law, std::span<const Contact> contacts,
                              Team& team) {
  const ContactLaw& row = law_of(law);
  couplings_.resize(contacts.size());
  team.parallel_for(static_cast<int>(contacts.size()), grain, [&](int begin, int end, int) {
    for_packs(contacts.subspan(begin, end - begin), [&](std::size_t first, const ContactPack& pack) {
      const Spring s = row.spring(law, p, pack, pack.overlap());
      const Lanes kt = law.friction > 0 ? s.tangential : Lanes(0), k = pack.share() * s.tangent,
                  shared_kt = pack.share() * kt, ct = sqrt(kt / s.tangent) * s.damping, rate = lag(s, pack, 1);
      for (int i = 0; i < pack.size(); ++i) {
        const Contact& c = pack.contacts[i];
        couplings_[begin + first + i] = {c.a,
                                         c.b,
                                         c.point - p.position[c.a],
                                         c.point - p.position[c.b],
                                         c.normal,
                                         k[i],
                                         shared_kt[i],
                                         s.damping[i],
                                         ct[i],
                                         rate[i]};
      }
    });
  });
}

/// What the twists do to the springs and dashpots: their forces, weighted for a step (s) that is 0 if not known.
ContactStepLimit::Mode ContactStepLimit::stretch(double h, Team& team) {
  force_.resize(couplings_.size());
  return block_sum(team, static_cast<int>(couplings_.size()), modes_, [&](int begin, int end, Mode& sum) {
    for (int i = begin; i < end; ++i) {
      const Coupling& each = couplings_[i];
      const Twist &u = twist_[each.a], &w = twist_[each.b];
      const Vector3d v = scale_ * (u.linear + u.angular.cross(each.arm_a) - w.linear - w.angular.cross(each.arm_b));
      const Vector3d n = v.dot(each.normal) * each.normal, t = v - n;
      const double less = 1 / std::sqrt(1 + h * each.rate), cn = less * each.c, ct = less * each.ct;
      sum.k += each.k * n.squaredNorm() + each.kt * t.squaredNorm();
      sum.c += cn * n.squaredNorm() + ct * t.squaredNorm();
      const double wn = h > 0 ? h * each.k + 2 * cn : each.k, wt = h > 0 ? h * each.kt + 2 * ct : each.kt;
      force_[i] = wn * n + wt * t;
    }
  });
}

/// What these forces do to the bodies: the next twists.
ContactStepLimit::Mode ContactStepLimit::respond(const Particles& p, const ContactList& contacts, Team& team) {
  const Contact* const first = contacts.contacts().data();
  return block_sum(team, p.size(), modes_, [&](int begin, int end, Mode& sum) {
    for (int i = begin; i < end; ++i) {
      if (p.fixed(i)) continue;
      Vector3d force(0, 0, 0), torque(0, 0, 0);
      contacts.for_body(i, [&](const Contact& c) {
        const std::ptrdiff_t at = &c - first;
        const bool is_a = couplings_[at].a == i;
        const Vector3d f = is_a ? force_[at] : (-force_[at]).eval();
        force += f;
        torque += (is_a ? couplings_[at].arm_a : couplings_[at].arm_b).cross(f);
      });
      Twist& twist = twist_[i];
      const Eigen::Quaterniond& q = p.orientation[i];
      const Vector3d spin = q.conjugate() * (scale_ * twist.angular);
      sum.m += p.mass[i] * (scale_ * twist.linear).squaredNorm() + spin.cwiseProduct(p.inertia[i]).dot(spin);
      twist = {p.inverse_mass[i] * force, q * (q.conjugate() * torque).cwiseQuotient(p.inertia[i])};
      sum.size = std::max(sum.size, twist.linear.norm() + p.radius[i] * twist.angular.norm());
    }
  });
}

double ContactStepLimit::of(const Particles& p, const ContactParameters& law, ContactList& contacts, Team& team,
                            int most_rounds) {
  contacts.list_others(p, team);
  couple(p, law, contacts.contacts(), team);
  twist_.resize(p.size());
  team.parallel_for(p.size(), grain, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) { // any start that no symmetry of a scene makes blind for a mode
      const auto start = [i](int d) { return 1 + .1 * std::sin(7. * i + 3. * d); };
      twist_[i] = p.fixed(i)
                      ? Twist{}
                      : Twist{{start(0), start(1), start(2)}, Vector3d(start(3), start(4), start(5)) / p.radius[i]};
    }
  });
  scale_ = 1;
  double step = std::numeric_limits<double>::infinity();
  for (int round = 0; round < most_rounds; ++round) {
    Mode mode = stretch(std::isfinite(step) ? step : 0, team);
    mode += respond(p, contacts, team);
    if (!(mode.k > 0)) break;
    scale_ = 1 / mode.size;
    const double last = step;
    step = stable_step(mode.k / mode.m, mode.c / mode.m);
    if (round > 10 && std::abs(step - last) < 1e-6 * step) break;
  }
  return step;
}

} // namespace trigrain
