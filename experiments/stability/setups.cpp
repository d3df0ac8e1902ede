#include "experiments/stability/setups.hpp"
#include "dem/forces.hpp"
#include "dem/hertz.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace trigrain {

using Eigen::Vector3d;

Scene empty_scene(double domain_size, const ContactParameters& contact, double step) {
  Scene scene;
  scene.name = "study";
  scene.gravity = {0, 0, 0};
  scene.domain = {.min = Vector3d::Constant(-domain_size / 2), .size = domain_size};
  scene.contact = contact;
  scene.time.step = step;
  return scene;
}

Body floor_body(double width, double halo, int cut) {
  Body floor;
  floor.mesh = std::make_shared<Mesh>(box({width, width / 8, width}, cut));
  floor.position = {0, -width / 16, 0};
  floor.halo = halo;
  floor.fixed = true;
  return floor;
}

Body mesh_body(Mesh mesh, double mass, const Vector3d& position, double halo) {
  Body body;
  body.density = mass / mesh.volume;
  body.mesh = std::make_shared<Mesh>(std::move(mesh));
  body.position = position;
  body.halo = halo;
  return body;
}

Body sphere_body(double radius, double mass, const Vector3d& position, double halo) {
  Body body;
  body.sphere_radius = radius;
  body.density = mass / (4. / 3. * std::numbers::pi * radius * radius * radius);
  body.position = position;
  body.halo = halo;
  return body;
}

double lowest_point(const Body& body) {
  if (!body.mesh) return -body.sphere_radius;
  double lowest = 0;
  for (const Vector3d& x : body.mesh->vertices)
    lowest = std::min(lowest, (body.orientation * body.mesh->in_shape_frame(x)).y());
  return lowest;
}

double restitution(double zeta) {
  const double w = std::sqrt(1 - zeta * zeta);
  return std::exp(-zeta / w * (std::numbers::pi - std::atan2(2 * zeta * w, w * w - zeta * zeta)));
}

double elastic_contact_time(const ContactParameters& contact, double mass, double radius, double speed) {
  if (contact.law != "hertz-mindlin") return std::numbers::pi * std::sqrt(mass / contact.stiffness);
  const double k = hertz_pair(contact, radius, std::numeric_limits<double>::infinity(), true).k;
  return 2.943275 * std::pow(5 * mass * speed * speed / (4 * k), .4) / speed;
}

Probe::Probe(const Scene& scene, const std::string& contact_rule)
    : law_(scene.contact), narrow_{&kernel_named("hybrid-pair"), &row_named(prechecks(), "pre-check", "sphere"),
                                   &row_named(contact_rules(), "contact rule", contact_rule)} {
  for (const Body& body : scene.bodies) particles_.add(body);
}

void Probe::place(const Vector3d& position, const Eigen::Quaterniond& orientation) {
  particles_.position[1] = position;
  particles_.orientation[1] = orientation.normalized();
}

void Probe::evaluate() {
  buffer_.clear();
  collide(particles_, std::array{BodyPair{0, 1}}, narrow_, buffer_);
  contacts.clear();
  for (const Touch& touch : buffer_.contacts) contacts.push_back(Contact{touch});
  const std::array spins{particles_.angular_velocity(0), particles_.angular_velocity(1)};
  std::vector<HeldSpring> springs(contacts.size());
  contact_forces(particles_, spins, law_of(law_), law_, 0, contacts, springs);
  Loads loads{{Vector3d::Zero(), Vector3d::Zero()}, {Vector3d::Zero(), Vector3d::Zero()}};
  if (!contacts.empty()) add_reaction(particles_, reaction_of(particles_, contacts), false, loads);
  force = loads.force[1];
  torque = loads.torque[1];
  energy = elastic_energy(contacts);
}

} // namespace trigrain
