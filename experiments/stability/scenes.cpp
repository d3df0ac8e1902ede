#include "experiments/stability/scenes.hpp"
#include "dem/motion.hpp"
#include "dem/random.hpp"
#include "experiments/stability/setups.hpp"
#include <algorithm>
#include <cmath>
#include <numbers>

namespace trigrain {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr double edge = .1, mass = 1, halo = 1e-3, reach = 2 * halo;

Body cube(double cube_mass, double height) {
  return mesh_body(box({edge, edge, edge}), cube_mass, {0, height, 0}, halo);
}

} // namespace

std::vector<Metric> cut_floor(const StudyRequest& request) {
  const double k = 1e6;
  Scene scene = empty_scene(8, {.stiffness = k, .damping_ratio = .3, .friction = .2}, 2e-5);
  scene.gravity = {0, -g, 0};
  scene.bodies = {floor_body(2, halo, static_cast<int>(request.value)),
                  cube(mass, edge / 2 + reach - mass * g / (4 * k))};
  scene.bodies[1].orientation = Eigen::AngleAxisd(.3, Vector3d::UnitY());
  scene.bodies[1].velocity = {.4, 0, .17};
  Simulation sim(scene, with(request));
  sim.run(500);
  double ripple = 0, tilt = 0;
  for (int i = 0; i < 4000; ++i) {
    sim.step();
    Vector3d force = Vector3d::Zero();
    for (const Contact& c : sim.contacts()) {
      force -= c.force;
      tilt = std::max(tilt, std::acos(std::clamp(std::abs(c.normal.y()), 0., 1.)) * 180 / pi);
    }
    ripple = std::max(ripple, std::abs(force.y() / (mass * g) - 1));
  }
  return {{"ripple_of_weight", ripple, 1e-6}, {"tilt_of_normal_deg", tilt, 5}};
}

std::vector<Metric> mass_ratio(const StudyRequest& request) {
  const double upper = request.value * mass, k = 1e6 * std::max(1., request.value), zeta = .5;
  const double lightest = std::min(mass, upper), heaviest = std::max(mass, upper);
  Scene scene = empty_scene(4, {.stiffness = k, .damping_ratio = zeta, .friction = .5}, .1 * std::sqrt(lightest / k));
  scene.gravity = {0, -g, 0};
  scene.bodies = {floor_body(.8, halo), cube(mass, edge / 2 + reach), cube(upper, 1.5 * edge + 2 * reach)};
  Simulation sim(scene, with(request));
  const double drop = upper * g / (8 * k), still = 1e-10 * upper * g * drop;
  constexpr std::int64_t most = 20'000'000;
  std::int64_t steps = 0;
  for (int quiet = 0; quiet < 10 && steps < most; steps += 100) { // not only at a turning point
    sim.run(100);
    quiet = sim.energy().kinetic < still ? quiet + 1 : 0;
  }
  const double height = 1.5 * edge + 2 * reach - (mass + upper) * g / (4 * k) - drop;
  const double period = 2 * pi * std::sqrt(heaviest / k); // of the heavy one on one spring
  return {{"height_error_of_edge", (sim.particles().position[2].y() - height) / edge, 1e-6},
          {"kinetic_of_m_g_overlap", sim.energy().kinetic / (upper * g * drop), 1e-9},
          {"periods_to_rest", sim.time() / period, {}},
          {"steps_to_rest", static_cast<double>(steps), {}}};
}

