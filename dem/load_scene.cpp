#include "dem/hertz.hpp"
#include "dem/json_reader.hpp"
#include "dem/mesh_defects.hpp"
#include "dem/scene.hpp"
#include "kernels/name_table.hpp"
#include <cmath>
#include <map>
#include <set>

namespace trigrain {
namespace {

/// Makes a mesh; an InputError from there is told the place in the scene file as well.
template <class Make> Mesh made_at(const JsonReader& reader, const Make& make) {
  try {
    return make();
  } catch (const InputError& e) {
    std::string message = e.what();
    const std::size_t end = message.rfind("). ");
    if (end != message.npos) message.insert(end, "; " + reader.place());
    throw InputError(message);
  }
}

Mesh read_box(const JsonReader& shape) {
  shape.allow({"box_m", "subdivide"});
  const JsonReader size = shape.at("box_m");
  const Eigen::Vector3d edges = size.vector();
  for (const JsonReader& edge : size.items()) edge.positive();
  const auto subdivide = shape.find("subdivide");
  return box(edges, subdivide ? subdivide->integer(1, 512) : 1);
}

Mesh read_icosphere(const JsonReader& shape) {
  shape.allow({"icosphere"});
  const JsonReader r = shape.at("icosphere");
  r.allow({"radius_m", "level"});
  const double radius = r.at("radius_m").positive();
  return icosphere(radius, r.at("level").integer(0, 8));
}

Mesh read_granulate(const JsonReader& shape) {
  shape.allow({"granulate"});
  const JsonReader r = shape.at("granulate");
  r.allow({"diameter_m", "vertices", "seed"});
  const SceneOptions defaults;
  const auto vertices = r.find("vertices"), seed = r.find("seed");
  const double diameter = r.at("diameter_m").positive();
  const int points = vertices ? vertices->integer(4, 10000) : defaults.vertices;
  return made_at(r, [&] { return granulate(diameter, points, seed ? seed->seed() : defaults.seed); });
}

Mesh read_mesh(const JsonReader& shape, const std::filesystem::path& folder) {
  shape.allow({"mesh"});
  const JsonReader r = shape.at("mesh");
  r.allow({"file", "scale"});
  const auto scale = r.find("scale");
  const double factor = scale ? scale->positive() : 1;
  const JsonReader file = r.at("file");
  return made_at(file, [&] { return load_mesh(folder / file.text(), factor); });
}

Mesh read_hopper(const JsonReader& shape) {
  shape.allow({"hopper"});
  const JsonReader r = shape.at("hopper");
  r.allow({"width_m", "height_m", "opening_m", "thickness_m"});
  const double width = r.at("width_m").positive(), height = r.at("height_m").positive(),
               opening = r.at("opening_m").positive(), thickness = r.at("thickness_m").positive();
  return made_at(r, [&] { return hopper(width, height, opening, thickness); });
}

Mesh read_plane(const JsonReader& shape) {
  shape.allow({"plane"});
  const JsonReader r = shape.at("plane");
  r.allow({"size_m"});
  return plane(r.at("size_m").positive());
}

Mesh read_triangles(const JsonReader& shape, const std::filesystem::path& folder) {
  if (shape.find("box_m")) return read_box(shape);
  if (shape.find("icosphere")) return read_icosphere(shape);
  if (shape.find("granulate")) return read_granulate(shape);
  if (shape.find("mesh")) return read_mesh(shape, folder);
  if (shape.find("hopper")) return read_hopper(shape);
  if (shape.find("plane")) return read_plane(shape);
  shape.allow({"box_m", "sphere_m", "icosphere", "granulate", "mesh", "hopper", "plane"});
  shape.refuse("the shape is empty", "Give one of box_m, sphere_m, icosphere, granulate, mesh, hopper, plane.");
}

/// Bodies of equal shape share one mesh.
using KnownMeshes = std::map<std::string, std::shared_ptr<const Mesh>>;

void read_shape(const JsonReader& shape, const std::filesystem::path& folder, KnownMeshes& known, Body& body) {
  if (const auto radius = shape.find("sphere_m")) {
    shape.allow({"sphere_m"});
    body.sphere_radius = radius->positive();
    return;
  }
  auto& mesh = known[shape.dump()];
  if (!mesh) mesh = std::make_shared<const Mesh>(read_triangles(shape, folder));
  body.mesh = mesh;
}

/// Refuses a mesh that cannot move: one without mass, and of those from a file one that crosses itself or does not fit
/// into the domain.
void check_moving(const JsonReader& shape, const Mesh& mesh, const Domain& domain) {
  if (mesh.volume == 0)
    shape.refuse(why_massless(mesh) + ", so it has no mass", "Close the surface or set \"fixed\": true.");
  if (!shape.find("mesh")) return;
  if (const auto x = self_crossing(mesh))
    shape.refuse("the surface crosses itself at " + in_words(*x) + " m, so its mass is not known",
                 "Unite its pieces in a modelling program or set \"fixed\": true.");
  if (mesh.radius > domain.size)
    shape.refuse("the mesh reaches " + std::to_string(mesh.radius) + " m from its centre and the domain is " +
                     std::to_string(domain.size) + " m wide",
                 "Give a scale (m per unit of the file: 0.001 for mm) or a wider domain_m.");
}

Eigen::Quaterniond read_orientation(const JsonReader& reader) {
  const std::vector<double> c = reader.numbers(4);
  const Eigen::Quaterniond q(c[0], c[1], c[2], c[3]);
  if (!(std::abs(q.norm() - 1) <= 1e-3)) // rounded decimals pass
    reader.refuse("the quaternion has length " + std::to_string(q.norm()), "Divide it by its length, to within 1e-3.");
  return q.normalized();
}

Body read_body(const JsonReader& r, const std::filesystem::path& folder, KnownMeshes& known) {
  r.allow({"shape", "position_m", "orientation_wxyz", "velocity_m_s", "angular_velocity_rad_s", "density_kg_m3",
           "halo_m", "fixed"});
  Body body;
  read_shape(r.at("shape"), folder, known, body);
  if (const auto v = r.find("position_m")) body.position = v->vector();
  if (const auto v = r.find("orientation_wxyz")) body.orientation = read_orientation(*v);
  if (const auto v = r.find("velocity_m_s")) body.velocity = v->vector();
  if (const auto v = r.find("angular_velocity_rad_s")) body.angular_velocity = v->vector();
  if (const auto v = r.find("density_kg_m3")) body.density = v->positive();
  if (const auto v = r.find("halo_m")) body.halo = v->not_negative();
  if (const auto v = r.find("fixed")) body.fixed = v->flag();
  if (body.fixed && !(body.velocity.isZero(0) && body.angular_velocity.isZero(0)))
    r.refuse("a fixed body has a velocity", "Leave out the velocity or \"fixed\".");
  return body;
}

Domain read_domain(const JsonReader& r) {
  r.allow({"min", "size"});
  Domain domain;
  if (const auto v = r.find("min")) domain.min = v->vector();
  if (const auto v = r.find("size")) domain.size = v->positive();
  return domain;
}

ContactParameters read_contact(const JsonReader& r) {
  r.allow({"law", "stiffness_N_m", "damping_ratio", "restitution", "friction", "tangential_ratio", "youngs_modulus_Pa",
           "poisson_ratio"});
  ContactParameters contact;
  if (const auto v = r.find("law")) contact.law = v->one_of({"spring-dashpot", "hertz-mindlin"});
  if (const auto v = r.find("stiffness_N_m")) contact.stiffness = v->positive();
  if (const auto v = r.find("damping_ratio")) contact.damping_ratio = v->not_negative();
  if (const auto v = r.find("restitution")) {
    const double e = v->positive();
    if (e > 1) v->refuse("a restitution is at most 1", "Give 0 < e <= 1.");
    if (r.find("damping_ratio")) v->refuse("restitution and damping_ratio say the same", "Give one of them.");
    contact.damping_ratio = damping_ratio_for(contact.law, e);
  }
  if (const auto v = r.find("youngs_modulus_Pa")) contact.youngs_modulus = v->positive();
  if (const auto v = r.find("poisson_ratio")) {
    contact.poisson_ratio = v->not_negative();
    if (contact.poisson_ratio > .5) v->refuse("a Poisson ratio is at most 0.5", "Give 0 to 0.5.");
  }
  if (const auto v = r.find("friction")) contact.friction = v->not_negative();
  if (const auto v = r.find("tangential_ratio")) contact.tangential_ratio = v->not_negative();
  return contact;
}

TimeParameters read_time(const JsonReader& r) {
  r.allow({"step_s", "end_s", "control", "force"});
  TimeParameters time;
  if (const auto v = r.find("step_s")) time.step = v->positive();
  if (const auto v = r.find("end_s")) time.end = v->positive();
  if (const auto v = r.find("force")) time.force = v->flag();
  if (const auto v = r.find("control")) time.control = v->one_of({"fixed", "approach", "gap-only"});
  if (time.step > time.end)
    r.refuse("the step of " + std::to_string(time.step) + " s is longer than the " + std::to_string(time.end) +
                 " s until the end",
             "Give a step_s of at most end_s.");
  return time;
}

} // namespace

Scene load_scene(const std::filesystem::path& file) {
  const JsonReader r = JsonReader::open(file);
  r.allow({"gravity_m_s2", "domain_m", "contact", "time", "bodies"});
  Scene scene;
  scene.name = file.stem().string();
  if (const auto v = r.find("gravity_m_s2")) scene.gravity = v->vector();
  if (const auto v = r.find("domain_m")) scene.domain = read_domain(*v);
  if (const auto v = r.find("contact")) scene.contact = read_contact(*v);
  if (const auto v = r.find("time")) scene.time = read_time(*v);
  KnownMeshes known;
  std::set<const Mesh*> may_move;
  for (const JsonReader& reader : r.at("bodies").items()) {
    const Body& body = scene.bodies.emplace_back(read_body(reader, file.parent_path(), known));
    if (!body.fixed && body.mesh && may_move.insert(body.mesh.get()).second)
      check_moving(reader.at("shape"), *body.mesh, scene.domain);
  }
  if (scene.bodies.empty()) r.at("bodies").refuse("there are no bodies", "Give at least one.");
  return scene;
}

} // namespace trigrain
