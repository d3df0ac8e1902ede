#pragma once
#include "dem/contact.hpp"
#include "dem/loads.hpp"
#include "dem/particles.hpp"
#include <cstdint>
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
  Budget& operator+=(const Budget& other);
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

/// What a kick adds to the budget, and what the springs of its contacts hold: sums over bodies and contacts.
struct KickSums {
  Budget budget;
  double pending = 0;             ///< of what is dissipated, the part of the second half of the kick (J)
  double held = 0, released = 0;  ///< by the tangential springs: after the kick, and given up in it (J)
  std::int64_t fast_contacts = 0; ///< that springs cannot stop
  std::int64_t fast_bodies = 0;   ///< that may fly past a contact
  KickSums& operator+=(const KickSums& other);
};
/// Adds what contacts dissipate, and the impulse of those with fixed bodies.
void add_contacts(std::span<const Contact> contacts, const Particles& particles, const MiddleMotion& motion,
                  double kick_s, KickSums& sums);

/// Add the impulse on bodies [begin, end): by gravity, and by loads from outside with their work.
void add_weight(const Particles& particles, const Eigen::Vector3d& gravity, double kick_s, int begin, int end,
                Budget& budget);
void add_outside(const Particles& particles, const Loads& outside, const MiddleMotion& motion, double kick_s, int begin,
                 int end, Budget& budget);

/// Work of loads from outside on bodies [begin, end) during a kick (J).
double work_of(const Loads& outside, const MiddleMotion& motion, double kick_s, int begin, int end);

} // namespace trigrain
