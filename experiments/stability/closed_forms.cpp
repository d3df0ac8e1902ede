#include "experiments/stability/closed_forms.hpp"
#include "dem/hertz.hpp"
#include "dem/motion.hpp"
#include "experiments/stability/setups.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace trigrain {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

/// A frictionless elastic drop of `body` at speed 1 onto a rigid plane, so stiff that it turns by about 1e-4
/// (rad) while it touches, less with more stiffness. The body starts just above.
Particles after_impact(Body body, double mass, double turn_rate, const StudyRequest& request) {
  const double turn = 1e-4 / std::sqrt(request.stiffness);
  const double contact_time = turn / turn_rate, k = mass * pi * pi / (contact_time * contact_time);
  const double halo = 20 * contact_time;
  Scene scene = empty_scene(100, {.stiffness = k, .damping_ratio = 0, .friction = 0},
                            contact_time / 4 / request.steps_per_contact);
  Body floor = floor_body(20, halo);
  floor.position.y() -= halo;
  body.position = {0, .1 * contact_time - lowest_point(body), 0};
  body.velocity = {0, -1, 0};
  scene.bodies = {floor, body};
  Simulation sim(scene, with(request));
  bool touched = false;
  while (!touched || !sim.contacts().empty()) {
    sim.step();
    touched |= !sim.contacts().empty();
    if (sim.time() > 20 * contact_time) break;
  }
  return sim.particles();
}

} // namespace

std::vector<Metric> free_top(const StudyRequest& request) {
  const bool first = request.value < 1.5;
  const double period = first ? 48.6898507741311 : 46.8378189936559;
  Scene scene = empty_scene(100, {}, period / 20000.3);
  Body top = mesh_body(box({3, 2, 1}), 6, {0, 0, 0}, 0); // I = 2.5, 5, 6.5 about its own x, y, z
  top.angular_velocity = first ? Vector3d(.01, 1, 0) : Vector3d(0, 1, .01);
  scene.time.force = true;
  scene.bodies = {top};
  Simulation sim(scene, {});
  const double energy = sim.energy().kinetic;
  const Vector3d momentum = sim.particles().angular_momentum[0];
  double last = 1, began = -1, found = 0, energy_error = 0, momentum_error = 0, turn_error = 0;
  for (int crossings = 0; crossings < 5;) {
    sim.step();
    const Particles& p = sim.particles();
    const Body now = p.body(0);
    const double middle = (now.orientation.conjugate() * now.angular_velocity).y();
    if (last < 0 && middle >= 0) {
      const double when = sim.time() - scene.time.step * middle / (middle - last);
      if (began < 0)
        began = when;
      else
        found = (when - began) / ++crossings;
    }
    last = middle;
    energy_error = std::max(energy_error, std::abs(kinetic_energy(p) / energy - 1));
    momentum_error = std::max(momentum_error, (p.angular_momentum[0] - momentum).norm() / momentum.norm());
    const Eigen::Matrix3d r = p.orientation[0].toRotationMatrix();
    turn_error = std::max(turn_error, (r.transpose() * r - Eigen::Matrix3d::Identity()).norm());
    if (sim.time() > 10 * period) break;
  }
  return {{"period_error", found / period - 1, 1e-5},
          {"energy_error", energy_error, 1e-6},
          {"momentum_error", momentum_error, 1e-12},
          {"orthogonality_error", turn_error, 1e-10}};
}

std::vector<Metric> rigid_impact(const StudyRequest& request) {
  const double theta = request.value * pi / 180, lever = std::sin(pi / 4 - theta);
  Body cube = mesh_body(box({1, 1, 1}), 1, {0, 0, 0}, 0);
  cube.orientation = Eigen::AngleAxisd(theta, Vector3d::UnitZ());
  const double spin = 12 * lever / std::sqrt(2.) / (1 + 3 * lever * lever);
  const Particles p = after_impact(cube, 1, std::max(.1, spin), request);
  return {{"velocity_error", p.velocity[1].y() - (-1 + 2 / (1 + 3 * lever * lever)), 1e-3},
          {"spin_error", std::abs(p.angular_velocity(1).z()) - spin, 2.5e-3}};
}

std::vector<Metric> ellipsoid_impact(const StudyRequest& request) {
  const double tau = request.value * pi / 180;
  const Mesh ball = icosphere(1, std::max(0, request.level));
  std::vector<Vector3d> vertices;
  const Eigen::Quaterniond skew(Eigen::AngleAxisd(.4, Vector3d(1, 2, 3).normalized())); // no vertex by accident below
  for (const Vector3d& x : ball.vertices) vertices.push_back((skew * x).cwiseProduct(Vector3d(1, 2, 1)));
  Body body = mesh_body(make_mesh("ellipsoid", vertices, ball.faces), 1, {0, 0, 0}, 0);
  body.orientation = Eigen::AngleAxisd(tau, Vector3d::UnitZ());
  // Support point of the long half axis 2 along (-sin tau, cos tau): lever of the normal about the centre.
  const double height = std::sqrt(4 * std::cos(tau) * std::cos(tau) + std::sin(tau) * std::sin(tau));
  const double lever = 3 * std::sin(tau) * std::cos(tau) / height, inertia = (1. + 4.) / 5;
  const double impulse = 2 / (1 + lever * lever / inertia), spin = lever * impulse / inertia;
  const Particles p = after_impact(body, 1, std::max(.1, spin), request);
  return {{"velocity_error", p.velocity[1].y() - (impulse - 1), {}},
          {"spin_error", p.angular_velocity(1).norm() - spin, {}},
          {"triangles", static_cast<double>(ball.faces.size()), {}}};
}

