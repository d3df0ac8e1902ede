#include "experiments/stability/discharge.hpp"
#include "dem/critical_step.hpp"
#include "dem/random.hpp"
#include "experiments/stability/setups.hpp"
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
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

/// So stiff that two grains that meet at 2 m/s stop within their halos; the step resolves that. Granulates hold each
/// other at several points at once: the limit of their contacts falls to .85 of a tenth of a half period.
void choose_stiffness(Scene& scene, double factor, const MeanGrain& mean, bool spheres) {
  const double effective = mean.mass / 2, rate = 2 / (2 * halo);
  scene.contact.stiffness = factor * effective * rate * rate;
  const double half_period = std::numbers::pi * std::sqrt(effective / scene.contact.stiffness);
  scene.time.step = std::min(half_period / (spheres ? 10 : 14), .9 * critical_step(scene));
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

/// Slope of the least squares line through points (t, m).
struct Line {
  double n = 0, t = 0, m = 0, tt = 0, tm = 0;
  void add(double time, double mass) { ++n, t += time, m += mass, tt += time * time, tm += time * mass; }
  double slope() const { return (n * tm - t * m) / (n * tt - t * t); }
};

/// A bin whose plate is taken away once its grains have come to rest, and what leaves it. It is so narrow that the
/// grains stand higher over the opening than that is wide, by a fifth or about that for the widest; then how high they
/// stand does not matter (Nedderman 1992).
class OpenBin {
 public:
  explicit OpenBin(const StudyRequest& request)
      : random_(request.seed), grains_(make_grains(request, random_)), mean_(mean_of(grains_)),
        opening_(request.value * mean_.diameter), width_(1.1 * mean_.diameter * std::cbrt(request.particles)),
        sim_(at_rest(request), options(request)), start_(sim_.energy().balance()), out_(grains_.size()) {}

  void step();
  /// Pours grains that have fallen out on the others, where these stand low.
  void refill();
  /// Grains that have left over all.
  double turned_over() const { return static_cast<double>(passed_) / static_cast<double>(out_.size()); }
  bool stands() const { return sim_.time() > last_ + 1; } ///< an arch that stands for a second stands
  void add_to(Line& line) const { line.add(sim_.time(), mass_); }
  double level() const;                  ///< how high a column of the grains over the opening stands, over its width
  std::vector<Metric> soundness() const; ///< what every study says of the run and the grains

 private:
  /// Flowing grains move past each other fast: what is near them is kept for about ten steps.
  static Options options(const StudyRequest& request) { return {.contact_rule = request.contact_rule, .skin = .1}; }
  Scene at_rest(const StudyRequest& request);
  const Vector3d& position(std::size_t grain) const { return sim_.particles().position[walls + grain]; }
  Vector3d place_on_top(); ///< the lowest of some places on others

  Random random_;
  std::vector<Body> grains_; // as they were filled in
  MeanGrain mean_;
  double opening_, width_; // m
  Simulation sim_;
  double start_;          // energy, J
  std::vector<char> out_; // has it left?
  int passed_ = 0;
  double mass_ = 0, last_ = 0, deepest_ = 0; // of what has left, kg; when the last one did, s; overlap, m
  StepStats stats_;
};

Scene OpenBin::at_rest(const StudyRequest& request) {
  Scene scene = empty_scene(256, {.damping_ratio = .3, .friction = .5}, 1);
  scene.domain.min.y() = 1 - scene.domain.size;
  scene.gravity = {0, -g, 0};
  fill(grains_, width_, opening_, random_);
  scene.bodies = walls_of_bin(width_, opening_);
  scene.bodies.insert(scene.bodies.end(), grains_.begin(), grains_.end());
  choose_stiffness(scene, request.stiffness, mean_, request.vertices == 0);
  Simulation settling(scene, options(request));
  while (settling.time() < .2) settling.step();
  for (int i = 0; i < settling.particles().size(); ++i)
    if (!scene.bodies[i].fixed) scene.bodies[i] = settling.particles().body(i);
  scene.bodies.erase(scene.bodies.begin());
  return scene;
}

void OpenBin::step() {
  stats_ += sim_.step();
  for (const Contact& c : sim_.contacts()) deepest_ = std::max(deepest_, c.overlap);
  for (std::size_t i = 0; i < out_.size(); ++i)
    if (!out_[i] && position(i).y() < 0)
      out_[i] = 1, ++passed_, mass_ += sim_.particles().mass[walls + i], last_ = sim_.time();
}

void OpenBin::refill() {
  constexpr double poured = .6; // m/s, so fast that the next ones find room
  std::vector<char> touches;
  for (std::size_t i = 0; i < out_.size(); ++i) {
    if (!out_[i] || position(i).y() > -diameter) continue;
    if (touches.empty()) {
      touches.resize(sim_.particles().size());
      for (const Contact& c : sim_.contacts()) touches[c.a] = touches[c.b] = 1;
    }
    if (touches[walls + i]) continue;
    sim_.put(static_cast<int>(walls + i), place_on_top(), {0, -poured, 0});
    out_[i] = 0;
  }
}

Vector3d OpenBin::place_on_top() {
  constexpr int tries = 10;
  constexpr double free = 1.05 * diameter; // between centres
  const double room = width_ - 1.4 * diameter;
  Vector3d lowest{0, std::numeric_limits<double>::infinity(), 0};
  for (int k = 0; k < tries; ++k) {
    Vector3d top{room * (random_.uniform() - .5), width_ / 2, room * (random_.uniform() - .5)};
    for (std::size_t i = 0; i < out_.size(); ++i) {
      const Vector3d& x = position(i);
      const double away2 = std::pow(x.x() - top.x(), 2) + std::pow(x.z() - top.z(), 2);
      if (away2 < free * free) top.y() = std::max(top.y(), x.y() + std::sqrt(free * free - away2));
    }
    if (top.y() < lowest.y()) lowest = top;
  }
  return lowest;
}

double OpenBin::level() const {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < out_.size(); ++i) {
    const Vector3d& x = position(i);
    if (!out_[i] && std::max(std::abs(x.x()), std::abs(x.z())) < opening_ / 2) sum += x.y(), ++count;
  }
  return count > 0 ? 2 * sum / count / opening_ : 0; // twice the height of the centre
}

