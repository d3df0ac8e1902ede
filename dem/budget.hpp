#pragma once
#include "dem/contact.hpp"
#include "dem/loads.hpp"
#include "dem/particles.hpp"
#include <span>
#include <vector>

namespace trigrain {

/// What has left and entered since the start, beside kinetic, potential and elastic energy.
struct Budget {
  double damping = 0;                       ///< dissipated by dashpots (J)
  double friction = 0;                      ///< dissipated by sliding, and with tangential springs that were lost (J)
  double outside = 0;                       ///< work of loads from outside (J)
  Eigen::Vector3d impulse{0, 0, 0};         ///< of gravity, fixed bodies and outside on the bodies that move (N s)
  Eigen::Vector3d angular_impulse{0, 0, 0}; ///< the same about the world's origin (N m s)
};

/// Linear and angular momentum about the world's origin (kg m/s, kg m2/s).
struct Momentum {
  Eigen::Vector3d linear{0, 0, 0}, angular{0, 0, 0};
};
Momentum momentum_of(const Particles& particles);

/// Velocity and angular velocity of each body half-way through the kick by its loads: there the work of a force is
/// force times velocity times the kick, exactly for the velocity and to second order for the turn.
struct MiddleMotion {
  std::vector<Eigen::Vector3d> velocity, angular_velocity;
  void resize(int bodies);
  void update(const Particles& particles, const Loads& loads, const Eigen::Vector3d& gravity, double kick_s, int begin,
              int end);
};

/// What one contact dissipates during a kick (J).
struct ContactWork {
  double damping, friction;
  double pending; ///< part of it that belongs to the second half of the kick
};
ContactWork work_of(const Contact& contact, const Particles& particles, const MiddleMotion& motion, double kick_s);

/// Add the impulse of a kick: by gravity, by the fixed body of a contact, and by loads from outside.
void add_weight_impulse(const Particles& particles, const Eigen::Vector3d& gravity, double kick_s, Budget& budget);
void add_wall_impulse(const Particles& particles, const Contact& contact, double kick_s, Budget& budget);
void add_impulse(const Particles& particles, const Loads& outside, double kick_s, Budget& budget);

/// Work of loads from outside during a kick (J).
double work_of(const Loads& outside, const MiddleMotion& motion, double kick_s);

} // namespace trigrain
