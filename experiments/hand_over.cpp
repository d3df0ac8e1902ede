#include "experiments/hand_over.hpp"
#include <nlohmann/json.hpp>

namespace trigrain {
namespace {

using Json = nlohmann::ordered_json;

Json shape_json(const Particles& p, int i) {
  if (p.is_sphere(i)) return {{"radius_m", p.radius[i]}};
  Json points = Json::array(), faces = Json::array();
  for (const Eigen::Vector3d& v : p.mesh[i]->vertices) points.push_back(array_of(p.position[i] + p.orientation[i] * v));
  for (const auto& face : p.mesh[i]->faces) faces.push_back({face[0], face[1], face[2]});
  return {{"points_m", std::move(points)}, {"faces", std::move(faces)}};
}

} // namespace

Json hand_over(const Scene& scene, const FinalState& state) {
  Particles p;
  for (const Body& body : state.bodies) p.add(body);
  Json bodies = Json::array();
  for (int i = 0; i < p.size(); ++i)
    bodies.push_back({{"fixed", p.fixed(i)},
                      {"mass_kg", p.mass[i]},
                      {"halo_m", p.halo[i]},
                      {"centre_m", array_of(p.position[i])},
                      {"velocity_m_s", array_of(p.velocity[i])},
                      {"angular_velocity_rad_s", array_of(p.angular_velocity(i))},
                      {"shape", shape_json(p, i)}});
  return {{"time_s", state.time},
          {"gravity_m_s2", array_of(scene.gravity)},
          {"domain_m", {{"min", array_of(scene.domain.min)}, {"size", scene.domain.size}}},
          {"contact",
           {{"law", scene.contact.law},
            {"stiffness_N_m", scene.contact.stiffness},
            {"damping_ratio", scene.contact.damping_ratio},
            {"friction", scene.contact.friction},
            {"tangential_ratio", scene.contact.tangential_ratio}}},
          {"step_s", scene.time.step},
          {"bodies", std::move(bodies)}};
}

} // namespace trigrain
