#include "experiments/stability/steps.hpp"
#include "dem/hertz.hpp"
#include "dem/motion.hpp"
#include "experiments/stability/setups.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>
#include <cmath>
#include <numbers>

namespace trigrain {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr double edge = .1, mass = 1, halo = 1e-3, reach = 2 * halo;

// --- the critical step

/// What stands on the floor, by `value` of the study.
Scene standing(const StudyRequest& request) {
  const int which = static_cast<int>(request.value);
  Scene scene = empty_scene(
      4, {.law = request.law, .stiffness = 1e6, .friction = which == 1 ? 0. : .5, .youngs_modulus = 1e8}, 1e-6);
  scene.gravity = {0, -g, 0};
  const int cut = which == 3 ? 4 : 1;
  scene.bodies = {floor_body(.8, halo, cut)};
  const auto cube = [&](double height, double turn) {
    Body body = mesh_body(box({edge, edge, edge}, cut), mass, {0, height, 0}, halo);
    body.orientation = Eigen::AngleAxisd(turn, Vector3d::UnitY());
    scene.bodies.push_back(body);
  };
  switch (which) {
  case 0:
    scene.bodies.push_back(sphere_body(.1, mass, {0, .1 + reach, 0}, halo));
    break;
  case 1:
  case 2:
  case 3:
    cube(edge / 2 + reach, .3);
    break;
  case 4:
    for (int i = 0; i < 3; ++i) cube((i + .5) * edge + (i + 1) * reach, 0);
    break;
  case 5:
    for (int i = 0; i < 2; ++i) cube((i + .5) * edge + (i + 1) * reach, .5 * i);
    break;
  default:
    throw InputError("nothing stands there (--value). Give 0 to 5.");
  }
  return scene;
}

/// The scene when everything has come to rest; without friction, so that no tangential spring is strained.
Scene at_rest(Scene scene, const StudyRequest& request) {
  const double friction = scene.contact.friction;
  scene.contact.damping_ratio = .5, scene.contact.friction = 0;
  scene.time.step = 5e-5;
  Simulation sim(scene, with(request));
  sim.run(20000);
  for (int i = 0; i < sim.particles().size(); ++i) {
    if (scene.bodies[i].fixed) continue;
    scene.bodies[i] = sim.particles().body(i);
    scene.bodies[i].velocity = scene.bodies[i].angular_velocity = Vector3d::Zero();
  }
  scene.contact.friction = friction;
  return scene;
}

/// Does a disturbance, too small to open a contact, grow at this step?
bool grows(Scene scene, double step, const StudyRequest& request) {
  constexpr double small = 1e-9, much = 1e8; // m/s; of the energy
  scene.time.step = step, scene.time.force = true;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    scene.bodies[i].velocity = small * Vector3d(.3, 1 + .1 * static_cast<double>(i), -.2);
    scene.bodies[i].angular_velocity = small / edge * Vector3d(1, .2, -1.5);
  }
  Simulation sim(scene, with(request));
  const double start = kinetic_energy(sim.particles());
  for (int i = 0; i < 3000; ++i) {
    sim.step();
    if (!(kinetic_energy(sim.particles()) < much * start)) return true;
  }
  return false;
}

} // namespace

std::vector<Metric> critical_step_study(const StudyRequest& request) {
  Scene scene = at_rest(standing(request), request);
  std::vector<Metric> metrics;
  for (const double zeta : {0., .3, .8}) {
    scene.contact.damping_ratio = zeta;
    scene.time.step = 1e-9;
    Simulation first(scene, with(request));
    first.step();
    const double predicted = first.contact_step_limit();
    double low = .5 * predicted, high = 2 * predicted;
    for (int i = 0; i < 10; ++i) {
      const double middle = std::sqrt(low * high);
      (grows(scene, middle, request) ? high : low) = middle;
    }
    const double ratio = low / predicted;
    const std::string at = "_at_damping_" + std::to_string(static_cast<int>(100 * zeta + .5)) + "_percent";
    metrics.push_back({"observed_over_predicted" + at, ratio, {}});
    metrics.push_back({"outside_0.95_to_1.02" + at, std::max({0., .95 - ratio, ratio - 1.02}), 0});
    if (zeta == 0)
      metrics.push_back({"textbook_over_observed", 2 * std::sqrt(mass / scene.contact.stiffness) / low, {}});
  }
  return metrics;
}

