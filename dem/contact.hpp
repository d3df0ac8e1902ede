#pragma once
#include "kernels/column.hpp"
#include <Eigen/Core>

namespace trigrain {

/// One point where two bodies touch, as a contact rule finds it; world frame, SI.
struct Touch {
  int a, b;                        ///< bodies, a < b
  int feature_a, feature_b;        ///< what touches: triangle or piece of surface, as the contact rule says
  Eigen::Vector3d point{0, 0, 0};  ///< between the closest points P on A and Q on B, Particles::contact_place (m)
  Eigen::Vector3d normal{0, 0, 0}; ///< unit, from Q to P: towards A
  double overlap = 0;              ///< sum of halos - |PQ| (m), > 0
  double share = 1;                ///< of a spring's energy: the spring holds k share overlap^2 / 2
  double mass = 0;                 ///< effective mass of all contacts of the pair together (kg), for the dashpot
  Eigen::Vector3d push{0, 0, 0};   ///< force of the spring on A over its stiffness (m): overlap * normal, but for
                                   ///< crossing edges
  Eigen::Vector3d couple{0, 0, 0}; ///< torque of the spring on A about `point` over its stiffness (m2)
};

/// The same with its forces.
struct Contact : Touch {
  double stiffness = 0;           ///< of the normal spring: its force is this times `push` (N/m)
  double spring_energy = 0;       ///< of the normal spring (J)
  double held = 0;                ///< by the tangential spring (J)
  double released = 0;            ///< what the tangential spring gave up in this step (J)
  bool slides = false;            ///< friction is at its limit
  bool fast = false;              ///< so fast that undamped springs cannot stop it before the surfaces cross
  Eigen::Vector3d force{0, 0, 0}; ///< on A (N); B gets the opposite

  /// The normal spring's share of `force` (N).
  Eigen::Vector3d elastic() const { return stiffness * push; }
  /// On A beside that of the force (N m); B gets the opposite.
  Eigen::Vector3d torque() const { return stiffness * couple; }
};

/// Sum of the contacts of a body pair, in one line of the cache: bodies gather these from all over memory.
struct alignas(cache_line) Reaction {
  int a, b;
  Eigen::Vector3d force{0, 0, 0};  ///< on A (N); B gets the opposite
  Eigen::Vector3d torque{0, 0, 0}; ///< on A, about its centre of mass (N m)
};

/// The tangential spring of a contact, which the same contact of the next step takes over.
struct HeldSpring {
  int feature_a, feature_b;
  Eigen::Vector3d stretch{0, 0, 0}; ///< m
  double stiffness = 0;             ///< in the step before (N/m)
};

} // namespace trigrain
