#include "experiments/stability/discharge.hpp"
#include "dem/random.hpp"
#include "experiments/stability/setups.hpp"
#include <cmath>

namespace trigrain {
namespace {

using Eigen::Vector3d;

constexpr double diameter = .01, g = 9.81, halo = .05 * diameter / 2, wall = .01; // m, m/s2

Body fixed(Mesh mesh, const Vector3d& position) {
  Body body;
  body.mesh = std::make_shared<Mesh>(std::move(mesh));
  body.position = position;
  body.halo = halo;
  body.fixed = true;
  return body;
}

/// Funnel with its lower end at y = 0 and a bin of that width on it; a plate closes the opening.
Scene closed_bin(const StudyRequest& request, double width, double opening) {
  const double height = (width - opening) / 2, tall = .5; // 45 degrees
  Scene scene = empty_scene(2, {.stiffness = 2e4, .damping_ratio = .3, .friction = .5}, 2.4e-5);
  scene.gravity = {0, -g, 0};
  scene.bodies.push_back(fixed(box({3 * opening, wall, 3 * opening}), {0, -wall / 2 - 2 * halo, 0}));
  scene.bodies.push_back(fixed(hopper(width, height, opening, wall / 2), {0, height / 2, 0}));
  for (const double side : {-1., 1.}) {
    const double away = side * (width + wall) / 2;
    scene.bodies.push_back(fixed(box({wall, tall, width + 4 * wall}), {away, height + tall / 2 + 3 * halo, 0}));
    scene.bodies.push_back(fixed(box({width, tall, wall}), {0, height + tall / 2 + 3 * halo, away}));
  }
  Random random(request.seed);
  const int row = static_cast<int>((width - .4 * diameter) / (1.12 * diameter));
  for (int i = 0; i < request.particles; ++i) {
    const double spacing = (width - .4 * diameter) / row;
    const auto place = [&](int k) { return (k - (row - 1) / 2.) * spacing + .1 * diameter * (random.uniform() - .5); };
    Body grain;
    if (request.vertices > 0)
      grain.mesh = std::make_shared<Mesh>(granulate(diameter - 2 * halo, request.vertices, request.seed * 100000 + i));
    else
      grain.sphere_radius = diameter / 2 - halo;
    grain.halo = halo;
    grain.position = {place(i % row), height + diameter + 1.12 * diameter * (i / (row * row)), place(i / row % row)};
    scene.bodies.push_back(grain);
  }
  return scene;
}

} // namespace

std::vector<Metric> discharge(const StudyRequest& request) {
  const double opening = request.value * diameter, width = 2.5 * opening;
  Scene scene = closed_bin(request, width, opening);
  {
    Simulation settling(scene, {.contact_rule = request.contact_rule});
    while (settling.time() < .4) settling.step();
    for (int i = 0; i < settling.particles().size(); ++i)
      if (!scene.bodies[i].fixed) scene.bodies[i] = settling.particles().body(i);
  }
  scene.bodies.erase(scene.bodies.begin());
  Simulation sim(scene, {.contact_rule = request.contact_rule});
  const int first = 5, n = sim.particles().size() - first;
  std::vector<char> out(n);
  int through = 0;
  double mass = 0, total = 0, sum_t = 0, sum_m = 0, sum_tt = 0, sum_tm = 0, samples = 0; // of a straight line
  for (int i = 0; i < n; ++i) total += sim.particles().mass[first + i];
  while (through < .7 * n && sim.time() < 5) {
    sim.step();
    for (int i = 0; i < n; ++i)
      if (!out[i] && sim.particles().position[first + i].y() < 0)
        out[i] = 1, ++through, mass += sim.particles().mass[first + i];
    if (through < .2 * n) continue;
    const double t = sim.time();
    ++samples, sum_t += t, sum_m += mass, sum_tt += t * t, sum_tm += t * mass;
  }
  const double rate = (samples * sum_tm - sum_t * sum_m) / (samples * sum_tt - sum_t * sum_t);
  return {
      {"rate_kg_s", through >= .7 * n ? rate : std::nan(""), {}},
      {"rate_grains_s", rate * n / total, {}},
      {"emptied", static_cast<double>(through) / n, {}},
      {"energy_drift", (sim.energy().balance() - Simulation(scene, {}).energy().balance()) / (total * g * width), {}}};
}

} // namespace trigrain
