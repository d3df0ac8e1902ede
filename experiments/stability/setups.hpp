#pragma once
#include "dem/narrow_phase.hpp"
#include "dem/simulation.hpp"
#include "experiments/stability/study.hpp"
#include <memory>
#include <string>

namespace trigrain {

inline constexpr double g = 9.81; ///< m/s2

/// Options of a simulation as the request asks for.
inline Options with(const StudyRequest& request) { return {.contact_rule = request.contact_rule}; }

/// A scene without bodies and weight about the origin.
Scene empty_scene(double domain_size, const ContactParameters& contact, double step);

/// A fixed cuboid whose top is the plane y = 0, its faces cut into cut x cut oblongs.
Body floor_body(double width, double halo, int cut = 1);

Body mesh_body(Mesh mesh, double mass, const Eigen::Vector3d& position, double halo);
Body sphere_body(double radius, double mass, const Eigen::Vector3d& position, double halo);

/// Height of the body's lowest point over its position (m), negative.
double lowest_point(const Body& body);

/// Restitution of the clipped spring-dashpot of damping ratio zeta (Schwager & Poeschel 2007).
double restitution(double zeta);

/// Duration (s) of an undamped impact of a ball of that mass (kg) and radius (m) on a rigid plane at this speed (m/s).
double elastic_contact_time(const ContactParameters& contact, double mass, double radius, double speed);

/// Force and torque about its centre on body 1 of two bodies at rest, and what the springs hold.
class Probe {
 public:
  Probe(const Scene& scene, const std::string& contact_rule);
  void place(const Eigen::Vector3d& position, const Eigen::Quaterniond& orientation); ///< body 1
  void evaluate();

  Eigen::Vector3d force, torque; ///< N, N m
  double energy = 0;             ///< J
  std::vector<Contact> contacts;

 private:
  ContactParameters law_;
  Particles particles_;
  NarrowPhase narrow_;
  WorkerBuffer buffer_;
};

} // namespace trigrain