std::vector<Metric> long_rest(const StudyRequest& request) {
  const double k = 1e6, overlap = mass * g / (4 * k);
  Scene scene = empty_scene(2, {.stiffness = k, .damping_ratio = .5, .friction = .5}, 1e-4);
  scene.gravity = {0, -g, 0};
  Body body = cube(mass, edge / 2 + reach - overlap);
  body.orientation = Eigen::AngleAxisd(.3, Vector3d::UnitY());
  scene.bodies = {floor_body(.8, halo), body};
  Simulation sim(scene, with(request));
  sim.run(2000);
  const Vector3d start = sim.particles().position[1];
  const Eigen::Quaterniond turn = sim.particles().orientation[1];
  double kinetic = 0;
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(request.value); ++i) {
    sim.step();
    if (i % 1000 == 0) kinetic = std::max(kinetic, sim.energy().kinetic);
  }
  return {{"drift_m", (sim.particles().position[1] - start).norm(), 1e-9},
          {"turn_rad", turn.angularDistance(sim.particles().orientation[1]), 1e-8},
          {"kinetic_of_m_g_overlap", kinetic / (mass * g * overlap), 1e-9}};
}

namespace {

/// Velocity and spin after a cube without weight, tilted by `tilt` about an edge, has dropped on its face; both over
/// the speed.
Eigen::Vector2d after_flat_drop(const StudyRequest& request, double stiffness, double speed) {
  const double omega = std::sqrt(stiffness / mass), tilt = request.value * speed / (edge * omega);
  Scene scene = empty_scene(4, {.stiffness = stiffness, .damping_ratio = 0, .friction = 0},
                            pi / omega / 4 / request.steps_per_contact);
  scene.bodies = {floor_body(1, halo), cube(mass, 0)};
  const double lowest = edge / 2 * (std::cos(tilt) + std::sin(tilt));
  scene.bodies[1].position.y() = lowest + reach + 1e-7;
  scene.bodies[1].orientation = Eigen::AngleAxisd(tilt, Vector3d::UnitZ());
  scene.bodies[1].velocity = {0, -speed, 0};
  Simulation sim(scene, with(request));
  // The last corner comes after tilt * edge / speed at the latest, and leaves half a period later.
  const double end = 3 * pi / omega + 3 * tilt * edge / speed;
  while (sim.time() < end || !sim.contacts().empty()) {
    sim.step();
    if (sim.time() > 50 * end) break;
  }
  return {sim.particles().velocity[1].y() / speed, std::abs(sim.particles().angular_velocity(1).z()) * edge / speed};
}

/// The same of a rigid cube whose lower edges are springs, for a tilt and times so small that it hardly turns. Heights
/// y1 and y2 of the edges in units of speed / omega, times of 1 / omega; two corners of stiffness k carry an edge, and
/// the moment of inertia is m edge^2 / 6.
Eigen::Vector2d two_edges_on_springs(double theta) {
  constexpr double h = 1e-3;
  Eigen::Vector2d y(0, theta), v(-1, -1);
  const auto pull = [](const Eigen::Vector2d& at) -> Eigen::Vector2d {
    const Eigen::Vector2d force = -2 * at.cwiseMin(0);
    return {2.5 * force[0] - .5 * force[1], 2.5 * force[1] - .5 * force[0]};
  };
  while (y.minCoeff() <= 0 || v.minCoeff() < 0) { // velocity Verlet
    v += h / 2 * pull(y);
    y += h * v;
    v += h / 2 * pull(y);
  }
  return {v.mean(), std::abs(v[1] - v[0])};
}

} // namespace

std::vector<Metric> flat_drop(const StudyRequest& request) {
  const Eigen::Vector2d one = after_flat_drop(request, 1e6, .01), stiff = after_flat_drop(request, 1.6e7, .01),
                        slow = after_flat_drop(request, 1e6, .0025);
  const double spread = std::max((one - stiff).cwiseAbs().maxCoeff(), (one - slow).cwiseAbs().maxCoeff());
  const Eigen::Vector2d theory = two_edges_on_springs(request.value);
  return {{"velocity_over_speed", one[0], {}},
          {"velocity_theory", theory[0], {}},
          {"spin_edge_over_speed", one[1], {}},
          {"spin_theory", theory[1], {}},
          {"error", (one - theory).cwiseAbs().maxCoeff(), 1e-2},
          {"spread", spread, 1e-2}};
}

