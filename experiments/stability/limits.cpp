#include "experiments/stability/limits.hpp"
#include "dem/hertz.hpp"
#include "experiments/stability/setups.hpp"
#include <algorithm>
#include <cmath>
#include <numbers>

namespace trigrain {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr double g = 9.81, edge = .1, mass = 1, halo = 1e-3, reach = 2 * halo;

Options with(const StudyRequest& request) { return {.contact_rule = request.contact_rule}; }

/// An undamped ball of mass 1 that falls on a plane at this speed (m/s) without weight, or cubes that stand on it.
Scene ball_on_floor(const StudyRequest& request, double speed) {
  const bool hertz = request.law == "hertz-mindlin";
  Scene scene = empty_scene(
      4, {.law = request.law, .stiffness = 1e6, .damping_ratio = 0, .friction = 0, .youngs_modulus = 1e8}, 1);
  const double contact_time = hertz ? [&] {
    const double k = hertz_pair(scene.contact, .1, 1e300, true).k;
    return 2.943275 * std::pow(5 * mass * speed * speed / (4 * k), .4) / speed;
  }() : pi * std::sqrt(mass / scene.contact.stiffness);
  scene.time.step = contact_time / request.steps_per_contact;
  scene.time.force = true; // the study is about steps that are too long
  scene.time.control = request.control;
  Body floor = floor_body(1, 4 * halo);
  floor.position.y() -= 4 * halo;
  Body ball = sphere_body(.1, mass, {0, .1, 0}, 0);
  ball.velocity = {0, -speed, 0};
  scene.bodies = {floor, ball};
  return scene;
}

/// Cubes on each other on the floor, each pressed a little into the next.
Scene standing_cubes(int count, double ratio) {
  Scene scene = empty_scene(4, {.stiffness = 1e6, .damping_ratio = 0, .friction = .5}, 1e-5);
  scene.bodies = {floor_body(.8, halo)};
  for (int i = 0; i < count; ++i)
    scene.bodies.push_back(mesh_body(box({edge, edge, edge}), i + 1 == count ? ratio * mass : mass,
                                     {0, (i + .5) * edge + (i + 1) * (reach - 1e-5), 0}, halo));
  return scene;
}

/// Does a small disturbance grow when the scene is run at this step?
bool grows(Scene scene, double step, const StudyRequest& request) {
  scene.time.step = step, scene.time.force = true;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    scene.bodies[i].velocity = 1e-4 * Vector3d(.3, 1 + .1 * i, -.2);
    if (scene.bodies[i].mesh) scene.bodies[i].angular_velocity = {1e-3, 2e-4, -1.5e-3};
  }
  Simulation sim(scene, with(request));
  const double start = sim.energy().kinetic + 1e-12;
  for (int i = 0; i < 2000; ++i) {
    sim.step();
    if (!(sim.energy().kinetic < 1e3 * start)) return true;
  }
  return false;
}

} // namespace

std::vector<Metric> step_limit(const StudyRequest& request) {
  const int which = static_cast<int>(request.value);
  Scene scene = which == 0 ? ball_on_floor(request, 1e-4) : standing_cubes(which == 1 ? 1 : 3, 1);
  if (which == 0) scene.bodies[1].position.y() = .1 - 1e-3;
  scene.time.step = 1e-9;
  Simulation first(scene, with(request));
  first.step();
  const double predicted = first.contact_step_limit();
  double low = .3 * predicted, high = 3 * predicted;
  for (int i = 0; i < 12; ++i) {
    const double middle = std::sqrt(low * high);
    (grows(scene, middle, request) ? high : low) = middle;
  }
  return {{"observed_over_predicted_less_1", low / predicted - 1, .05},
          {"predicted_s", predicted, {}},
          {"textbook_over_observed", 2 * std::sqrt(mass / scene.contact.stiffness) / low, {}}};
}

/// The worst over where in a step the contact begins.
std::vector<Metric> rebound(const StudyRequest& request) {
  constexpr int phases = 16;
  double worst = 0, mean = 0;
  for (int phase = 0; phase < phases; ++phase) {
    Scene scene = ball_on_floor(request, .1);
    scene.bodies[1].position.y() += .1 * scene.time.step * (phase + .5) / phases;
    Simulation sim(scene, with(request));
    bool touched = false;
    for (double end = 20 * scene.time.step * request.steps_per_contact; sim.time() < end;) {
      sim.step();
      touched |= !sim.contacts().empty();
      if (touched && sim.contacts().empty()) break;
    }
    const double error = std::abs(sim.particles().velocity[1].y() / .1 - 1);
    worst = std::max(worst, error), mean += error / phases;
  }
  const double z = pi / request.steps_per_contact;
  return {{"restitution_error", worst,
           request.law == "spring-dashpot" ? std::optional(z * z / 8 * 1.02 + 1e-12) : std::nullopt},
          {"mean_restitution_error", mean, {}}};
}

