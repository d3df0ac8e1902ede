#pragma once
#include "dem/scene.hpp"
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace trigrain {

/// State of all bodies as structure of arrays; the index is the body's identity. Units SI, world frame unless said.
/// Orientation turns the body frame (Mesh: centre of mass, principal axes) into the world's.
struct Particles {
  std::vector<Eigen::Vector3d> position;         ///< centre of mass (m)
  std::vector<Eigen::Vector3d> velocity;         ///< m/s
  std::vector<Eigen::Quaterniond> orientation;   ///< unit quaternion
  std::vector<Eigen::Vector3d> angular_momentum; ///< about the centre of mass (kg m2/s)
  std::vector<Eigen::Vector3d> inertia;          ///< principal moments (kg m2); 0 if fixed
  std::vector<double> mass;                      ///< kg; 0 if fixed
  std::vector<double> inverse_mass;              ///< 1/kg; 0 if fixed
  std::vector<double> halo;                      ///< m
  std::vector<double> radius;                    ///< of the bounding sphere about `position`, without halo (m)
  std::vector<std::shared_ptr<const Mesh>> mesh; ///< null for a sphere of that radius

  int size() const { return static_cast<int>(position.size()); }
  bool fixed(int i) const { return inverse_mass[i] == 0; }
  /// Where between the closest points P on a and Q on b their contact acts: 0 at P, 1 at Q. Nearer to the surface of
  /// the lighter body, and on that of a body that meets a fixed one: there halos lengthen no lever.
  double contact_place(int a, int b) const {
    return fixed(b) ? 0 : inverse_mass[b] / (inverse_mass[a] + inverse_mass[b]);
  }
  /// x (m, world) in the frame of body i.
  Eigen::Vector3d to_body(int i, const Eigen::Vector3d& x) const {
    return orientation[i].conjugate() * (x - position[i]);
  }
  /// The smaller one of two bodies: it has few others around it.
  int smaller(int a, int b) const { return radius[b] <= radius[a] ? b : a; }
  bool is_sphere(int i) const { return mesh[i] == nullptr; }
  /// World frame (rad/s); 0 for fixed bodies.
  Eigen::Vector3d angular_velocity(int i) const { return angular_velocity(i, angular_momentum[i]); }
  /// The same, had it that angular momentum (kg m2/s).
  Eigen::Vector3d angular_velocity(int i, const Eigen::Vector3d& momentum) const;
  void reserve(int bodies);
  /// Adds a body. InputError for an open mesh that is not fixed and for values that are not finite or not positive.
  void add(const Body& body);
  /// The body with its present position and motion, as a scene would hold it.
  Body body(int i) const;
  /// Of the bits of all places, orientations and motions.
  std::uint64_t hash() const;
};

} // namespace trigrain
