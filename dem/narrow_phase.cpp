#include "dem/narrow_phase.hpp"
#include "kernels/sphere.hpp"
#include <numeric>

namespace trigrain {
namespace {

using Eigen::Vector3d;

Vec3<double> vec3(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Vector3d eigen(const Vec3<double>& v) { return {v.x, v.y, v.z}; }

/// x in the body frame of `body`.
Vector3d to_body(const Particles& p, int body, const Vector3d& x) {
  return p.orientation[body].conjugate() * (x - p.position[body]);
}

// --- pre-checks

bool any_bodies(const Particles&, BodyPair) { return true; }

bool near_bodies(const Particles& p, BodyPair pair) {
  const double r = p.radius[pair.a] + p.radius[pair.b] + p.halo[pair.a] + p.halo[pair.b];
  return (p.position[pair.a] - p.position[pair.b]).squaredNorm() <=
         r * r * (1 + 1e-12); // rounding must not lose a pair
}

void all_triangles(TrianglesView triangles, const Vec3<double>&, double, std::vector<int>& indices) {
  indices.resize(triangles.size);
  std::iota(indices.begin(), indices.end(), 0);
}

constexpr Precheck precheck_table[] = {
    {"none", "every triangle pair of every candidate body pair", any_bodies, all_triangles},
    {"sphere", "bounding spheres of the bodies, then triangles against the other body's sphere", near_bodies,
     triangles_near_point},
};

// --- one body pair

/// Appends the contact at `point` (world) with `pq` = P - Q, if it is shorter than reach. Taking P - Q from the body's
/// own frame keeps its digits far from the world's origin.
void add_contact(BodyPair pair, int feature_a, int feature_b, const Vector3d& point, const Vector3d& pq,
                 WorkerBuffer& buffer) {
  const double distance = pq.norm();
  if (distance >= buffer.reach) return;
  if (distance == 0) {
    ++buffer.crossings;
    return;
  }
  buffer.contacts.push_back({pair.a, pair.b, feature_a, feature_b, point, pq / distance, buffer.reach - distance});
}

void collide_spheres(const Particles& particles, BodyPair pair, WorkerBuffer& buffer) {
  const Vector3d ab = particles.position[pair.b] - particles.position[pair.a];
  const double centres = ab.norm(), ra = particles.radius[pair.a], rb = particles.radius[pair.b];
  const double gap = std::max(0., centres - ra - rb); // crossing spheres: as crossing triangles
  const Vector3d n = centres > 0 ? (ab / centres).eval() : Vector3d::UnitX();
  add_contact(pair, 0, 0, particles.position[pair.a] + (ra + gap / 2) * n, -gap * n, buffer);
}

/// Every triangle closer to the sphere than reach, in the frame of the mesh.
void collide_sphere_mesh(const Particles& particles, BodyPair pair, const NarrowPhase& narrow, WorkerBuffer& buffer) {
  const bool sphere_is_a = particles.is_sphere(pair.a);
  const int sphere = sphere_is_a ? pair.a : pair.b, body = sphere_is_a ? pair.b : pair.a;
  const TrianglesView triangles = particles.mesh[body]->triangles.view();
  const double r = particles.radius[sphere];
  const Vec3<double> centre = vec3(to_body(particles, body, particles.position[sphere]));
  narrow.precheck->triangles(triangles, centre, r + buffer.reach, buffer.index_a);
  for (int i : buffer.index_a) {
    ++buffer.kernel.triangle_pairs;
    const PointOnTriangle nearest = closest_point(centre, triangles[i]);
    const Vector3d to_centre = particles.orientation[body] * eigen(centre - nearest.point);
    const double distance = to_centre.norm(), gap = std::max(0., distance - r);
    const Vector3d gap_vector = distance > 0 ? (gap / distance * to_centre).eval() : Vector3d::Zero(); // to the sphere
    const Vector3d point = particles.position[sphere] - to_centre + gap_vector / 2;
    if (sphere_is_a)
      add_contact(pair, 0, i, point, gap_vector, buffer);
    else
      add_contact(pair, i, 0, point, -gap_vector, buffer);
  }
}

void collide_meshes(const Particles& particles, BodyPair pair, const NarrowPhase& narrow, WorkerBuffer& buffer) {
  const Mesh &a = *particles.mesh[pair.a], &b = *particles.mesh[pair.b];
  const double reach = buffer.reach;
  // 1 triangles of each that may reach the other body's bounding sphere
  const Vector3d centre_b = to_body(particles, pair.a, particles.position[pair.b]);
  narrow.precheck->triangles(a.triangles.view(), vec3(centre_b), particles.radius[pair.b] + reach, buffer.index_a);
  if (buffer.index_a.empty()) return;
  const Vector3d centre_a = to_body(particles, pair.b, particles.position[pair.a]);
  narrow.precheck->triangles(b.triangles.view(), vec3(centre_a), particles.radius[pair.a] + reach, buffer.index_b);
  if (buffer.index_b.empty()) return;
  // 2 both in the frame of A, where coordinates are as small as the bodies
  const TrianglesView all_a = a.triangles.view();
  buffer.near_a.clear();
  for (int i : buffer.index_a) buffer.near_a.push_back(all_a[i]);
  const Eigen::Matrix3d turn =
      (particles.orientation[pair.a].conjugate() * particles.orientation[pair.b]).toRotationMatrix();
  buffer.vertices.resize(b.vertices.size());
  for (std::size_t v = 0; v < b.vertices.size(); ++v) buffer.vertices[v] = vec3(turn * b.vertices[v] + centre_b);
  buffer.near_b.clear();
  for (int j : buffer.index_b) {
    const auto& f = b.faces[j];
    buffer.near_b.push_back({buffer.vertices[f[0]], buffer.vertices[f[1]], buffer.vertices[f[2]]});
  }
  // 3 the kernel
  buffer.hits.clear();
  closest_of_all(*narrow.kernel, buffer.near_a.view(), buffer.near_b.view(), {.reach = reach}, buffer.hits,
                 buffer.kernel);
  // 4 contacts in the world
  const Eigen::Matrix3d to_world = particles.orientation[pair.a].toRotationMatrix();
  for (int k = 0; k < buffer.hits.size(); ++k) {
    const Hit hit = buffer.hits[k];
    const Vector3d p = eigen(hit.closest.p), q = eigen(hit.closest.q);
    add_contact(pair, buffer.index_a[hit.i], buffer.index_b[hit.j],
                particles.position[pair.a] + to_world * ((p + q) / 2), to_world * (p - q), buffer);
  }
}

} // namespace

std::span<const Precheck> prechecks() { return precheck_table; }

void WorkerBuffer::clear() {
  contacts.clear();
  candidate_pairs = body_pairs = crossings = 0;
  kernel = {};
}

void collide(const Particles& particles, BodyPair pair, const NarrowPhase& narrow, WorkerBuffer& buffer) {
  const std::size_t first = buffer.contacts.size();
  buffer.reach = particles.halo[pair.a] + particles.halo[pair.b];
  const bool sphere_a = particles.is_sphere(pair.a), sphere_b = particles.is_sphere(pair.b);
  if (sphere_a && sphere_b)
    collide_spheres(particles, pair, buffer);
  else if (sphere_a || sphere_b)
    collide_sphere_mesh(particles, pair, narrow, buffer);
  else
    collide_meshes(particles, pair, narrow, buffer);
  if (buffer.contacts.size() > first) narrow.rule->reduce(particles, buffer.contacts, first);
}

} // namespace trigrain
