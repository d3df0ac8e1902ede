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
std::vector<Body> make_grains(const StudyRequest& request, Random& random) {
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

/// What the grains are on average: diameter (m) of a ball of equal volume, with halo, and mass (kg).
struct MeanGrain {
  double diameter, mass;
};
MeanGrain mean_of(const std::vector<Body>& grains) {
  double volume = 0, mass = 0;
  for (const Body& b : grains) {
    const double own = b.mesh ? b.mesh->volume : 4. / 3. * std::numbers::pi * std::pow(b.sphere_radius, 3);
    volume += own / grains.size(), mass += b.density * own / grains.size();
  }
  return {std::cbrt(6 * volume / std::numbers::pi) + 2 * halo, mass};
}

/// So stiff that two grains that meet at 2 m/s stop within their halos, more than any have here; the step resolves
/// that.
void choose_stiffness(Scene& scene, double factor, double grain_mass) {
  const double effective = grain_mass / 2, rate = 2 / (2 * halo);
  scene.contact.stiffness = factor * effective * rate * rate;
  scene.time.step =
      std::min(std::numbers::pi / 10 * std::sqrt(effective / scene.contact.stiffness), .9 * critical_step(scene));
}

/// Funnel of 45 degrees with its lower end at y = 0, on it a bin as wide for all openings; a plate closes the opening.
/// The domain reaches far down, so that what has left falls on through empty cells.
std::vector<Body> walls_of_bin(double width, double opening) {
  const double height = (width - opening) / 2, tall = 3 * width;
  std::vector<Body> all{fixed(box({3 * opening, wall, 3 * opening}), {0, -wall / 2 - 2 * halo, 0}),
                        fixed(hopper(width, height, opening, wall / 2), {0, height / 2, 0})};
  for (const double side : {-1., 1.}) {
    const double away = side * (width + wall) / 2;
    all.push_back(fixed(box({wall, tall, width + 4 * wall}), {away, height + tall / 2 + 3 * halo, 0}));
    all.push_back(fixed(box({width, tall, wall}), {0, height + tall / 2 + 3 * halo, away}));
  }
  return all;
}

/// Places grains on a lattice that fills the funnel too, so that none falls far or fast before it rests.
void fill(std::vector<Body>& grains, double width, double opening, Random& random) {
  constexpr double spacing = 1.06 * diameter, margin = .3 * diameter, jitter = .06 * diameter;
  std::size_t first = 0, layer = 0;
  for (double y = .6 * diameter; first < grains.size(); first += layer, y += spacing) {
    const double room = std::min(width, opening + 2 * y) - 2 * margin;
    const int row = static_cast<int>(room / spacing);
    const auto place = [&](std::size_t k) { return ((k + .5) / row - .5) * room + jitter * (random.uniform() - .5); };
    layer = std::min<std::size_t>(row * row, grains.size() - first);
    for (std::size_t i = 0; i < layer; ++i) {
      Body& grain = grains[first + i];
      const double x = place(i % row), z = place(i / row);
      grain.position = {x, y, z};
      if (grain.mesh) grain.position -= grain.orientation * grain.mesh->origin;
    }
  }
}

/// A bin whose grains have come to rest, without the plate that held them.
Scene opened_bin(std::vector<Body> grains, double width, double opening, const StudyRequest& request, Random& random,
                 const Options& options) {
  Scene scene = empty_scene(256, {.damping_ratio = .3, .friction = .5}, 1);
  scene.domain.min.y() = 1 - scene.domain.size;
  scene.gravity = {0, -g, 0};
  fill(grains, width, opening, random);
  scene.bodies = walls_of_bin(width, opening);
  scene.bodies.insert(scene.bodies.end(), grains.begin(), grains.end());
  choose_stiffness(scene, request.stiffness, mean_of(grains).mass);
  Simulation settling(scene, options);
  while (settling.time() < .25) settling.step();
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
  Random random(request.seed);
  const std::vector<Body> grains = make_grains(request, random);
  const MeanGrain mean = mean_of(grains);
  const double opening = request.value * mean.diameter, width = 1.2 * mean.diameter * std::cbrt(request.particles);
  const Options options{.contact_rule = request.contact_rule, .skin = .1};
  Simulation sim(opened_bin(grains, width, opening, request, random, options), options);
  const double start = sim.energy().balance();
  const int n = sim.particles().size() - walls;
  std::vector<char> out(n);
  int through = 0;
  double mass = 0, last_out = 0, deepest = 0;
  Line all, first, second; // from 20 to 70 % emptied, and the halves of it
  StepStats stats;
  while (through < .7 * n && sim.time() < last_out + 1) { // an arch that stands for a second stands
    stats += sim.step();
    for (const Contact& c : sim.contacts()) deepest = std::max(deepest, c.overlap);
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
          {"rate_grains_s", emptied ? rate / mean.mass : none, {}},
          {"rate_change", emptied ? second.slope() / first.slope() - 1 : none, {}},
          {"emptied", static_cast<double>(through) / n, {}},
          {"deepest_overlap_of_diameter", deepest / mean.diameter, {}},
          {"fast_contacts", static_cast<double>(stats.fast_contacts + stats.crossings), 0},
          {"unstable_steps", static_cast<double>(stats.unstable_steps), 0},
          {"grain_mass_kg", mean.mass, {}},
          {"grain_diameter_m", mean.diameter, {}},
          {"energy_drift", (sim.energy().balance() - start) / (n * mean.mass * g * width), 1e-2}};
}

} // namespace trigrain
