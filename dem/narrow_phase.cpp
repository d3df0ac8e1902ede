#include "dem/narrow_phase.hpp"
#include "kernels/sphere.hpp"
#include <numeric>

namespace trigrain {
namespace {

using Eigen::Vector3d;

/// Triangle pairs of a part: some microseconds of a kernel, and a multiple of every batch.
constexpr int part_size = 256;

Vec3<double> vec3(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Vector3d eigen(const Vec3<double>& v) { return {v.x, v.y, v.z}; }

/// x in the body frame of `body`.
Vector3d to_body(const Particles& p, int body, const Vector3d& x) {
  return p.orientation[body].conjugate() * (x - p.position[body]);
}

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

/// Two spheres touch at one point, whatever the contact rule.
void collide_spheres(const Particles& p, BodyPair pair, WorkerBuffer& buffer) {
  const auto [a, b] = pair;
  const Vector3d ab = p.position[b] - p.position[a];
  const double centres = ab.norm(), gap = centres - p.radius[a] - p.radius[b];
  if (gap >= buffer.reach) return;
  if (gap <= 0) {
    ++buffer.crossings;
    return;
  }
  const Vector3d normal = -ab / centres;
  const double overlap = buffer.reach - gap;
  buffer.found.push_back({a, b, static_cast<int>(buffer.contacts.size()), 1});
  buffer.contacts.push_back({.a = a,
                             .b = b,
                             .feature_a = 0,
                             .feature_b = 0,
                             .point = p.position[a] - (p.radius[a] + p.contact_place(a, b) * gap) * normal,
                             .normal = normal,
                             .overlap = overlap,
                             .mass = 1 / (p.inverse_mass[a] + p.inverse_mass[b]),
                             .push = overlap * normal});
}

/// Every triangle closer to the sphere than reach, in the frame of the mesh.
void collide_sphere_mesh(const Particles& particles, BodyPair pair, const NarrowPhase& narrow, WorkerBuffer& buffer) {
  const bool sphere_is_a = particles.is_sphere(pair.a);
  const int sphere = sphere_is_a ? pair.a : pair.b, body = sphere_is_a ? pair.b : pair.a;
  const Mesh& mesh = *particles.mesh[body];
  const TrianglesView triangles = mesh.triangles.view();
  const double r = particles.radius[sphere], place = particles.contact_place(body, sphere);
  const Vec3<double> centre = vec3(to_body(particles, body, particles.position[sphere]));
  narrow.precheck->triangles({triangles, &mesh.octree}, centre, r + buffer.reach, buffer.near);
  for (int i : buffer.near) {
    ++buffer.kernel.triangle_pairs;
    const PointOnTriangle nearest = closest_point(centre, triangles[i]);
    const Vector3d to_centre = particles.orientation[body] * eigen(centre - nearest.point);
    const double distance = to_centre.norm(), gap = std::max(0., distance - r);
    const Vector3d gap_vector = distance > 0 ? (gap / distance * to_centre).eval() : Vector3d::Zero(); // to the sphere
    const Vector3d point = particles.position[sphere] - to_centre + place * gap_vector;
    if (sphere_is_a)
      add_contact(pair, 0, i, point, gap_vector, buffer);
    else
      add_contact(pair, i, 0, point, -gap_vector, buffer);
  }
}

/// Triangle pairs that may be within reach, in the frame of A, where coordinates are as small as the bodies.
void find_candidates(const Particles& particles, BodyPair pair, const NarrowPhase& narrow, WorkerBuffer& buffer) {
  const Mesh &a = *particles.mesh[pair.a], &b = *particles.mesh[pair.b];
  const Vector3d centre_b = to_body(particles, pair.a, particles.position[pair.b]);
  const Eigen::Matrix3d turn =
      (particles.orientation[pair.a].conjugate() * particles.orientation[pair.b]).toRotationMatrix();
  const Placement b_in_a{{vec3(turn.row(0)), vec3(turn.row(1)), vec3(turn.row(2))}, vec3(centre_b)};
  narrow.precheck->pairs({a.triangles.view(), &a.octree}, {b.triangles.view(), &b.octree}, b_in_a, buffer.reach,
                         buffer.candidates);
}

/// The kernel on candidates [first, first + count), appended to `hits`.
void solve(const Particles& particles, BodyPair pair, const Candidates& candidates, int first, int count,
           const NarrowPhase& narrow, WorkerBuffer& buffer, Hits& hits) {
  const PairList list{particles.mesh[pair.a]->triangles.view(), candidates.b.view(), candidates.pairs};
  narrow.kernel->closest(list.part(first, count), {.reach = buffer.reach}, hits, buffer.kernel);
}

/// Contacts in the world.
void add_contacts(const Particles& particles, BodyPair pair, const Candidates& candidates, const Hits& hits,
                  WorkerBuffer& buffer) {
  if (hits.empty()) return;
  const Eigen::Matrix3d to_world = particles.orientation[pair.a].toRotationMatrix();
  const double place = particles.contact_place(pair.a, pair.b);
  for (int k = 0; k < hits.size(); ++k) {
    const Hit hit = hits[k];
    const Vector3d p = eigen(hit.closest.p), q = eigen(hit.closest.q);
    add_contact(pair, hit.i, candidates.number_b[hit.j],
                particles.position[pair.a] + to_world * ((1 - place) * p + place * q), to_world * (p - q), buffer);
  }
}

/// Hands the candidates in the buffer over, cut into parts.
SplitPair* split_up(BodyPair pair, WorkerBuffer& buffer, SplitPairs& into) {
  SplitPair& split = into.next();
  split.pair = pair;
  split.reach = buffer.reach;
  std::swap(split.candidates, buffer.candidates);
  split.parts = (static_cast<int>(split.candidates.pairs.size()) + part_size - 1) / part_size;
  split.parts_left.store(split.parts, std::memory_order_relaxed);
  if (split.hits.size() < static_cast<std::size_t>(split.parts)) split.hits.resize(split.parts);
  return &split;
}

/// Reduces the contacts from `first` on, all of one body pair.
void finish(const Particles& particles, BodyPair pair, std::size_t first, const NarrowPhase& narrow,
            WorkerBuffer& buffer) {
  if (buffer.contacts.size() > first) narrow.rule->reduce(particles, buffer.contacts, first);
  const auto count = static_cast<int>(buffer.contacts.size() - first);
  if (count > 0) buffer.found.push_back({pair.a, pair.b, static_cast<int>(first), count});
}

} // namespace

void WorkerBuffer::clear() {
  const std::size_t likely = contacts.size() + contacts.size() / 8; // ahead of need: when it comes, vectors double
  if (likely > contacts.capacity()) contacts.reserve(likely + likely / 8);
  contacts.clear();
  found.clear();
  candidate_pairs = body_pairs = crossings = 0;
  kernel = {};
}

SplitPair* collide(const Particles& particles, BodyPair pair, const NarrowPhase& narrow, WorkerBuffer& buffer,
                   SplitPairs* split) {
  const std::size_t first = buffer.contacts.size();
  buffer.reach = particles.halo[pair.a] + particles.halo[pair.b];
  const bool sphere_a = particles.is_sphere(pair.a), sphere_b = particles.is_sphere(pair.b);
  if (sphere_a && sphere_b) {
    collide_spheres(particles, pair, buffer);
    return nullptr;
  }
  if (sphere_a || sphere_b) {
    collide_sphere_mesh(particles, pair, narrow, buffer);
  } else {
    find_candidates(particles, pair, narrow, buffer);
    const auto count = static_cast<int>(buffer.candidates.pairs.size());
    if (split && count > part_size) return split_up(pair, buffer, *split);
    buffer.hits.clear();
    solve(particles, pair, buffer.candidates, 0, count, narrow, buffer, buffer.hits);
    add_contacts(particles, pair, buffer.candidates, buffer.hits, buffer);
  }
  finish(particles, pair, first, narrow, buffer);
  return nullptr;
}

void solve_part(const Particles& particles, SplitPair& split, int part, const NarrowPhase& narrow,
                WorkerBuffer& buffer) {
  buffer.reach = split.reach;
  split.hits[part].clear();
  solve(particles, split.pair, split.candidates, part * part_size, part_size, narrow, buffer, split.hits[part]);
  if (split.parts_left.fetch_sub(1, std::memory_order_acq_rel) > 1) return;
  const std::size_t first = buffer.contacts.size();
  for (int k = 0; k < split.parts; ++k) add_contacts(particles, split.pair, split.candidates, split.hits[k], buffer);
  finish(particles, split.pair, first, narrow, buffer);
}

} // namespace trigrain