namespace {

// --- impacts

struct Impact {
  Scene scene;
  double contact_time; ///< s
};

/// A ball that falls on a plane at this speed (m/s) without weight.
Impact ball_on_floor(const StudyRequest& request, double speed, double damping_ratio) {
  Scene scene = empty_scene(
      4, {.law = request.law, .stiffness = 1e6, .damping_ratio = damping_ratio, .friction = 0, .youngs_modulus = 1e8},
      1);
  const double contact_time = elastic_contact_time(scene.contact, mass, .1, speed);
  scene.time.step = contact_time / request.steps_per_contact;
  scene.time.force = true; // the studies are about steps that are too long
  scene.time.control = request.control;
  Body floor = floor_body(1, 4 * halo);
  floor.position.y() -= 4 * halo;
  Body ball = sphere_body(.1, mass, {0, .1, 0}, 0);
  ball.velocity = {0, -speed, 0};
  scene.bodies = {floor, ball};
  return {scene, contact_time};
}

constexpr int phases = 64; // of a step in which the contact begins

struct ReboundErrors {
  double worst = 0, mean = 0;
  void add(double error) { worst = std::max(worst, std::abs(error)), mean += std::abs(error) / phases; }
  std::vector<Metric> metrics(std::optional<double> bar) const {
    return {{"restitution_error", worst, bar}, {"mean_restitution_error", mean, {}}};
  }
};

} // namespace

std::vector<Metric> rebound(const StudyRequest& request) {
  const double e = request.value, damping = damping_ratio_for(request.law, e);
  ReboundErrors errors;
  for (int phase = 0; phase < phases; ++phase) {
    auto [scene, contact_time] = ball_on_floor(request, .1, damping);
    scene.bodies[1].position.y() += .1 * scene.time.step * (phase + .5) / phases;
    Simulation sim(scene, with(request));
    for (bool touched = false; sim.time() < 20 * contact_time && !(touched && sim.contacts().empty());) {
      sim.step();
      touched |= !sim.contacts().empty();
    }
    errors.add(sim.particles().velocity[1].y() / .1 - e);
  }
  const double z = pi / request.steps_per_contact;
  const bool known = request.law == "spring-dashpot" && e == 1;
  return errors.metrics(known ? std::optional(z * z / 8 * 1.02 + 1e-12) : std::nullopt);
}

/// Positions move with the velocities of before the kick: a line to compare with, not in the engine.
std::vector<Metric> rebound_explicit(const StudyRequest& request) {
  const double power = request.law == "spring-dashpot" ? 1 : 1.5;              // x'' = -x^power, from x' = 1
  const double contact_time = power == 1 ? pi : 2.943275 * std::pow(1.25, .4); // Hertz: largest x is (5/4)^(2/5)
  const double h = contact_time / request.steps_per_contact;
  ReboundErrors errors;
  for (int phase = 0; phase < phases; ++phase) {
    double x = -h * (phase + .5) / phases, v = 1;
    while (v > 0 || x > 0) {
      const double pull = std::pow(std::max(0., x), power);
      x += h * v;
      v -= h * pull;
    }
    errors.add(-v - 1);
  }
  return errors.metrics({});
}

std::vector<Metric> long_run(const StudyRequest& request) {
  auto [scene, contact_time] = ball_on_floor(request, .5, 0);
  scene.gravity = {0, -g, 0};
  scene.bodies[1].position.y() += 1e-3 * static_cast<double>(request.seed);
  Simulation sim(scene, with(request));
  sim.step();                                                               // so that energies belong to whole steps
  const double floor = mass * g * .1, start = sim.energy().total() - floor; // J, of a ball that touches
  double sum = 0, worst = 0;
  int bounces = 0;
  std::int64_t steps = 0;
  bool touching = false;
  for (constexpr std::int64_t limit = 10'000'000; bounces < request.value && steps < limit; ++steps) {
    sim.step();
    const bool now = !sim.contacts().empty();
    if (touching && !now) {
      const double error = (sim.energy().total() - floor) / start - 1;
      ++bounces;
      sum += error * error, worst = std::max(worst, std::abs(error));
    }
    touching = now;
    if (sim.particles().position[1].y() < 0) break; // through the floor
  }
  const bool lost = bounces < request.value;
  return {{"rms_energy_error", lost ? std::nan("") : std::sqrt(sum / std::max(1, bounces)), {}},
          {"worst_energy_error", lost ? std::nan("") : worst, {}},
          {"bounces", static_cast<double>(bounces), {}},
          {"steps_per_bounce", static_cast<double>(steps) / std::max(1, bounces), {}}};
}

} // namespace trigrain