namespace {

/// Largest kinetic energy at moments without contact after a body without weight has met the floor, over that before.
double energy_after_graze(const StudyRequest& request, Body body, double damping, double spin) {
  const double theta = request.value * pi / 180, k = 1e6, speed = 1;
  Scene scene = empty_scene(4, {.stiffness = k, .damping_ratio = damping, .friction = .5},
                            pi * std::sqrt(mass / k) / 4 / request.steps_per_contact);
  body.position.y() = reach + 1e-6 - lowest_point(body);
  body.velocity = speed * Vector3d(std::sin(theta), -std::cos(theta), 0);
  body.angular_velocity = spin * body.orientation.vec().normalized();
  scene.bodies = {floor_body(4, halo), body};
  Simulation sim(scene, with(request));
  const double before = sim.energy().kinetic;
  double most = 0;
  bool touched = false;
  while (sim.time() < .03) {
    sim.step();
    touched |= !sim.contacts().empty();
    if (touched && sim.contacts().empty()) most = std::max(most, kinetic_energy(sim.particles()) / before);
  }
  return most;
}

} // namespace

std::vector<Metric> grazing(const StudyRequest& request) {
  constexpr int impacts = 30;
  Random random(request.seed);
  double damped = 0, undamped = 0;
  for (int i = 0; i < impacts; ++i) {
    Body body = i % 3 == 0   ? sphere_body(edge / 2, mass, {0, 0, 0}, halo)
                : i % 3 == 1 ? cube(mass, 0)
                             : mesh_body(granulate(edge, 20, 100 + i), mass, {0, 0, 0}, halo);
    body.orientation = random.rotation();
    const double spin = 40 * (random.uniform() - .5);
    damped = std::max(damped, energy_after_graze(request, body, .3, spin));
    undamped = std::max(undamped, energy_after_graze(request, body, 0, spin));
  }
  return {{"energy_gained", std::max(0., damped - 1), 1e-12},
          {"energy_gained_undamped", std::max(0., undamped - 1), {}},
          {"energy_kept", damped, {}}};
}

namespace {

/// Cubes and granulates thrown together above a floor.
Scene heap(const StudyRequest& request) {
  Scene scene = empty_scene(4, {.stiffness = 1e6, .damping_ratio = .3, .friction = .5}, 2e-5);
  scene.gravity = {0, -g, 0};
  scene.bodies = {floor_body(2, halo)};
  Random random(request.seed);
  for (int i = 0; i < request.particles; ++i) {
    const Vector3d place = .2 * Vector3d(i % 4 - 1.5, .6 + i / 16, i / 4 % 4 - 1.5);
    Body body = i % 2 ? cube(mass, 0) : mesh_body(granulate(edge, 20, 100 + i), mass, {0, 0, 0}, halo);
    body.position = place;
    body.orientation = random.rotation();
    body.velocity = -8 * place + random.direction();
    body.angular_velocity = 10 * random.direction();
    scene.bodies.push_back(body);
  }
  return scene;
}

} // namespace

std::vector<Metric> determinism(const StudyRequest& request) {
  const int threads = static_cast<int>(request.value);
  const Scene scene = heap(request);
  std::int64_t contacts = 0;
  const auto hash = [&](Options options) {
    options.contact_rule = request.contact_rule;
    Simulation sim(scene, std::move(options));
    contacts = sim.run(1000).contacts;
    return sim.state_hash();
  };
  const std::uint64_t expected = hash({.grid = "none"});
  std::vector<Metric> metrics{{"contacts", static_cast<double>(contacts), {}}};
  for (const std::string scheme : {"plain", "task"})
    for (const std::string runtime : {"openmp", "tbb"}) {
      int differ = 0;
      for (const std::string grid : {"regular", "adaptive", "reluctant"})
        differ += expected != hash({.grid = grid, .scheme = scheme, .runtime = runtime, .threads = threads});
      metrics.push_back({"different_states_" + scheme + "_" + runtime, static_cast<double>(differ), 0});
    }
  return metrics;
}

} // namespace trigrain
