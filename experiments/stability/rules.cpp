#include "experiments/stability/rules.hpp"
#include "experiments/stability/setups.hpp"
#include <algorithm>
#include <cmath>
#include <ctime>
#include <numbers>

namespace trigrain {
namespace {

using Eigen::Vector3d;

constexpr double edge = .1, mass = 1, halo = 1e-3, reach = 2 * halo; // of the cubes below: m, kg

/// A cube on a floor, both cut n x n; turned a little, so that no edges are parallel by accident.
Scene cube_on_floor(int cut, const ContactParameters& contact, double step) {
  Scene scene = empty_scene(2, contact, step);
  Body cube = mesh_body(box({edge, edge, edge}, cut), mass, {0, edge / 2 + reach, 0}, halo);
  cube.orientation = Eigen::AngleAxisd(.3, Vector3d::UnitY());
  scene.bodies = {floor_body(.8, halo, cut), cube};
  return scene;
}

/// The scene's step, or a fifth of what is stable for its first contacts under gravity if that is less.
double safe_step(Scene scene, const StudyRequest& request) {
  const double step = scene.time.step;
  scene.time.step = 1e-3 * step;
  for (Body& body : scene.bodies)
    if (!body.fixed) body.position.y() -= 1e-6 * body.position.y();
  Simulation sim(scene, with(request));
  sim.step();
  return std::min(step, sim.contact_step_limit() / 5);
}

/// How a cube stands, falls and rebounds on its face.
struct FaceContact {
  double overlap, contact_time, restitution, critical_step;
};

FaceContact face_contact(const StudyRequest& request, int cut) {
  constexpr double k = 1e6, zeta = .2, speed = .1;
  const double step = std::numbers::pi * std::sqrt(mass / k) / 4 / request.steps_per_contact;
  FaceContact found{};
  Scene still = cube_on_floor(cut, {.stiffness = k, .damping_ratio = .5, .friction = .5}, step);
  still.gravity = {0, -g, 0};
  Simulation standing(still, with(request));
  standing.run(4000);
  double height = 0; // what rocks is averaged
  for (int i = 0; i < 400; ++i) standing.step(), height += standing.particles().position[1].y() / 400;
  found.overlap = edge / 2 + reach - height;
  Scene falling = cube_on_floor(cut, {.stiffness = k, .damping_ratio = zeta, .friction = 0}, step);
  falling.bodies[1].velocity = {0, -speed, 0};
  Simulation rebound(falling, with(request));
  double touched = 0;
  while (rebound.time() < 4e-2 && !(touched > 0 && rebound.contacts().empty())) {
    rebound.step();
    if (!rebound.contacts().empty()) touched += step;
  }
  found.contact_time = touched;
  found.restitution = rebound.particles().velocity[1].y() / speed;
  found.critical_step = standing.contact_step_limit();
  return found;
}

} // namespace

std::vector<Metric> tessellation(const StudyRequest& request) {
  const FaceContact whole = face_contact(request, 1), cut = face_contact(request, static_cast<int>(request.value));
  const auto change = [](double now, double before) { return now / before - 1; };
  return {{"overlap_change", change(cut.overlap, whole.overlap), .02},
          {"contact_time_change", change(cut.contact_time, whole.contact_time), .02},
          {"restitution_change", change(cut.restitution, whole.restitution), .02},
          {"critical_step_change", change(cut.critical_step, whole.critical_step), .02},
          {"restitution_error", whole.restitution - restitution(.2), {}}};
}

namespace {

/// Where the upper of two cubes is on a closed path at t in [0, 1], turning all the while, so that corners, edges and
/// faces touch.
struct Pose {
  Vector3d x;
  Eigen::Quaterniond q;
};
Pose on_loop(int loop, std::uint64_t seed, double t) {
  const double w = 2 * std::numbers::pi * t, phase = loop + .37 * static_cast<double>(seed);
  const Vector3d turn(.06 * std::sin(w), .5 * loop + .4 * std::sin(w + 2 * phase), .06 * std::sin(3 * w + phase));
  return {edge *
              Vector3d(.35 * std::sin(w + phase), 1.15 + .05 * std::sin(2 * w + phase), .3 * std::cos(w) + .2 * loop),
          Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()))};
}

/// Two cubes that fill a tenth of their edge with halo, faces cut.
Scene two_cubes(int cut) {
  Scene scene = empty_scene(2, {.stiffness = 1e4, .damping_ratio = 0, .friction = 0}, 1e-6);
  for (const double y : {0., edge})
    scene.bodies.push_back(mesh_body(box({edge, edge, edge}, cut), mass, {0, y, 0}, .1 * edge));
  return scene;
}

/// Work around a loop, from the forces in the middle of `points` pieces of it; `stored` grows to the largest energy.
double work_around(Probe& probe, const StudyRequest& request, int loop, int points, double& stored) {
  double work = 0;
  Pose last = on_loop(loop, request.seed, 0);
  for (int i = 0; i < points; ++i) {
    const Pose next = on_loop(loop, request.seed, (i + 1.) / points);
    const Pose middle = on_loop(loop, request.seed, (i + .5) / points);
    probe.place(middle.x, middle.q);
    probe.evaluate();
    const Eigen::AngleAxisd turned(next.q * last.q.conjugate());
    work += probe.force.dot(next.x - last.x) + probe.torque.dot(turned.angle() * turned.axis());
    stored = std::max(stored, probe.energy);
    last = next;
  }
  return work;
}

} // namespace