std::vector<Metric> mesh_sphere(const StudyRequest& request) {
  const Mesh mesh = icosphere(1, std::max(0, request.level));
  const double triangles = static_cast<double>(mesh.faces.size());
  double gap = 0;
  for (const auto& f : mesh.faces)
    gap = std::max(gap, 1 - (mesh.vertices[f[0]] + mesh.vertices[f[1]] + mesh.vertices[f[2]]).norm() / 3);
  const double volume = 1 - mesh.volume / (4. / 3. * pi), inertia = 1 - mesh.inertia.mean() / (8. / 15. * pi);
  double spin = 0, tilt = 0;
  constexpr int drops = 12;
  for (int i = 0; i < drops; ++i) {
    Body body = mesh_body(mesh, 1, {0, 0, 0}, 0);
    body.orientation =
        Eigen::AngleAxisd(1.3 * i + .2, Vector3d(std::sin(2.1 * i + 1), std::cos(1.7 * i), .5).normalized());
    const Particles p = after_impact(body, 1, 1, request);
    const double turning = p.angular_velocity(1).dot(p.angular_momentum[1]) / 2;
    spin += 2 * turning / drops;
    tilt += std::sqrt(2 * turning / 10) / drops; // a normal that misses the centre by a sine s: 10 s^2 of the energy
  }
  return {{"triangles", triangles, {}},
          {"gap_times_triangles", gap * triangles, {}},
          {"volume_error_times_triangles", volume * triangles, {}},
          {"inertia_error_times_triangles", inertia * triangles, {}},
          {"spurious_spin_times_triangles", spin * triangles, {}},
          {"normal_tilt_times_root_of_triangles", tilt * std::sqrt(triangles), {}},
          {"spurious_spin", spin, {}}};
}

std::vector<Metric> bounce(const StudyRequest& request) {
  const double height = .1, mass = 1, k = 1e9 * request.stiffness, e = request.value;
  const double contact_time = pi * std::sqrt(mass / k);
  Scene scene = empty_scene(4, {.stiffness = k, .damping_ratio = damping_ratio_for("spring-dashpot", e), .friction = 0},
                            contact_time / request.steps_per_contact);
  scene.gravity = {0, -g, 0};
  Body floor = floor_body(1, 2e-3);
  floor.position.y() -= 2e-3;
  scene.bodies = {floor, sphere_body(.05, mass, {0, .05 + height, 0}, 0)};
  Simulation sim(scene, {});
  double rest = 0; // when the ball was last apart from the floor
  const double expected = std::sqrt(2 * height / g) * (1 + e) / (1 - e);
  while (sim.time() < 1.2 * expected) {
    sim.step();
    if (sim.contacts().empty()) rest = sim.time();
  }
  return {{"time_to_rest_error", rest / expected - 1, 1.5e-2},
          {"energy_drift", (sim.energy().balance() - scene.bodies[1].position.y() * g) / g / height, 1e-2}};
}

std::vector<Metric> similarity(const StudyRequest& request) {
  const auto scene_of = [&](double scale) {
    Scene scene = empty_scene(4 * scale, {.stiffness = 1e6 * scale * scale, .damping_ratio = .3, .friction = .4},
                              2e-5 * std::sqrt(scale));
    scene.gravity = {0, -g, 0};
    scene.bodies = {floor_body(scale, 1e-3 * scale)};
    for (int i = 0; i < 3; ++i) {
      Body cube = mesh_body(box({.1 * scale, .08 * scale, .12 * scale}), std::pow(scale, 3),
                            Vector3d(.02 * i, .08 + .13 * i, .01 * i) * scale, 1e-3 * scale);
      cube.orientation = Eigen::AngleAxisd(.5 + i, Vector3d(1, .2 * i, .4).normalized());
      scene.bodies.push_back(cube);
    }
    return scene;
  };
  Simulation one(scene_of(1), with(request)), other(scene_of(request.value), with(request));
  one.run(15000), other.run(15000);
  double error = 0;
  for (int i = 0; i < one.particles().size(); ++i) {
    error = std::max(error, (other.particles().position[i] / request.value - one.particles().position[i]).norm());
    error =
        std::max(error, (other.particles().orientation[i].coeffs() - one.particles().orientation[i].coeffs()).norm());
  }
  return {{"trajectory_difference", error, 0}, {"contacts", static_cast<double>(one.contacts().size()), {}}};
}

} // namespace trigrain