std::vector<Metric> OpenBin::soundness() const {
  const double weight = static_cast<double>(out_.size()) * mean_.mass * g;
  return {{"turned_over", turned_over(), {}},
          {"deepest_overlap_of_diameter", deepest_ / mean_.diameter, {}},
          {"fast_contacts", static_cast<double>(stats_.fast_contacts + stats_.crossings), 0},
          {"unstable_steps", static_cast<double>(stats_.unstable_steps), 0},
          {"grain_mass_kg", mean_.mass, {}},
          {"grain_diameter_m", mean_.diameter, {}},
          {"energy_drift", (sim_.energy().balance() - start_) / (weight * width_), 1e-2}};
}

constexpr double start_up = .2; // grains, of all, that leave before the flow is judged

} // namespace

std::vector<Metric> discharge(const StudyRequest& request) {
  constexpr double middle = start_up + .25, end = start_up + .5;
  OpenBin bin(request);
  Line all, first, second; // while half of the grains leave, and the halves of that
  double levels = 0;
  while (bin.turned_over() < end && !bin.stands()) {
    bin.step();
    bin.refill();
    if (bin.turned_over() < start_up) continue;
    bin.add_to(all);
    bin.add_to(bin.turned_over() < middle ? first : second);
    levels += bin.level();
  }
  const bool flowed = bin.turned_over() >= end;
  const double none = std::numeric_limits<double>::quiet_NaN();
  std::vector<Metric> metrics{{"rate_kg_s", flowed ? all.slope() : none, {}},
                              {"rate_change", flowed ? second.slope() / first.slope() - 1 : none, {}},
                              {"level_of_opening", levels / all.n, {}}};
  std::ranges::copy(bin.soundness(), std::back_inserter(metrics));
  return metrics;
}

std::vector<Metric> emptying(const StudyRequest& request) {
  constexpr int tenths = 8;
  OpenBin bin(request);
  while (bin.turned_over() < start_up && !bin.stands()) {
    bin.step();
    bin.refill();
  }
  std::array<Line, tenths> lines;
  std::array<double, tenths> levels{};
  const auto tenth = [&] { return static_cast<int>(10 * (bin.turned_over() - start_up)); };
  while (tenth() < tenths && !bin.stands()) {
    bin.add_to(lines[tenth()]);
    levels[tenth()] += bin.level();
    bin.step();
  }
  std::vector<Metric> metrics;
  for (int i = 0; i < tenths; ++i) {
    const std::string left = std::to_string(95 - 10 * i);
    metrics.push_back(
        {"rate_kg_s_" + left, i < tenth() ? lines[i].slope() : std::numeric_limits<double>::quiet_NaN(), {}});
    metrics.push_back({"level_of_opening_" + left, levels[i] / lines[i].n, {}});
  }
  std::ranges::copy(bin.soundness(), std::back_inserter(metrics));
  return metrics;
}

} // namespace trigrain