std::vector<Metric> loop_work(const StudyRequest& request) {
  Probe probe(two_cubes(static_cast<int>(request.value)), request.contact_rule);
  double coarse = 0, fine = 0, stored = 0;
  for (int loop = 0; loop < 3; ++loop) {
    coarse = std::max(coarse, std::abs(work_around(probe, request, loop, 2500, stored)));
    fine = std::max(fine, std::abs(work_around(probe, request, loop, 40000, stored)));
  }
  return {
      {"loop_work", fine / stored, 1e-6}, {"loop_work_at_2500_points", coarse / stored, {}}, {"stored_J", stored, {}}};
}

/// Time to find the contacts of the cubes on these paths and their forces, in turns with rule `nearest`.
std::vector<Metric> rule_cost(const StudyRequest& request) {
  constexpr int points = 200, turns = 9;
  const Scene scene = two_cubes(static_cast<int>(request.value));
  Probe own(scene, request.contact_rule), nearest(scene, "nearest");
  std::size_t contacts = 0;
  const auto seconds = [&](Probe& probe) {
    const std::clock_t start = std::clock();
    contacts = 0;
    for (int i = 0; i < points; ++i) {
      const Pose pose = on_loop(i % 3, request.seed, static_cast<double>(i) / points);
      probe.place(pose.x, pose.q);
      probe.evaluate();
      contacts += probe.contacts.size();
    }
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / points;
  };
  std::vector<double> mine, others, ratios;
  for (int turn = 0; turn < turns; ++turn) {
    others.push_back(seconds(nearest));
    mine.push_back(seconds(own));
    ratios.push_back(mine.back() / others.back());
  }
  for (auto* list : {&mine, &ratios}) std::nth_element(list->begin(), list->begin() + turns / 2, list->end());
  return {{"microseconds", 1e6 * mine[turns / 2], {}},
          {"of_nearest", ratios[turns / 2], {}},
          {"contacts", static_cast<double>(contacts) / points, {}}};
}

/// A cube at rest on a face: where its force acts and how it turns; value: cut of the faces.
std::vector<Metric> face_rest(const StudyRequest& request) {
  const double k = 1e6, step = std::numbers::pi * std::sqrt(mass / k) / 4 / request.steps_per_contact;
  Scene scene =
      cube_on_floor(static_cast<int>(request.value), {.stiffness = k, .damping_ratio = .5, .friction = .5}, step);
  scene.gravity = {0, -g, 0};
  Simulation sim(scene, with(request));
  sim.run(4000);
  const double weight = mass * g;
  Vector3d low = Vector3d::Constant(1e300), high = -low;
  double torque = 0;
  bool rests = false;
  for (int i = 0; i < 1000; ++i) {
    sim.step();
    const Particles& p = sim.particles();
    Vector3d force = Vector3d::Zero(), about_centre = force, point = force;
    double pressed = 0;
    for (const Contact& c : sim.contacts()) {
      force -= c.force, about_centre -= (c.point - p.position[1]).cross(c.force) + c.torque();
      pressed += c.force.norm(), point += c.force.norm() * c.point;
    }
    if (pressed > 0) point /= pressed;
    rests |= pressed > 0;
    low = low.cwiseMin(point), high = high.cwiseMax(point);
    torque = std::max(torque, about_centre.norm());
  }
  return {{"wander_of_edge", rests ? (high - low).norm() / edge : std::nan(""), 1e-6},
          {"torque_of_weight_edge", rests ? torque / (weight * edge) : std::nan(""), 1e-6}};
}

/// Ten cubes on each other; value: cut of the faces.
std::vector<Metric> stack(const StudyRequest& request) {
  constexpr int boxes = 10;
  const double k = 1e7, step = std::numbers::pi * std::sqrt(mass / k) / 4 / request.steps_per_contact;
  Scene scene = empty_scene(4, {.stiffness = k, .damping_ratio = .5, .friction = .5}, step);
  scene.gravity = {0, -g, 0};
  scene.bodies = {floor_body(.8, halo, static_cast<int>(request.value))};
  for (int i = 0; i < boxes; ++i)
    scene.bodies.push_back(mesh_body(box({edge, edge, edge}, static_cast<int>(request.value)), mass,
                                     {0, (i + .5) * edge + (i + 1) * reach, 0}, halo));
  scene.time.step = safe_step(scene, request);
  Simulation sim(scene, with(request));
  while (sim.time() < 50000 * step) sim.step();
  const Particles& p = sim.particles();
  double height = 0, lateral = 0, y = 0;
  for (int i = 0; i < boxes; ++i) { // the lowest stands on its four corners; between two, the corners of both meet
    y += (i ? edge : edge / 2) + reach - (boxes - i) * mass * g / ((i ? 8 : 4) * k);
    height = std::max(height, std::abs(p.position[i + 1].y() / y - 1));
    lateral = std::max(lateral, std::hypot(p.position[i + 1].x(), p.position[i + 1].z()) / edge);
  }
  std::vector<double> load(boxes + 1); // that presses on body i from above (N)
  for (const Contact& c : sim.contacts()) load[c.a] -= c.force.y();
  double unequal = 0;
  for (int i = 0; i < boxes; ++i) unequal = std::max(unequal, std::abs(load[i] / ((boxes - i) * mass * g) - 1));
  const double kinetic = sim.energy().kinetic / (mass * g * mass * g / (4 * k));
  return {{"interface_load_error", unequal, 1e-6},
          {"height_error", height, request.contact_rule == "features" ? std::optional(1e-6) : std::nullopt},
          {"lateral_of_edge", lateral, 1e-6},
          {"kinetic_of_m_g_overlap", kinetic, 1e-9},
          {"contacts", static_cast<double>(sim.contacts().size()), {}}};
}

} // namespace trigrain
