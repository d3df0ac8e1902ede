#include "experiments/stability/numbers.hpp"
#include "dem/random.hpp"
#include "dem/vectors.hpp"
#include "experiments/stability/setups.hpp"
#include "kernels/kernels.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace trigrain {
namespace {

using Eigen::Vector3d;

constexpr double size = .1, reach = 2e-3; // m

using Place = std::function<Vector3d(const Vector3d&)>;

Triangles placed(const Mesh& mesh, const Place& place) {
  Triangles triangles;
  for (const auto& f : mesh.faces) {
    const auto corner = [&](int k) { return vec3(place(mesh.vertices[f[k]])); };
    triangles.push_back({corner(0), corner(1), corner(2)});
  }
  return triangles;
}

Closest closest(const Kernel& kernel, const Triangles& a, const Triangles& b) {
  Hits hits;
  KernelCounts counts;
  closest_of_all(kernel, a.view(), b.view(), {}, hits, counts);
  Closest best = hits[0].closest;
  for (int k = 1; k < hits.size(); ++k)
    if (hits[k].closest.distance < best.distance) best = hits[k].closest;
  return best;
}

/// Two granulates, about half of `reach` apart.
struct NearPair {
  Particles bodies;
  double distance; ///< m

  Place in_world(int i) const {
    return [this, i](const Vector3d& x) -> Vector3d { return bodies.position[i] + bodies.orientation[i] * x; };
  }
  /// As an engine has it that keeps coordinates in single precision.
  Place in_world_as_float(int i) const {
    return [place = in_world(i)](const Vector3d& x) -> Vector3d { return place(x).cast<float>().cast<double>(); };
  }
  Place in_frame_of_a(int i) const {
    const Eigen::Quaterniond back = bodies.orientation[0].conjugate();
    return [q = back * bodies.orientation[i],
            y = back * (bodies.position[i] - bodies.position[0])](const Vector3d& x) -> Vector3d { return y + q * x; };
  }
  Closest closest_with(const char* precision, Place (NearPair::*place)(int) const) const {
    return closest(kernel_named("brute-simd", precision), placed(*bodies.mesh[0], (this->*place)(0)),
                   placed(*bodies.mesh[1], (this->*place)(1)));
  }
};

/// Near the origin, in random directions.
NearPair near_pair(Random& random, int number) {
  NearPair pair;
  for (const int i : {0, 1}) {
    Body body = mesh_body(granulate(size, 20, 2 * number + i), 1, i * 3 * size * random.direction(), reach / 2);
    body.orientation = random.rotation();
    pair.bodies.add(body);
  }
  for (int i = 0; i < 50; ++i) { // along the shortest connection
    const Closest c = pair.closest_with("double", &NearPair::in_world);
    pair.distance = c.distance;
    if (std::abs(c.distance - reach / 2) < .1 * reach) break;
    pair.bodies.position[1] += (1 - reach / 2 / c.distance) * Vector3d(c.p.x - c.q.x, c.p.y - c.q.y, c.p.z - c.q.z);
  }
  return pair;
}

double with_float_positions(const NearPair& pair) {
  NearPair rounded = pair;
  for (Vector3d& x : rounded.bodies.position) x = x.cast<float>().cast<double>();
  return rounded.closest_with("float", &NearPair::in_frame_of_a).distance;
}

/// The engine's own way: what the overlap of the nearest contact leaves of the sum of halos.
double by_engine(const NearPair& pair) {
  const NarrowPhase narrow{&kernel_named("hybrid-pair"), &row_named(prechecks(), "pre-check", "box"),
                           &row_named(contact_rules(), "contact rule", "nearest")};
  WorkerBuffer buffer;
  collide(pair.bodies, std::array{BodyPair{0, 1}}, narrow, buffer);
  return buffer.contacts.empty() ? std::nan("") : reach - buffer.contacts[0].overlap;
}

/// How the distance is found.
struct Method {
  const char* name;
  double (*distance)(const NearPair& pair);
};
template <const char* precision, Place (NearPair::*place)(int) const> double by_kernel(const NearPair& pair) {
  return pair.closest_with(precision, place).distance;
}
constexpr char in_float[] = "float", in_double[] = "double", in_mixed[] = "mixed";
constexpr Method methods[] = {
    {"float_positions", with_float_positions},
    {"float_world", by_kernel<in_float, &NearPair::in_world_as_float>},
    {"float_relative", by_kernel<in_float, &NearPair::in_frame_of_a>},
    {"double_world", by_kernel<in_double, &NearPair::in_world>},
    {"mixed_relative", by_kernel<in_mixed, &NearPair::in_frame_of_a>},
    {"engine", by_engine},
};

} // namespace

/// Positions in double are rounded too: by 2^-53 of the distance, up to three times per body.
std::vector<Metric> far_from_origin(const StudyRequest& request) {
  constexpr int pairs = 50;
  const double bar = std::max(1e-12, 6 * std::ldexp(request.value, -53) / reach);
  std::vector<Metric> metrics;
  for (const Method& m : methods)
    metrics.push_back(
        {std::string("overlap_error_") + m.name, 0, m.distance == by_engine ? std::optional(bar) : std::nullopt});
  Random random(request.seed);
  for (int i = 0; i < pairs; ++i) {
    NearPair pair = near_pair(random, i);
    const Vector3d away = request.value * random.direction();
    for (Vector3d& x : pair.bodies.position) x += away;
    for (std::size_t k = 0; k < std::size(methods); ++k) {
      const double error = std::abs(methods[k].distance(pair) - pair.distance) / reach;
      metrics[k].value = error <= metrics[k].value ? metrics[k].value : error; // not finite stays
    }
  }
  return metrics;
}

