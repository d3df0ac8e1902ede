#pragma once
#include "dem/contact_list.hpp"
#include "dem/particles.hpp"
#include "dem/runtime.hpp"
#include <vector>

namespace trigrain {

/// Largest step (s) at which symplectic Euler is stable with these contacts: h^2 K + 2 h C has no eigenvalue above 4 M,
/// C with dashpots as this step takes them. Springs and dashpots of all contacts together, normal and tangential; by
/// power iteration, from above: to a part in a thousand after 200 rounds, to some per cent after 30. Infinite without
/// contacts. The same bits for every team. Its memory is as large as that of the contacts, so it is not kept: few steps
/// ask.
class ContactStepLimit {
 public:
  double of(const Particles& particles, const ContactParameters& law, ContactList& contacts, Team& team,
            int most_rounds = 200);

 private:
  using Vector3d = Eigen::Vector3d;
  /// Velocity and angular velocity of a body.
  struct Twist {
    Vector3d linear{0, 0, 0}, angular{0, 0, 0};
  };
  /// Springs and dashpots of one contact as the bodies feel them.
  struct Coupling {
    int a, b;
    Vector3d arm_a, arm_b, normal;
    double k, kt, c, ct;
    double rate; // by which, times the step, a dashpot is taken smaller (1/s)
  };
  /// v.K v, v.C v, v.M v of a mode v, and its largest speed.
  struct Mode {
    double k = 0, c = 0, m = 0, size = 0;
    Mode& operator+=(const Mode& other);
  };

  void couple(const Particles& particles, const ContactParameters& law, std::span<const Contact> contacts, Team& team);
  Mode stretch(double step_s, Team& team);
  Mode respond(const Particles& particles, const ContactList& contacts, Team& team);

  std::vector<Coupling> couplings_;
  std::vector<Vector3d> force_; // of each coupling on its body a
  std::vector<Twist> twist_;
  double scale_ = 1; // of all twists
  std::vector<Mode> modes_;
};

} // namespace trigrain
