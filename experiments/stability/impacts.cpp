#include "experiments/stability/impacts.hpp"
#include "dem/hertz.hpp"
#include "dem/random.hpp"
#include "experiments/stability/setups.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace trigrain {
namespace {

using Eigen::Vector3d;

/// A ball of an elastic material that meets a rigid plane, or its mirror image.
struct Setup {
  double radius, density, youngs_modulus, poisson_ratio; // m, kg/m3, Pa
  double restitution, friction;
  Vector3d velocity, spin;   // m/s, rad/s; the plane is y = 0
  bool two_balls = false;    // the partner comes from below with the opposite velocity and spin
  double partner_radius = 0; // m, of a fixed ball instead of the plane
};

/// What came of it. Peaks from a parabola through the three largest samples.
struct Outcome {
  double force, overlap, contact_time; // N, m, s
  Vector3d velocity, spin;
};

/// Hertz: an elastic impact at speed v along the normal.
struct Hertz {
  double overlap, force, contact_time;
};
Hertz hertz(const Setup& s, double mass) {
  const ContactParameters law{.youngs_modulus = s.youngs_modulus, .poisson_ratio = s.poisson_ratio};
  const double infinity = std::numeric_limits<double>::infinity(), v = std::abs(s.velocity.y());
  const double partner = s.two_balls ? s.radius : s.partner_radius > 0 ? s.partner_radius : infinity;
  const double k = hertz_pair(law, s.radius, partner, !s.two_balls).k;
  const double m = s.two_balls ? mass / 2 : mass, speed = s.two_balls ? 2 * v : v;
  const double overlap = std::pow(5 * m * speed * speed / (4 * k), .4);
  return {overlap, k * overlap * std::sqrt(overlap), 2.943275 * overlap / speed};
}

/// Largest value of three equidistant samples' parabola.
double peak(double a, double b, double c) {
  const double bend = a - 2 * b + c;
  return bend < 0 ? b - (c - a) * (c - a) / (8 * bend) : b;
}

Outcome run(const Setup& s, const StudyRequest& request) {
  const double mass = s.density * 4. / 3. * std::numbers::pi * std::pow(s.radius, 3);
  const Hertz expected = hertz(s, mass);
  const double halo = 1.02 * expected.overlap; // all of it on one side, so that the ball keeps radius and inertia
  Scene scene = empty_scene(20 * s.radius + 10 * s.partner_radius,
                            {.law = "hertz-mindlin",
                             .damping_ratio = damping_ratio_for("hertz-mindlin", s.restitution),
                             .friction = s.friction,
                             .youngs_modulus = s.youngs_modulus,
                             .poisson_ratio = s.poisson_ratio},
                            expected.contact_time / request.steps_per_contact);
  const double above = s.radius * (1 + 1e-9), share = s.two_balls ? halo / 2 : 0;
  Body ball = request.level < 0 ? sphere_body(s.radius - share, mass, {0, above, 0}, share)
                                : mesh_body(icosphere(s.radius - share, request.level), mass, {0, above, 0}, share);
  Random random(request.seed);
  ball.orientation = random.rotation();
  ball.velocity = s.velocity, ball.angular_velocity = s.spin;
  Body partner = ball;
  if (s.two_balls) {
    partner.position = -ball.position, partner.velocity = -ball.velocity,
    partner.angular_velocity = -ball.angular_velocity, partner.orientation = random.rotation();
  } else if (s.partner_radius > 0) {
    partner = sphere_body(s.partner_radius - halo, 1, {0, -s.partner_radius, 0}, halo);
    partner.fixed = true;
  } else {
    partner = floor_body(8 * s.radius, halo);
    partner.position.y() -= halo;
  }
  scene.bodies = {partner, ball};
  Simulation sim(scene, {.precheck = "octree"});
  Outcome found{};
  std::vector<double> forces{0}, overlaps{0};
  int touched = 0;
  while (touched == 0 || !sim.contacts().empty()) {
    sim.step();
    touched += !sim.contacts().empty();
    Vector3d force(0, 0, 0);
    double overlap = 0;
    for (const Contact& c : sim.contacts()) force += c.force, overlap = std::max(overlap, c.overlap);
    forces.push_back(force.norm());
    overlaps.push_back(overlap);
    if (sim.time() > 20 * expected.contact_time) break;
  }
  const auto highest = [](const std::vector<double>& x) {
    const auto i = std::max_element(x.begin(), x.end()) - x.begin();
    return i > 0 && i + 1 < std::ssize(x) ? peak(x[i - 1], x[i], x[i + 1]) : x[i];
  };
  found.force = highest(forces), found.overlap = highest(overlaps), found.contact_time = touched * scene.time.step;
  found.velocity = sim.particles().velocity[1], found.spin = sim.particles().angular_velocity(1);
  return found;
}

constexpr double sliding_bar = 1e-3;

/// Quantities beside their closed forms.
struct Findings {
  std::vector<Metric> metrics;
  /// The error is relative to `scale`, by default what is expected.
  void compare(const std::string& name, double found, double expected, double bar, double scale = 0) {
    metrics.push_back({name + "_error", (found - expected) / (scale != 0 ? scale : expected), bar});
    metrics.push_back({name, found, {}});
    metrics.push_back({name + "_theory", expected, {}});
  }
};

using Metrics = std::vector<Metric>;

Metrics elastic_peaks(const Setup& s, const StudyRequest& request) {
  const double mass = s.density * 4. / 3. * std::numbers::pi * std::pow(s.radius, 3);
  const Hertz expected = hertz(s, mass);
  const Outcome found = run(s, request);
  Findings all;
  all.compare("force_N", found.force, expected.force, 1e-4);
  all.compare("overlap_m", found.overlap, expected.overlap, 1e-4);
  all.compare("contact_time_s", found.contact_time, expected.contact_time, 1.1 / request.steps_per_contact);
  return all.metrics;
}

Metrics damped(Setup s, const StudyRequest& request) {
  Findings all;
  for (const double e : {.1, .3, .5, .7, .9, 1.}) {
    s.restitution = e;
    all.compare("restitution_at_" + std::to_string(static_cast<int>(100 * e + .5)) + "_percent",
                run(s, request).velocity.y() / 3.9, e, 1e-3, 1);
  }
  return all.metrics;
}

/// Oblique impacts at several angles; where the ball slides throughout, against the closed form.
Metrics oblique(Setup s, const StudyRequest& request) {
  Findings all;
  for (const int degrees : {30, 45, 60, 75}) {
    const double theta = degrees * std::numbers::pi / 180, impulse = s.friction * (1 + s.restitution);
    s.velocity = 3.9 * Vector3d(std::sin(theta), -std::cos(theta), 0);
    const Outcome found = run(s, request);
    const std::string at = "_at_" + std::to_string(degrees) + "_deg";
    all.compare("tangential_restitution" + at, found.velocity.x() / s.velocity.x(), 1 - impulse / std::tan(theta),
                sliding_bar, 1);
    all.compare("spin_rad_s" + at, found.spin.z(), -2.5 * impulse * 3.9 * std::cos(theta) / s.radius, sliding_bar);
  }
  return all.metrics;
}

/// Velocities in units of mu V_n.
Metrics tangential(Setup s, const StudyRequest& request) {
  Findings all;
  for (const int q : {7, 8, 10}) {
    const double unit = s.friction * 5;
    s.velocity = {q * unit, -5, 0};
    const Outcome found = run(s, request);
    const std::string at = "_at_" + std::to_string(q);
    all.compare("surface_velocity" + at, (found.velocity.x() + s.radius * found.spin.z()) / unit, q - 7, sliding_bar,
                std::max(1, q - 7));
    all.compare("surface_spin" + at, s.radius * found.spin.z() / unit, -5, sliding_bar);
  }
  return all.metrics;
}

/// A spinning ball that slides throughout: -v_s' / (R w0) = s - 1.
Metrics spinning(Setup s, const StudyRequest& request) {
  Findings all;
  for (const double slip : {.2, .5, .8}) {
    const double spin = 3.5 * s.friction * (1 + s.restitution) * .2 / (s.radius * slip);
    s.velocity = {0, -.2, 0}, s.spin = {0, 0, spin};
    const Outcome found = run(s, request);
    all.compare("surface_velocity_at_" + std::to_string(static_cast<int>(100 * slip + .5)) + "_percent",
                (found.velocity.x() + s.radius * found.spin.z()) / (s.radius * spin), 1 - slip, sliding_bar, 1);
  }
  return all.metrics;
}

Metrics no_slip(const Setup& s, const StudyRequest& request) {
  const Outcome found = run(s, request);
  Findings all;
  all.compare("tangential_velocity", std::hypot(found.velocity.x(), found.velocity.z()) / .2, 0, 1e-12, 1);
  all.compare("spin_rad_s", found.spin.z(), s.spin.z(), 1e-12);
  all.compare("restitution", found.velocity.y() / .2, s.restitution, 1e-3, 1);
  return all.metrics;
}

Metrics impact_of(const StudyRequest& request) {
  const Setup alumina{.0025, 4000, 380e9, .23, .98, .092, {0, -3.9, 0}, {0, 0, 0}};
  const Setup aluminium{.1, 2699, 70e9, .30, .5, .4, {0, -.2, 0}, {0, 0, 0}};
  Setup s = aluminium;
  switch (static_cast<int>(request.value)) {
  case 1:
    return elastic_peaks({.01, 2800, 48e9, .20, 1, 0, {0, -10, 0}, {0, 0, 0}, true}, request);
  case 2:
    s.restitution = 1, s.friction = 0;
    return elastic_peaks(s, request);
  case 3:
    s = alumina, s.friction = 0;
    return damped(s, request);
  case 4:
    return oblique(alumina, request);
  case 5:
    return tangential({1e-5, 7850, 208e9, .30, 1, .3, {0, -5, 0}, {0, 0, 0}}, request);
  case 6:
    return spinning(s, request);
  case 7:
    s.two_balls = true, s.spin = {0, 0, 3};
    return no_slip(s, request);
  case 8:
    s.partner_radius = .5;
    return spinning(s, request);
  default:
    throw InputError("no such test of Chung & Ooi (--value). Give 1 to 8.");
  }
}

/// A mesh touches with another part of its surface in every orientation: root mean square of the errors, mean of the
/// values. Bars are for true balls.
Metrics over_orientations(StudyRequest request) {
  constexpr int orientations = 16;
  Metrics all;
  for (int i = 0; i < orientations; ++i, ++request.seed) {
    const Metrics one = impact_of(request);
    if (all.empty())
      for (const Metric& m : one) all.push_back({m.name, 0, {}});
    for (std::size_t k = 0; k < one.size(); ++k)
      all[k].value += (one[k].bar ? one[k].value * one[k].value : one[k].value) / orientations;
    if (i + 1 < orientations) continue;
    for (std::size_t k = 0; k < one.size(); ++k)
      if (one[k].bar) all[k].value = std::sqrt(all[k].value);
  }
  all.push_back({"triangles", 20 * std::pow(4., request.level), {}});
  return all;
}

} // namespace

Metrics impact(const StudyRequest& request) {
  return request.level < 0 ? impact_of(request) : over_orientations(request);
}

} // namespace trigrain
