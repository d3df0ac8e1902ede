#include "experiments/stability/friction.hpp"
#include "dem/critical_step.hpp"
#include "dem/motion.hpp"
#include "experiments/stability/setups.hpp"
#include <algorithm>
#include <cmath>
#include <numbers>

namespace trigrain {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

/// A block on a slope: the floor is level and gravity leans towards +x.
Scene block_on_slope(const Vector3d& size, double angle, double mu) {
  const double mass = 1, k = 1e6;
  Scene scene = empty_scene(20, {.stiffness = k, .damping_ratio = .5, .friction = mu}, 2e-5);
  scene.gravity = {g * std::sin(angle), -g * std::cos(angle), 0};
  scene.bodies = {floor_body(8, 5e-4),
                  mesh_body(box(size), mass, {0, size.y() / 2 + 1e-3 - g * std::cos(angle) / (4 * k), 0}, 5e-4)};
  return scene;
}

/// Prism of n corners on a circle of radius 1, as wide as that, about z.
Mesh prism(int n) {
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> faces;
  for (const double z : {-.5, .5})
    for (int i = 0; i < n; ++i) vertices.emplace_back(std::sin(2 * pi * i / n), -std::cos(2 * pi * i / n), z);
  for (int i = 0; i < n; ++i) {
    const int next = (i + 1) % n;
    faces.push_back({i, next, n + next}), faces.push_back({i, n + next, n + i});
    if (i > 0 && next > 0) faces.push_back({0, next, i}), faces.push_back({n, n + i, n + next});
  }
  return make_mesh("prism", std::move(vertices), std::move(faces));
}

} // namespace

std::vector<Metric> slope(const StudyRequest& request) {
  const double angle = request.value * pi / 180, mu = .3;
  Simulation sim(block_on_slope({.2, .1, .2}, angle, mu), with(request));
  sim.run(5000);
  const double v0 = sim.particles().velocity[1].x(), t0 = sim.time();
  sim.run(10000);
  const double found = (sim.particles().velocity[1].x() - v0) / (sim.time() - t0);
  return {{"acceleration_error", found / (g * (std::sin(angle) - mu * std::cos(angle))) - 1, 1e-3}};
}

std::vector<Metric> slope_rest(const StudyRequest& request) {
  const double angle = 20 * pi / 180;
  const Scene scene = block_on_slope({.2, .1, .2}, angle, .5);
  Simulation sim(scene, with(request));
  sim.run(20000);
  const Vector3d settled = sim.particles().position[1];
  const double since = sim.time();
  sim.run(static_cast<std::int64_t>(request.value));
  const ContactParameters& law = scene.contact; // the block's mass is 1
  const double dashpot = 2 * law.damping_ratio * std::sqrt(law.stiffness * law.tangential_ratio);
  return {{"creep_m", (sim.particles().position[1] - settled).norm(), 1e-9},
          {"creep_without_springs_m", g * std::sin(angle) / dashpot * (sim.time() - since), {}}};
}

std::vector<Metric> topple(const StudyRequest& request) {
  const int n = static_cast<int>(request.value);
  int wrong = 0;
  constexpr double shape = .6; // width over height
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double incline = .21 + .83 * i / n, mu = .17 + .91 * j / n; // tan of the slope, and friction
      if (std::abs(incline / shape - 1) < .02 || std::abs(mu / incline - 1) < .02 || std::abs(mu / shape - 1) < .02)
        continue;
      Simulation sim(block_on_slope({.1 * shape, .1, .1}, std::atan(incline), mu), with(request));
      sim.run(15000);
      const Particles& p = sim.particles();
      const bool turned = p.orientation[1].angularDistance(Eigen::Quaterniond::Identity()) > .02;
      const bool slid = !turned && p.position[1].x() > 1e-3;
      // A block that slides topples when friction holds its foot back by more than its width allows.
      const bool should_slide = mu<incline, should_topple = std::min(mu, incline)> shape;
      wrong += should_topple ? !turned : should_slide ? !slid : turned || slid;
    }
  return {{"wrong_blocks", static_cast<double>(wrong), 0}};
}

