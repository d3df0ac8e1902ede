#include "experiments/stability/discharge.hpp"
#include "dem/critical_step.hpp"
#include "dem/random.hpp"
#include "experiments/stability/setups.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace trigrain {
namespace {

using Eigen::Vector3d;

constexpr double diameter = .01, halo = .05 * diameter / 2, wall = .01; // m
constexpr int walls = 5;                                                // fixed bodies of an open bin

Body fixed(Mesh mesh, const Vector3d& position) {
  Body body;
  body.mesh = std::make_shared<Mesh>(std::move(mesh));
  body.position = position;
  body.halo = halo;
  body.fixed = true;
  return body;
}

/// Balls, or granulates of some shapes turned at random.
std::vector<Body> grains(const StudyRequest& request, Random& random) {
  constexpr int shapes = 24;
  std::vector<std::shared_ptr<const Mesh>> meshes;
  for (int i = 0; request.vertices > 0 && i < shapes; ++i)
    meshes.push_back(std::make_shared<Mesh>(granulate(diameter - 2 * halo, request.vertices, random.bits())));
  std::vector<Body> all(request.particles);
  for (int i = 0; i < request.particles; ++i) {
    all[i].sphere_radius = diameter / 2 - halo;
    all[i].halo = halo;
    if (meshes.empty()) continue;
    all[i].mesh = meshes[i % shapes];
    all[i].orientation = random.rotation();
  }
  return all;
}

/// So stiff that grains as fast as 2 m/s stop within their halos, more than any has here; the step resolves that.
void choose_stiffness(Scene& scene, double factor) {
  double mass = 0, most = 0;
  for (const Body& b : scene.bodies)
    if (!b.fixed) {
      const double volume = b.mesh ? b.mesh->volume : 4. / 3. * std::numbers::pi * std::pow(b.sphere_radius, 3);
      mass += b.density * volume, ++most;
    }
  const double effective = mass / most / 2, rate = 2 / (2 * halo);
  scene.contact.stiffness = factor * effective * rate * rate;
  scene.time.step =
      std::min(std::numbers::pi / 15 * std::sqrt(effective / scene.contact.stiffness), .8 * critical_step(scene));
}

/// Funnel of 45 degrees with its lower end at y = 0 and a bin of that width on it; a plate closes the opening. The
/// domain reaches far down, so that what has left falls on through empty cells.
Scene closed_bin(const StudyRequest& request, double width, double opening) {
  const double height = (width - opening) / 2, tall = 2 * width;
  Scene scene = empty_scene(256, {.damping_ratio = .3, .friction = .5}, 1);
  scene.domain.min.y() = 1 - scene.domain.size;
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
  const double spacing = (width - .4 * diameter) / row;
  int i = 0;
  for (Body grain : grains(request, random)) {
    const auto place = [&](int k) { return (k - (row - 1) / 2.) * spacing + .1 * diameter * (random.uniform() - .5); };
    const double x = place(i % row), z = place(i / row % row);
    grain.position = {x, height + diameter + 1.12 * diameter * (i / (row * row)), z};
    if (grain.mesh) grain.position -= grain.orientation * grain.mesh->origin;
    scene.bodies.push_back(grain);
    ++i;
  }
  choose_stiffness(scene, request.stiffness);
  return scene;
}

/// The same after the grains have come to rest, without the plate.
Scene opened_bin(Scene scene, const Options& options) {
  Simulation settling(scene, options);
  while (settling.time() < .4) settling.step();
  for (int i = 0; i < settling.particles().size(); ++i)
    if (!scene.bodies[i].fixed) scene.bodies[i] = settling.particles().body(i);
  scene.bodies.erase(scene.bodies.begin());
  return scene;
}

/// Slope of the least squares line through points (t, m).
struct Line {
  double n = 0, t = 0, m = 0, tt = 0, tm = 0;
  void add(double time, double mass) { ++n, t += time, m += mass, tt += time * time, tm += time * mass; }
  double slope() const { return (n * tm - t * m) / (n * tt - t * t); }
};

} // namespace

std::vector<Metric> discharge(const StudyRequest& request) {
  // As wide for all openings, and as deep as wide if the grains are many.
  const double opening = request.value * diameter, width = 1.2 * diameter * std::cbrt(request.particles);
  const Options options{.contact_rule = request.contact_rule, .skin = .05};
  const Scene scene = opened_bin(closed_bin(request, width, opening), options);
  Simulation sim(scene, options);
  const double start = sim.energy().balance();
  const int n = sim.particles().size() - walls;
  std::vector<char> out(n);
  int through = 0;
  double mass = 0, total = 0, last_out = 0;
  for (int i = 0; i < n; ++i) total += sim.particles().mass[walls + i];
  Line all, first, second; // from 20 to 70 % emptied, and the halves of it
  StepStats stats;
  while (through < .7 * n && sim.time() < last_out + 1) { // an arch that stands for a second stands
    stats += sim.step();
    for (int i = 0; i < n; ++i)
      if (!out[i] && sim.particles().position[walls + i].y() < 0)
        out[i] = 1, ++through, mass += sim.particles().mass[walls + i], last_out = sim.time();
    if (through < .2 * n) continue;
    all.add(sim.time(), mass);
    (through < .45 * n ? first : second).add(sim.time(), mass);
  }
  const bool emptied = through >= .7 * n;
  const double none = std::numeric_limits<double>::quiet_NaN(), rate = all.slope();
  return {{"rate_kg_s", emptied ? rate : none, {}},
          {"rate_grains_s", emptied ? rate * n / total : none, {}},
          {"rate_change", emptied ? second.slope() / first.slope() - 1 : none, {}},
          {"emptied", static_cast<double>(through) / n, {}},
          {"fast_contacts", static_cast<double>(stats.fast_contacts + stats.crossings), 0},
          {"grain_mass_kg", total / n, {}},
          {"energy_drift", (sim.energy().balance() - start) / (total * g * width), 1e-2}};
}

} // namespace trigrain
