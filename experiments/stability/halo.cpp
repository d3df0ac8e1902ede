#include "experiments/stability/halo.hpp"
#include "dem/motion.hpp"
#include "experiments/stability/setups.hpp"
#include <algorithm>
#include <cmath>
#include <numbers>

namespace trigrain {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr double radius = .02, mass = 1, halo = 1e-3, reach = 2 * halo, stiffness = 1e6;
const double response_limit = reach * std::sqrt(stiffness / mass); // m/s

/// A ball above a plate (its top at y = 0) that comes down at this speed (m/s).
Scene ball_and_plate(const StudyRequest& request, double thickness, double height, double speed) {
  Scene scene = empty_scene(4, {.stiffness = stiffness, .damping_ratio = 0, .friction = 0},
                            pi * std::sqrt(mass / stiffness) / request.steps_per_contact);
  scene.time.control = request.control;
  Body plate;
  plate.mesh = std::make_shared<Mesh>(box({1, thickness, 1}));
  plate.position = {0, -thickness / 2, 0};
  plate.halo = halo;
  plate.fixed = true;
  Body ball = sphere_body(radius, mass, {0, height, 0}, halo);
  ball.velocity = {0, -speed, 0};
  scene.bodies = {plate, ball};
  return scene;
}

} // namespace

std::vector<Metric> tunnelling(const StudyRequest& request) {
  Simulation sim(ball_and_plate(request, .1, radius + reach + .03, request.value * response_limit), with(request));
  StepStats stats;
  const double end = .5 / (request.value * response_limit);
  while (sim.time() < end) stats += sim.step();
  const bool passed = sim.particles().velocity[1].y() < 0;
  return {{"passed_through", passed ? 1. : 0., {}},
          {"speed_after_over_before", sim.particles().velocity[1].norm() / (request.value * response_limit), {}},
          {"unreported", passed && stats.fast_contacts == 0 ? 1. : 0., 0},
          {"passed_below_the_limit", passed && request.value < 1 ? 1. : 0., 0}};
}

/// A ball crosses a thin plate so fast that it moves by `value` times the width in which the plate is seen per step.
std::vector<Metric> detection(const StudyRequest& request) {
  constexpr int phases = 100; // of a step at the plate
  constexpr double thickness = 1e-3, width = 2 * (radius + reach) + thickness;
  int seen = 0, silent = 0;
  for (int phase = 0; phase < phases; ++phase) {
    Scene scene = ball_and_plate(request, thickness, 0, 0);
    const double way = request.value * width, speed = way / scene.time.step;
    scene.bodies[1].velocity.y() = -speed;
    scene.bodies[1].position.y() = radius + reach + way * (1 + (phase + .5) / phases);
    Simulation sim(scene, with(request));
    StepStats stats;
    for (int i = 0; i < 20000 && sim.particles().position[1].y() > -radius - way; ++i) stats += sim.step();
    seen += stats.contacts + stats.crossings > 0;
    silent += sim.particles().velocity[1].y() < 0 && stats.fast_contacts + stats.fast_bodies == 0;
  }
  const double share = static_cast<double>(seen) / phases, expected = std::min(1., 1 / request.value);
  const bool fixed = request.control == "fixed";
  return {{"seen_share", share, {}},
          {"seen_less_width_over_way", share - expected, fixed ? std::optional(1.5 / phases) : std::nullopt},
          {"silent_share", static_cast<double>(silent) / phases, 0}};
}

namespace {

/// Bodies that are released, each with its lowest point at y = 0; `name` is part of a metric.
struct Shape {
  std::string name;
  Body body;
};

std::vector<Shape> shapes() {
  const auto cube = [](double about_z, double about_x) {
    Body body = mesh_body(box({.1, .1, .1}), mass, {0, 0, 0}, halo);
    body.orientation = Eigen::AngleAxisd(about_x, Vector3d::UnitX()) * Eigen::AngleAxisd(about_z, Vector3d::UnitZ());
    return body;
  };
  return {{"ball", sphere_body(.05, mass, {0, 0, 0}, halo)},
          {"mesh_ball", mesh_body(icosphere(.05, 2), mass, {0, 0, 0}, halo)},
          {"cube_on_face", cube(0, 0)},
          {"cube_on_edge", cube(pi / 4, 0)},
          {"cube_on_corner", cube(pi / 4, std::atan(1 / std::sqrt(2.)))},
          {"tilted_cube", cube(.1, .02)},
          {"granulate", mesh_body(granulate(.1, 20, 7), mass, {0, 0, 0}, halo)}};
}

} // namespace

std::vector<Metric> overlap_release(const StudyRequest& request) {
  std::vector<Metric> metrics;
  for (Shape& shape : shapes()) {
    Scene scene = empty_scene(4, {.stiffness = stiffness, .damping_ratio = 0, .friction = 0}, 1e-9);
    shape.body.position.y() = (1 - request.value) * reach - lowest_point(shape.body);
    scene.bodies = {floor_body(1, halo), shape.body};
    Simulation first(scene, with(request));
    first.step();
    const double stored = elastic_energy(first.contacts());
    scene.time.step = pi / 2 * first.contact_step_limit() / request.steps_per_contact; // of the fastest mode
    scene.time.force = true; // many springs at once are the rule's business
    Simulation sim(scene, with(request));
    for (int i = 0, apart = 0; i < 1'000'000 && apart < 100; ++i) {
      sim.step();
      apart = sim.contacts().empty() ? apart + 1 : 0;
    }
    metrics.push_back({"energy_error_" + shape.name, kinetic_energy(sim.particles()) / stored - 1, 2e-3});
    metrics.push_back({"speed_" + shape.name + "_m_s", sim.particles().velocity[1].norm(), {}});
  }
  return metrics;
}

} // namespace trigrain
