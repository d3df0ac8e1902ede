#include "dem/critical_step.hpp"
#include "dem/random.hpp"
#include "dem/scene.hpp"
#include "kernels/name_table.hpp"
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

namespace trigrain {
namespace {

using Eigen::Vector3d;

constexpr double density = 1000;            // kg/m3, Krestenitis (2018), as are the next two
constexpr double published_halo = 1e-3;     // m
constexpr double published_stiffness = 1e3; // N/m
constexpr double relative_halo = .05;       // of a grain's radius

double ball_volume(double radius) { return 4. / 3. * std::numbers::pi * radius * radius * radius; }
double volume(const Body& b) { return b.mesh ? b.mesh->volume : ball_volume(b.sphere_radius); }

/// Sites of a cubic lattice, numbered x first, then z, then y: layers are filled from below.
struct Lattice {
  int nx, ny, nz, sites; ///< the last layer may be incomplete
  double spacing;        ///< m
  Vector3d first;        ///< site 0 (m)
  Vector3d site(int i) const { return first + spacing * Vector3d(i % nx, i / (nx * nz), i / nx % nz); }
};

/// The smallest near-cubic lattice with a site for each of n grains, `edge` wide (m, half a spacing beyond the outer
/// sites), its lower face centred at `base`.
Lattice near_cube(int n, double edge, const Vector3d& base) {
  int side = std::max(1, static_cast<int>(std::cbrt(n)));
  while (static_cast<double>(side) * side * side < n) ++side;
  const double spacing = edge / side;
  const double first = -.5 * (side - 1) * spacing;
  return {side, (n + side * side - 1) / (side * side), side, n, spacing, base + Vector3d(first, spacing / 2, first)};
}

/// A ball of that diameter (m), or a granulate in it turned at random, its centre of mass at `site`.
Body grain(double diameter, int vertices, const Vector3d& site, Random& random) {
  Body body;
  body.density = density;
  body.position = site;
  if (vertices == 0) {
    body.sphere_radius = diameter / 2;
  } else {
    body.mesh = std::make_shared<const Mesh>(granulate(diameter, vertices, random.bits()));
    body.orientation = random.rotation();
    body.position -= body.orientation * body.mesh->origin;
  }
  return body;
}

/// Draws grains until one keeps within `room` (m) of its centre of mass; of ten points or more the first one
/// practically always does.
template <class Draw> Body grain_with_room(double room, const Draw& draw) {
  for (int tries = 0; tries < 100000; ++tries) {
    Body body = draw();
    if ((body.mesh ? body.mesh->radius : body.sphere_radius) <= room) return body;
  }
  throw InputError("the granulates do not fit between their neighbours (scene). Ask for more vertices.");
}

/// The body with its mesh (or radius) s times as large and its centre of mass where it was.
Body scaled(Body body, double s) {
  if (!body.mesh) {
    body.sphere_radius *= s;
    return body;
  }
  Mesh mesh = *body.mesh;
  body.position += (1 - s) * (body.orientation * mesh.origin);
  for (Vector3d& v : mesh.vertices) v *= s;
  mesh.volume *= s * s * s;
  mesh.inertia *= s * s * s * s * s;
  mesh.origin *= s;
  mesh.radius *= s;
  index_triangles(mesh);
  body.mesh = std::make_shared<const Mesh>(std::move(mesh));
  return body;
}

/// The hardest impact that a contact law is chosen for.
struct Impact {
  double effective_mass; ///< kg; for a wall the grain's own
  double speed;          ///< of approach (m/s)
  double radius;         ///< of the smaller body (m)
  double halos;          ///< sum of the two (m)
};

/// Stiffness (N/m) for which (a) the response limit V_max = halos sqrt(k / m_e), beyond which bodies pass through each
/// other, is twice the speed, and (b) the overlap stays below 1 % of the radius. The overlap of a damped linear impact,
/// (V / w_d) exp(-zeta w t) sin(w_d t), peaks at w_d t = acos(zeta): V sqrt(m_e / k) exp(-zeta acos(zeta) / sqrt(1 -
/// zeta^2)).
double stiffness_for(const Impact& impact, double zeta) {
  const double peak = std::exp(-zeta * std::acos(zeta) / std::sqrt(1 - zeta * zeta));
  const double rate = std::max(2 * impact.speed / impact.halos, peak * impact.speed / (.01 * impact.radius));
  return impact.effective_mass * rate * rate;
}

/// Longest stable step (s) of balls whose eight contacts each all stick while their neighbours turn the other way: the
/// springs and dashpots along the surfaces act at r + halo from the centre, and of a turn about any axis two thirds
/// lie along them. For halos as wide as the balls this is shorter than what a single contact allows.
double sticking_step(const Scene& scene) {
  const ContactParameters& law = scene.contact;
  double step = std::numeric_limits<double>::infinity();
  if (law.friction == 0) return step;
  for (const Body& b : scene.bodies) {
    if (b.fixed || b.mesh) continue;
    constexpr double contacts = 8, both_turn = 2, along = 2. / 3;
    const double m = b.density * volume(b), lever = b.sphere_radius + b.halo, r = b.sphere_radius;
    const double per_inertia = contacts * both_turn * along * lever * lever / (.4 * m * r * r);
    const double k = per_inertia * law.tangential_ratio * law.stiffness;
    const double c = per_inertia * 2 * law.damping_ratio * std::sqrt(law.tangential_ratio * law.stiffness * m / 2);
    step = std::min(step, stable_step(k, c));
  }
  return step;
}

/// Step (s) of T_c / 15 = pi / (15 w), w = sqrt(k / m_e), for the two lightest free bodies, at most half the critical
/// step of any one contact point, and at most what packed balls allow.
double step_for(const Scene& scene) {
  double lightest = std::numeric_limits<double>::max(); // kg
  for (const Body& b : scene.bodies)
    if (!b.fixed) lightest = std::min(lightest, b.density * volume(b));
  return std::min({std::numbers::pi / 15 * std::sqrt(lightest / 2 / scene.contact.stiffness), critical_step(scene) / 2,
                   sticking_step(scene)});
}

double halo_for(const SceneOptions& options, double radius) {
  return options.halo == "published" ? published_halo : relative_halo * radius;
}

/// Stiffness for the hardest impact, or as published, and the step that goes with it.
void set_contact(Scene& scene, const SceneOptions& options, const Impact& hardest) {
  const bool published = options.halo == "published";
  scene.contact.stiffness = published ? published_stiffness : stiffness_for(hardest, scene.contact.damping_ratio);
  scene.time.step = step_for(scene);
}

Body wall(Mesh mesh, const Vector3d& position) {
  Body body;
  body.mesh = std::make_shared<const Mesh>(std::move(mesh));
  body.position = position;
  body.fixed = true;
  return body;
}

constexpr double hopper_width = .2, hopper_height = .1333, hopper_opening = .05, hopper_thickness = .005; // m
constexpr double fall_speed = 1.3; // m/s, from the hopper to the floor
const Vector3d hopper_centre(.5, .5, .5);

/// Above the hopper, as wide as it is inside the walls' thickness: 19 mm for 10 x 10 x 10, as published.
Lattice hopper_lattice(int particles) {
  constexpr double edge = hopper_width - 2 * hopper_thickness;
  const Vector3d top = hopper_centre + Vector3d(0, hopper_height / 2, 0);
  if (particles == 10000 || particles == 10800) // published as 10 000
    return {30, 12, 30, 10800, edge / 30, top + edge / 30 * Vector3d(-14.5, .5, -14.5)};
  return near_cube(particles, edge, top);
}

/// Slab of .32 x .05 x .32 m about the origin with a rim: without one, grains that splash off the heap leave the floor
/// (49 of 1000). The rim's plates reach into the slab and past each other, so that each stays a piece of its own.
Mesh floor_with_rim() {
  constexpr double side = .32, slab = .05, rim_height = .04, rim = .005, sunk = .005; // m
  Mesh all = box({side, slab, side});
  std::vector<Vector3d> vertices = all.vertices;
  std::vector<std::array<int, 3>> faces = all.faces;
  const auto add = [&](const Vector3d& size, const Vector3d& at) {
    const Mesh plate = box(size);
    const int first = static_cast<int>(vertices.size());
    for (const Vector3d& v : plate.vertices) vertices.push_back(v + at);
    for (const auto& f : plate.faces) faces.push_back({f[0] + first, f[1] + first, f[2] + first});
  };
  const double y = slab / 2 + (rim_height - sunk) / 2, out = (side - rim) / 2;
  for (const double sign : {1., -1.}) {
    add({side, rim_height + sunk, rim}, {0, y, sign * out});
    add({rim, rim_height + sunk, side - 1.6 * rim}, {sign * out, y, 0});
  }
  return make_mesh("floor", std::move(vertices), std::move(faces));
}

/// Hopper, floor and grains in the unit cube, one halo (m) for all; `radius` is that of the grains (m).
Scene hopper_scene(const SceneOptions& options, double radius, std::vector<Body> grains) {
  Scene scene;
  scene.bodies.push_back(wall(hopper(hopper_width, hopper_height, hopper_opening, hopper_thickness), hopper_centre));
  scene.bodies.push_back(wall(floor_with_rim(), {.5, .35, .5}));
  std::move(grains.begin(), grains.end(), std::back_inserter(scene.bodies));
  double heaviest = 0;
  for (Body& b : scene.bodies) {
    b.halo = halo_for(options, radius);
    if (!b.fixed) heaviest = std::max(heaviest, density * volume(b));
  }
  scene.time.end = 1;
  set_contact(scene, options, {heaviest, fall_speed, radius, 2 * scene.bodies[0].halo});
  return scene;
}

Scene make_hopper(const SceneOptions& options) {
  constexpr double total_mass = .05; // kg
  const Lattice lattice = hopper_lattice(options.particles);
  const double radius = std::cbrt(3 * total_mass / lattice.sites / (4 * std::numbers::pi * density));
  Random random(options.seed);
  std::vector<Body> grains;
  for (int i = 0; i < lattice.sites; ++i)
    grains.push_back(grain_with_room(lattice.spacing / 2, [&] {
      const Body body = grain(2 * radius, options.vertices, lattice.site(i), random);
      return scaled(body, std::cbrt(ball_volume(radius) / volume(body)));
    }));
  return hopper_scene(options, radius, std::move(grains));
}

Scene make_hopper_dense(const SceneOptions& options) {
  const Lattice lattice = hopper_lattice(options.particles);
  const double diameter = .8 * lattice.spacing;
  Random random(options.seed);
  std::vector<Body> grains;
  for (int i = 0; i < lattice.sites; ++i)
    grains.push_back(grain_with_room(lattice.spacing / 2,
                                     [&] { return grain(diameter, options.vertices, lattice.site(i), random); }));
  return hopper_scene(options, diameter / 2, std::move(grains));
}

Scene make_two_particles(const SceneOptions& options) {
  Scene scene;
  scene.gravity.setZero();
  scene.time.end = 4;
  Random random(options.seed);
  for (const double sign : {1., -1.}) {
    const double diameter = sign > 0 ? .02 : .2;
    Body body = grain(diameter, options.vertices, Vector3d::Constant(.5 - sign * .3), random);
    body.velocity = Vector3d::Constant(sign * .1);
    body.halo = halo_for(options, diameter / 2);
    scene.bodies.push_back(body);
  }
  const Body &small = scene.bodies[0], &large = scene.bodies[1];
  const double effective_mass = density / (1 / volume(small) + 1 / volume(large));
  set_contact(scene, options, {effective_mass, (small.velocity - large.velocity).norm(), .01, small.halo + large.halo});
  return scene;
}

/// Without damping and friction: energy is conserved and the gas never comes to rest.
Scene make_gas(const SceneOptions& options) {
  constexpr double thickness = .01, inside = 1 - 2 * thickness, speed = .1; // m, m, m/s per component
  Scene scene;
  scene.gravity = {0, -options.gravity, 0};
  scene.contact.damping_ratio = scene.contact.friction = 0;
  scene.time.end = 10;
  const Lattice lattice = near_cube(options.particles, inside, {.5, thickness, .5});
  const double largest = options.fill * lattice.spacing;
  for (int axis = 0; axis < 3; ++axis)
    for (const double at : {thickness / 2, 1 - thickness / 2}) {
      Vector3d size(1, 1, 1), position(.5, .5, .5);
      size[axis] = thickness, position[axis] = at;
      Body& side = scene.bodies.emplace_back(wall(box(size), position));
      side.halo = halo_for(options, largest / 2);
    }
  Random random(options.seed);
  double heaviest = 0;
  for (int i = 0; i < lattice.sites; ++i) {
    // Uniform in the reciprocal: few large bodies among many small ones.
    const double diameter = largest / (1 + (options.size_ratio - 1) * random.uniform());
    Body& body = scene.bodies.emplace_back(grain_with_room(
        lattice.spacing / 2, [&] { return grain(diameter, options.vertices, lattice.site(i), random); }));
    for (double& v : body.velocity) v = speed * (2 * random.uniform() - 1);
    body.halo = halo_for(options, diameter / 2);
    heaviest = std::max(heaviest, density * volume(body));
  }
  // Two of the largest meet at up to 2 sqrt(3) x speed, and faster where both have fallen from top to bottom.
  const double fastest = std::sqrt(3 * speed * speed + 2 * options.gravity * inside);
  set_contact(scene, options, {heaviest / 2, 2 * fastest, largest / 2, 2 * scene.bodies[0].halo});
  return scene;
}

constexpr std::array<SceneRow, 4> table{{
    {"hopper", "grains of .05 kg in all fall through a hopper onto a floor; sparse, as published", make_hopper},
    {"hopper-dense", "the same with grains of .8 lattice spacings, which crowd and arch", make_hopper_dense},
    {"two-particles", "a small and a ten times larger body meet at 2.7 s; always two, without gravity",
     make_two_particles},
    {"gas", "bodies of one size or of 1:size_ratio with random velocities in a reflecting cube", make_gas},
}};

} // namespace

std::span<const SceneRow> scenes() { return table; }

Scene make_scene(std::string_view name, const SceneOptions& options) {
  const auto refuse = [&](const std::string& problem, const std::string& what_to_do) {
    throw InputError(problem + " (scene " + std::string(name) + "). " + what_to_do);
  };
  const SceneRow& row = row_named(table, "scene", name);
  if (options.particles < 1 || options.particles > 10'000'000)
    refuse("particles is " + std::to_string(options.particles), "Give 1 to 10000000.");
  if (options.vertices != 0 && (options.vertices < 4 || options.vertices > 10000))
    refuse("vertices is " + std::to_string(options.vertices), "Give 4 to 10000, or 0 for spheres.");
  if (options.halo != "relative" && options.halo != "published")
    refuse("unknown halo '" + options.halo + "'", "Known: relative, published.");
  if (!(options.size_ratio >= 1 && options.size_ratio <= 1000))
    refuse("size_ratio is " + std::to_string(options.size_ratio), "Give 1 to 1000.");
  if (options.size_ratio != 1 && row.make != make_gas)
    refuse("size_ratio is " + std::to_string(options.size_ratio), "Only gas mixes sizes; leave it at 1.");
  if (!(options.fill > 0 && options.fill <= .9))
    refuse("fill is " + std::to_string(options.fill), "Give a number above 0 and up to .9.");
  if (!(options.gravity >= 0 && options.gravity <= 1000))
    refuse("gravity is " + std::to_string(options.gravity), "Give 0 to 1000 m/s2.");
  const SceneOptions defaults;
  if ((options.fill != defaults.fill || options.gravity != defaults.gravity) && row.make != make_gas)
    refuse("fill or gravity is given", "Only gas takes them.");
  Scene scene = row.make(options);
  scene.name = name;
  return scene;
}

} // namespace trigrain
