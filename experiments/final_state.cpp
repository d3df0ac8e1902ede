#include "experiments/final_state.hpp"
#include "kernels/name_table.hpp"
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

namespace trigrain {
namespace {

using Json = nlohmann::ordered_json;

/// One JSON file being read; `where` is the path of a key, as in bodies[3].position_m.
struct Reader {
  std::filesystem::path file;

  [[noreturn]] void refuse(const std::string& where, const std::string& expected) const {
    throw InputError("cannot use '" + file.string() + "' (" + where + ": expected " + expected +
                     "). Give a final state as written by dem_bench --final-state.");
  }
  const Json& at(const Json& object, const std::string& where, const char* key) const {
    if (!object.is_object() || !object.contains(key)) refuse(where.empty() ? key : where + "." + key, "a value");
    return object.at(key);
  }
  double number(const Json& object, const std::string& where, const char* key) const {
    const Json& value = at(object, where, key);
    if (!value.is_number()) refuse(where.empty() ? key : where + "." + key, "a number");
    return value.get<double>();
  }
  template <int n>
  Eigen::Matrix<double, n, 1> numbers(const Json& object, const std::string& where, const char* key) const {
    const Json& value = at(object, where, key);
    Eigen::Matrix<double, n, 1> result;
    bool fine = value.is_array() && value.size() == n;
    for (int i = 0; fine && i < n; ++i) {
      fine = value[i].is_number();
      if (fine) result[i] = value[i].get<double>();
    }
    if (!fine) refuse(where + "." + key, std::to_string(n) + " numbers");
    return result;
  }
  Body body(const Json& json, const std::string& where) const {
    Body b;
    b.position = numbers<3>(json, where, "position_m");
    const Eigen::Vector4d q = numbers<4>(json, where, "orientation_wxyz");
    if (std::abs(q.norm() - 1) > 1e-6) refuse(where + ".orientation_wxyz", "a unit quaternion");
    b.orientation = {q[0], q[1], q[2], q[3]};
    b.velocity = numbers<3>(json, where, "velocity_m_s");
    b.angular_velocity = numbers<3>(json, where, "angular_velocity_rad_s");
    return b;
  }
};

} // namespace

FinalState final_state(const Simulation& simulation, double start_time) {
  const Particles& particles = simulation.particles();
  FinalState state{
      .time = start_time + simulation.time(), .energy = simulation.energy(), .bodies = {}, .fixed_bodies = 0};
  for (int i = 0; i < particles.size(); ++i) {
    state.bodies.push_back(particles.body(i));
    state.fixed_bodies += particles.fixed(i);
  }
  return state;
}

Json array_of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json to_json(const FinalState& state) {
  Json bodies = Json::array();
  for (const Body& b : state.bodies)
    bodies.push_back(
        {{"position_m", array_of(b.position)},
         {"orientation_wxyz", {b.orientation.w(), b.orientation.x(), b.orientation.y(), b.orientation.z()}},
         {"velocity_m_s", array_of(b.velocity)},
         {"angular_velocity_rad_s", array_of(b.angular_velocity)}});
  return {
      {"time_s", state.time},
      {"energy_J",
       {{"kinetic", state.energy.kinetic}, {"potential", state.energy.potential}, {"elastic", state.energy.elastic}}},
      {"fixed_bodies", state.fixed_bodies},
      {"bodies", std::move(bodies)}};
}

FinalState read_final_state(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw InputError("cannot read '" + file.string() + "' (no such file, or not readable). Check the path.");
  const Reader reader{file};
  const Json json = Json::parse(stream, nullptr, false);
  if (json.is_discarded()) reader.refuse("whole file", "JSON");
  FinalState state;
  state.time = reader.number(json, "", "time_s");
  const Json& energy = reader.at(json, "", "energy_J");
  state.energy = {.kinetic = reader.number(energy, "energy_J", "kinetic"),
                  .potential = reader.number(energy, "energy_J", "potential"),
                  .elastic = reader.number(energy, "energy_J", "elastic")};
  if (json.contains("fixed_bodies")) {
    if (!json["fixed_bodies"].is_number_integer()) reader.refuse("fixed_bodies", "a whole number");
    state.fixed_bodies = json["fixed_bodies"].get<int>();
  }
  const Json& bodies = reader.at(json, "", "bodies");
  if (!bodies.is_array()) reader.refuse("bodies", "an array");
  for (std::size_t i = 0; i < bodies.size(); ++i)
    state.bodies.push_back(reader.body(bodies[i], "bodies[" + std::to_string(i) + "]"));
  return state;
}

Scene continued(Scene scene, const FinalState& state, const std::filesystem::path& file) {
  const Reader reader{file};
  if (state.bodies.size() != scene.bodies.size())
    reader.refuse("bodies", "the " + std::to_string(scene.bodies.size()) + " bodies of scene '" + scene.name +
                                "', found " + std::to_string(state.bodies.size()));
  int fixed = 0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    Body& body = scene.bodies[i];
    const Body& found = state.bodies[i];
    fixed += body.fixed;
    if (body.fixed) { // where the scene puts it; a state in which it moves is another scene's
      if (found.velocity.any() || found.angular_velocity.any())
        reader.refuse("bodies[" + std::to_string(i) + "].velocity_m_s", "0, for the scene fixes this body");
      continue;
    }
    body.position = found.position;
    body.orientation = found.orientation;
    body.velocity = found.velocity;
    body.angular_velocity = found.angular_velocity;
  }
  if (state.fixed_bodies >= 0 && state.fixed_bodies != fixed)
    reader.refuse("fixed_bodies", std::to_string(fixed) + ", as in scene '" + scene.name + "'");
  return scene;
}

Scene snapshot(const Simulation& simulation) {
  Scene scene = simulation.scene();
  for (int i = 0; i < simulation.particles().size(); ++i) scene.bodies.push_back(simulation.particles().body(i));
  return scene;
}

} // namespace trigrain