namespace {

// --- meshes with defects, and bodies that touch exactly

using Faces = std::vector<std::array<int, 3>>;

struct Defect {
  const char* name;
  void (*spoil)(std::vector<Vector3d>& vertices, Faces& faces);
};

constexpr Defect defects[] = {
    {"zero_area",
     [](std::vector<Vector3d>& v, Faces& f) {
       v.push_back((v[f[0][0]] + v[f[0][1]]) / 2);
       f.push_back({f[0][0], f[0][1], static_cast<int>(v.size()) - 1});
       f.push_back({f[0][0], f[0][0], f[0][0]});
     }},
    {"needle",
     [](std::vector<Vector3d>& v, Faces& f) { // a corner's face gets a corner 1e-9 m beside another, and a sliver
       const auto [a, b, c] = f[0];
       v.push_back(v[a] + 1e-9 * (v[b] - v[a]) / (v[b] - v[a]).norm() + 1e-12 * (v[c] - v[a]));
       const int n = static_cast<int>(v.size()) - 1;
       f[0] = {n, b, c};
       f.push_back({a, b, n});
       f.push_back({a, n, c});
     }},
    {"repeated",
     [](std::vector<Vector3d>&, Faces& f) {
       f.insert(f.end(), {f[0], f[1], f[0]});
     }},
    {"one_inverted", [](std::vector<Vector3d>&, Faces& f) { std::swap(f[0][0], f[0][1]); }},
    {"all_inverted",
     [](std::vector<Vector3d>&, Faces& f) {
       for (auto& face : f) std::swap(face[0], face[1]);
     }},
    {"t_junction",
     [](std::vector<Vector3d>& v, Faces& f) { // one face's edge is cut, its neighbour's is not
       const auto [a, b, c] = f[0];
       v.push_back((v[a] + v[b]) / 2);
       const int n = static_cast<int>(v.size()) - 1;
       f[0] = {a, n, c};
       f.push_back({n, b, c});
     }},
    {"open", [](std::vector<Vector3d>&, Faces& f) { f.pop_back(); }},
    {"non_manifold",
     [](std::vector<Vector3d>& v, Faces& f) { // a fin on an edge
       v.push_back(1.5 * v[f[0][0]]);
       f.push_back({f[0][0], f[0][1], static_cast<int>(v.size()) - 1});
     }},
    {"flat", [](std::vector<Vector3d>&, Faces& f) { f.resize(1); }},
};

/// 0: everything stays finite and no energy appears. 1: refused in one sentence. 2: neither.
double outcome(const std::function<Scene()>& scene) {
  try {
    Simulation sim(scene(), {});
    sim.step();
    const double start = sim.energy().total();
    sim.run(3000);
    const Energy now = sim.energy();
    return std::isfinite(now.total()) && now.total() <= start + 1e-9 * std::abs(start) ? 0 : 2;
  } catch (const InputError& error) {
    return std::string(error.what()).find('\n') == std::string::npos ? 1 : 2;
  }
}

Scene drop(Body body, Body floor) {
  Scene scene = empty_scene(4, {.stiffness = 1e6, .damping_ratio = .3, .friction = .5}, 5e-5);
  scene.gravity = {0, -g, 0};
  body.orientation = Eigen::AngleAxisd(.4, Vector3d(1, 2, 3).normalized());
  body.velocity = {0, -.5, 0};
  body.position = {0, .1, 0};
  floor.fixed = true;
  scene.bodies = {floor, body};
  return scene;
}

Body spoiled(const Defect& defect, const Vector3d& edges) {
  Mesh whole = box(edges, 2);
  std::vector<Vector3d> vertices = whole.vertices;
  Faces faces = whole.faces;
  defect.spoil(vertices, faces);
  Body body;
  body.mesh = std::make_shared<Mesh>(make_mesh(defect.name, vertices, faces));
  body.halo = reach / 2;
  return body;
}

/// Two cubes at rest, the second moved by `by` edges: exactly touching or crossing surfaces must be told.
double told(const Vector3d& by) {
  Scene scene = empty_scene(4, {.stiffness = 1e6, .damping_ratio = .3, .friction = .5}, 5e-5);
  for (int i = 0; i < 2; ++i) scene.bodies.push_back(mesh_body(box({size, size, size}), 1, i * size * by, reach / 2));
  Simulation sim(scene, {});
  const StepStats stats = sim.run(200);
  return std::isfinite(sim.energy().total()) && stats.crossings > 0 ? 0 : 2;
}

} // namespace

std::vector<Metric> degenerate(const StudyRequest&) {
  std::vector<Metric> metrics;
  const Vector3d edges(size, size, size), slab(.4, .1, .4);
  for (const Defect& d : defects) {
    const std::string name = d.name;
    metrics.push_back(
        {name + "_moving", outcome([&] { return drop(spoiled(d, edges), floor_body(.4, reach / 2)); }), 1});
    metrics.push_back({name + "_fixed", outcome([&] {
                         Body floor = spoiled(d, slab);
                         floor.position = {0, -.05, 0};
                         return drop(mesh_body(box(edges), 1, {0, 0, 0}, reach / 2), floor);
                       }),
                       1});
  }
  const std::pair<const char*, Vector3d> poses[] = {{"faces_touch", {0, 1, 0}},
                                                    {"edges_touch", {1, 1, 0}},
                                                    {"corners_touch", {1, 1, 1}},
                                                    {"same_place", {0, 0, 0}},
                                                    {"deep_overlap", {.5, .25, .125}}};
  for (const auto& [name, by] : poses) metrics.push_back({std::string(name) + "_told", told(by), 1});
  return metrics;
}

} // namespace trigrain