std::vector<Metric> long_run(const StudyRequest& request) {
  Scene scene = ball_on_floor(request, .5);
  scene.gravity = {0, -g, 0};
  Simulation sim(scene, with(request));
  double sum = 0, worst = 0, start = 0;
  int bounces = 0;
  std::int64_t steps = 0;
  bool touching = false;
  for (const auto limit = static_cast<std::int64_t>(1e7); bounces < request.value && steps < limit; ++steps) {
    sim.step();
    const bool now = !sim.contacts().empty();
    if (touching && !now) {
      const double energy = sim.energy().total();
      if (bounces++ == 0) start = energy;
      const double zero = mass * g * .1; // the floor's top
      const double error = (energy - start) / (start - zero);
      sum += error * error, worst = std::max(worst, std::abs(error));
    }
    touching = now;
  }
  return {{"rms_energy_error", std::sqrt(sum / std::max(1, bounces)), {}},
          {"worst_energy_error", worst, {}},
          {"bounces", static_cast<double>(bounces), {}},
          {"steps_per_bounce", static_cast<double>(steps) / std::max(1, bounces), {}}};
}

std::vector<Metric> tunnelling(const StudyRequest& request) {
  Scene scene = ball_on_floor(request, .1);
  const double limit = 4 * halo * std::sqrt(scene.contact.stiffness / mass);
  scene.bodies[1].velocity.y() = -request.value * limit;
  scene.bodies[1].position.y() += .02;
  Simulation sim(scene, with(request));
  const StepStats stats = sim.run(20 * static_cast<std::int64_t>(request.steps_per_contact));
  const bool passed = sim.particles().velocity[1].y() < 0;
  return {{"passed_through", passed ? 1. : 0., {}},
          {"unreported", passed && stats.fast_contacts == 0 ? 1. : 0., 0},
          {"stopped_below_limit_failed", passed && request.value < 1 ? 1. : 0., 0}};
}

std::vector<Metric> overlap_release(const StudyRequest& request) {
  Scene scene = ball_on_floor(request, .1);
  scene.bodies[1].velocity.setZero();
  scene.bodies[1].position.y() = .1 - request.value * 4 * halo;
  Probe probe(scene, request.contact_rule);
  probe.evaluate();
  Simulation sim(scene, with(request));
  sim.run(3 * static_cast<std::int64_t>(request.steps_per_contact));
  const double speed = sim.particles().velocity[1].y();
  return {{"ejection_speed_error", speed / std::sqrt(2 * probe.energy / mass) - 1, 2e-3}};
}

std::vector<Metric> cut_floor(const StudyRequest& request) {
  const double k = 1e6;
  Scene scene = empty_scene(8, {.stiffness = k, .damping_ratio = .3, .friction = .2}, 2e-5);
  scene.gravity = {0, -g, 0};
  scene.bodies = {floor_body(2, halo, static_cast<int>(request.value)),
                  mesh_body(box({edge, edge, edge}), mass, {0, edge / 2 + reach - mass * g / (4 * k), 0}, halo)};
  scene.bodies[1].orientation = Eigen::AngleAxisd(.3, Vector3d::UnitY());
  scene.bodies[1].velocity = {.4, 0, .17};
  Simulation sim(scene, with(request));
  sim.run(500);
  double ripple = 0, jump = 0;
  for (int i = 0; i < 4000; ++i) {
    sim.step();
    Vector3d force = Vector3d::Zero();
    for (const Contact& c : sim.contacts()) {
      force -= c.force;
      jump = std::max(jump, std::acos(std::clamp(std::abs(c.normal.y()), 0., 1.)) * 180 / pi);
    }
    ripple = std::max(ripple, std::abs(force.y() / (mass * g) - 1));
  }
  return {{"ripple_of_weight", ripple, 1e-6}, {"tilt_of_normal_deg", jump, 5}};
}

std::vector<Metric> mass_ratio(const StudyRequest& request) {
  Scene scene = standing_cubes(2, request.value);
  scene.gravity = {0, -g, 0};
  scene.contact = {.stiffness = 1e6 * std::max(1., request.value), .damping_ratio = .5, .friction = .5};
  scene.time.step = .1 / std::sqrt(scene.contact.stiffness / std::min(1., request.value));
  Simulation sim(scene, with(request));
  sim.run(30000);
  const double expected = 1.5 * edge + 2 * reach - (1 + request.value) * g / (4 * scene.contact.stiffness) -
                          request.value * g / (8 * scene.contact.stiffness);
  return {{"height_error_of_edge", (sim.particles().position[2].y() - expected) / edge, 1e-6}};
}

} // namespace trigrain
