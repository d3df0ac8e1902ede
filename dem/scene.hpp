#pragma once
#include "dem/mesh.hpp"
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace trigrain {

/// One body as it enters a simulation. Units SI, world frame.
struct Body {
  std::shared_ptr<const Mesh> mesh;           ///< null for a sphere
  double sphere_radius = 0;                   ///< m, for spheres
  Eigen::Vector3d position{0, 0, 0};          ///< where the shape's own origin is (m)
  Eigen::Quaterniond orientation{1, 0, 0, 0}; ///< turns the shape's own frame into the world's
  Eigen::Vector3d velocity{0, 0, 0};          ///< of the centre of mass (m/s)
  Eigen::Vector3d angular_velocity{0, 0, 0};  ///< rad/s
  double density = 1000;                      ///< kg/m3
  double halo = 0;                            ///< m; two bodies touch closer than the sum of their halos
  bool fixed = false;                         ///< never moves
};

/// Contact law between all bodies, with Coulomb friction.
struct ContactParameters {
  std::string law = "spring-dashpot"; ///< a row of contact_laws()
  double stiffness = 1e3;             ///< N/m, normal spring of one contact point (spring-dashpot)
  double damping_ratio = 0.5;         ///< zeta, of critical damping
  double friction = 0.5;              ///< Coulomb coefficient mu
  double tangential_ratio = 2. / 7.;  ///< tangential over normal stiffness (spring-dashpot)
  double youngs_modulus = 1e7;        ///< Pa (hertz-mindlin)
  double poisson_ratio = .3;          ///< (hertz-mindlin)
};

struct TimeParameters {
  double step = 1e-5;            ///< s; what a contact needs, and with control "fixed" every step
  double end = 1;                ///< s
  bool force = false;            ///< run although `step` is longer than what the contacts allow
  std::string control = "fixed"; ///< how the step changes: a row of step_controls()
};

/// Cube that the grid divides (m). Bodies may leave it.
struct Domain {
  Eigen::Vector3d min{0, 0, 0};
  double size = 1;
};

struct Scene {
  std::string name;
  Eigen::Vector3d gravity{0, -9.81, 0}; ///< m/s2
  Domain domain;
  ContactParameters contact;
  TimeParameters time;
  std::vector<Body> bodies;
};

/// What a built-in scene may be asked for.
struct SceneOptions {
  int particles = 1000;
  int vertices = 20; ///< input points of a granulate; 0 makes spheres
  std::uint64_t seed = 1;
  std::string halo = "relative"; ///< "relative": 5 % of the radius; "published": 1 mm (Krestenitis 2018)
  double size_ratio = 1;         ///< largest over smallest diameter, where a scene mixes sizes
  double fill = .5;              ///< of the gas: its largest diameter over the spacing of its lattice
  double gravity = 0;            ///< of the gas, downwards (m/s2)
};

/// A scene that is there by name.
struct SceneRow {
  std::string_view name;
  std::string_view about;
  Scene (*make)(const SceneOptions&);
};

std::span<const SceneRow> scenes();

/// InputError for an unknown name (lists the known ones) and for options that make no sense.
Scene make_scene(std::string_view name, const SceneOptions& options);

/// Reads a scene file (experiments/schema/scene.json). Mesh files are looked for beside it. InputError names file and
/// key.
Scene load_scene(const std::filesystem::path& file);

} // namespace trigrain