/// A ball slides from speed 1 until it rolls, or rolls down a slope from rest.
std::vector<Metric> rolling_ball(const StudyRequest& request) {
  constexpr double radius = .1, mass = 1, mu = .3, speed = 1;
  const double angle = request.value * pi / 180, k = 1e6 * request.stiffness;
  const double step = pi * std::sqrt(mass / k) / request.steps_per_contact;
  Scene scene = empty_scene(20, {.stiffness = k, .damping_ratio = .3, .friction = mu}, step);
  scene.gravity = {g * std::sin(angle), -g * std::cos(angle), 0};
  scene.bodies = {floor_body(10, 1e-3),
                  sphere_body(radius, mass, {0, radius + 2e-3 - mass * g * std::cos(angle) / k, 0}, 1e-3)};
  if (request.value == 0) scene.bodies[1].velocity = {speed, 0, 0};
  Simulation sim(scene, with(request));
  const auto velocity = [&] { return sim.particles().velocity[1].x(); };
  const auto until = [&](double t) {
    while (sim.time() < t) sim.step();
    return velocity();
  };
  if (request.value == 0) {
    const double rolls = 2 * speed / (7 * mu * g);
    const double half = until(rolls / 2), half_way = speed - mu * g * sim.time(), at_end = until(2 * rolls);
    return {{"sliding_velocity_error", half / half_way - 1, 1e-3},
            {"rolling_velocity_error", at_end / (5. / 7. * speed) - 1, 1e-3},
            {"slip_of_velocity", (at_end + radius * sim.particles().angular_velocity(1).z()) / at_end, 1e-3}};
  }
  const bool slides = std::tan(angle) > 3.5 * mu; // the ball needs more friction than there is
  const double expected = slides ? g * (std::sin(angle) - mu * std::cos(angle)) : 5. / 7. * g * std::sin(angle);
  const double v0 = until(.05), t0 = sim.time(), v1 = until(.45);
  return {{"acceleration_error", (v1 - v0) / (sim.time() - t0) / expected - 1, 1e-3}};
}

/// A prism rolls over its edges; each impact on the next one leaves (J + cos(2 pi / n)) / (1 + J) of its spin, if it is
/// plastic, does not slip and its edge stays down in between: that takes twice the critical damping, since a contact
/// that never pulls returns exp(-2) of the speed at once the critical. Spins from the energy about the edge.
std::vector<Metric> rolling_polygon(const StudyRequest& request) {
  const int n = static_cast<int>(request.value);
  constexpr double mass = 1, halo = 2e-4;
  const double k = 1e8 * request.stiffness, weight = g * mass;
  Scene scene = empty_scene(40, {.stiffness = k, .damping_ratio = 2, .friction = 3},
                            pi * std::sqrt(mass / k) / 4 / request.steps_per_contact);
  scene.gravity = {0, -g, 0};
  Body body = mesh_body(prism(n), mass, {0, 1 + 2 * halo - weight / (2 * k), 0}, halo);
  const double inertia = (1 - 2. / 3. * std::pow(std::sin(pi / n), 2)) / 2, spin = 2.6;
  body.velocity = {spin, 0, 0}, body.angular_velocity = {0, 0, -spin};
  scene.bodies = {floor_body(30, halo), body};
  scene.time.step = std::min(scene.time.step, .8 * critical_step(scene)); // dashpots of narrow facets are fast
  Simulation sim(scene, with(request));
  const auto spin2 = [&] { // about the edge, if it were upright on it
    const Particles& p = sim.particles();
    return 2 * (kinetic_energy(p) + mass * g * (p.position[1].y() - 1 - 2 * halo)) / (mass * (1 + inertia));
  };
  const double drop = 2 * g * (1 - std::cos(pi / n)) / (1 + inertia); // gained in spin^2 from upright to the impact
  const double expected = (inertia + std::cos(2 * pi / n)) / (1 + inertia);
  double before = spin2(), worst = 0, passed = 0;
  for (int facet = 1; facet <= 4; ++facet) {
    while (sim.time() < 10 && sim.particles().position[1].x() < facet * 2 * std::sin(pi / n))
      sim.step(); // upright again
    const double after = spin2();
    if (!(after > 0) || sim.time() >= 10) break;
    worst = std::max(worst, std::abs(std::sqrt((after + drop) / (before + drop)) / expected - 1));
    before = after, ++passed;
  }
  return {{"spin_ratio_error", passed > 0 ? worst : std::nan(""), 1e-3},
          {"facets", passed, {}},
          {"spin_ratio", expected, {}}};
}

} // namespace trigrain
