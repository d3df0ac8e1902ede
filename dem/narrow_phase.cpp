#include "dem/narrow_phase.hpp"
#include "dem/feature_contacts.hpp"
#include "dem/vectors.hpp"
#include "kernels/placement.hpp"
#include "kernels/sphere.hpp"
#include <algorithm>
#include <cmath>

namespace trigrain {
namespace {

using Eigen::Vector3d;

/// Triangle pairs of a part: some microseconds of a kernel, and a multiple of every batch.
constexpr int part_size = 256;

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

/// Books the contacts from `first` on, all of one body pair.
void book(BodyPair pair, std::size_t first, WorkerBuffer& buffer) {
  const auto count = static_cast<int>(buffer.contacts.size() - first);
  if (count > 0) buffer.found.push_back({pair.a, pair.b, static_cast<int>(first), count});
}

void reduce(const Particles& particles, std::size_t first, const NarrowPhase& narrow, WorkerBuffer& buffer) {
  if (buffer.contacts.size() > first) narrow.rule->reduce(particles, buffer.contacts, first);
}

double gap_of_spheres(const Particles& p, BodyPair pair) {
  return (p.position[pair.b] - p.position[pair.a]).norm() - p.radius[pair.a] - p.radius[pair.b];
}

/// Two spheres touch at one point, whatever the contact rule: touch_of_spheres().
void collide_spheres(const Particles& p, BodyPair pair, WorkerBuffer& buffer) {
  const double gap = gap_of_spheres(p, pair);
  if (gap >= buffer.reach) return;
  if (gap <= 0)
    ++buffer.crossings;
  else
    buffer.found.push_back({pair.a, pair.b, FoundPair::of_spheres, 1});
}

MeshView view_of(const Particles& p, int body) { return {p.mesh[body]->triangles.view(), &p.mesh[body]->octree}; }

/// How far a search looks beyond the halos, for what may come near in the steps that follow (m).
double margin_of(const NarrowPhase& narrow, double reach) { return narrow.kept_pairs ? KeptPairs::margin * reach : 0; }

/// What rounding may do to lengths (m) between two bodies.
double rounding_of(const Particles& p, BodyPair pair, const Vector3d& centre) {
  return 1e-12 * (p.radius[pair.a] + p.radius[pair.b] + centre.norm());
}

// --- spheres and meshes: their triangles are looked at together, a pack at a time

/// The triangles near a sphere whose centre (m) is given in the frame of the mesh: those kept, or else those that a
/// search finds.
std::span<const int> near_sphere(const Particles& particles, BodyPair pair, int sphere, int body,
                                 const Vector3d& centre, const NarrowPhase& narrow, WorkerBuffer& buffer) {
  NearTriangles* const kept = narrow.kept_pairs ? &narrow.kept_pairs->of_spheres.of(pair, particles) : nullptr;
  if (kept && kept->is_complete(centre)) return kept->triangles();
  ++buffer.searched_pairs;
  const MeshView mesh = view_of(particles, body);
  const double margin = margin_of(narrow, buffer.reach), far = particles.radius[sphere] + buffer.reach + margin;
  narrow.precheck->triangles(mesh, vec3(centre), far, buffer.found_triangles);
  if (!kept) return buffer.found_triangles;
  std::erase_if(buffer.found_triangles, // pre-checks let some pass, which would be looked at in many steps
                [&](int i) { return closest_point(vec3(centre), mesh.triangles[i]).distance2 > far * far; });
  kept->keep(buffer.found_triangles, centre, margin - rounding_of(particles, pair, centre));
  return kept->triangles();
}

/// Notes the triangles of a mesh that are near a sphere.
void note_near_triangles(const Particles& particles, BodyPair pair, const NarrowPhase& narrow, WorkerBuffer& buffer) {
  const auto [sphere, body] = particles.is_sphere(pair.a) ? std::pair(pair.a, pair.b) : std::pair(pair.b, pair.a);
  const Vector3d centre = particles.to_body(body, particles.position[sphere]);
  const TrianglesView triangles = particles.mesh[body]->triangles.view();
  const Vec3<double> c = vec3(centre);
  const int first = buffer.near_triangles.size();
  for (const int i : near_sphere(particles, pair, sphere, body, centre, narrow, buffer)) {
    const Triangle t = triangles[i];
    buffer.near_triangles.push_back({t.a0 - c, t.a1 - c, t.a2 - c});
    buffer.near_numbers.push_back(i);
  }
  const int count = buffer.near_triangles.size() - first;
  if (count > 0) buffer.near_meshes.push_back({pair, first, count});
}

/// Contacts of a sphere with every triangle closer than reach, or with the closest of each piece of the mesh.
void collide_sphere_mesh(const Particles& particles, const WorkerBuffer::NearMesh& near, const NarrowPhase& narrow,
                         WorkerBuffer& buffer) {
  const BodyPair pair = near.pair;
  const bool sphere_is_a = particles.is_sphere(pair.a), one_per_piece = narrow.rule->one_per_piece;
  const int sphere = sphere_is_a ? pair.a : pair.b, body = sphere_is_a ? pair.b : pair.a;
  const double r = particles.radius[sphere], place = particles.contact_place(body, sphere),
               reach = particles.halo[sphere] + particles.halo[body];
  const std::size_t first = buffer.contacts.size();
  for (int k = near.first; k < near.first + near.count; ++k) {
    const PointOnTriangle& at = buffer.near_points[k];
    const double distance = std::sqrt(at.distance2), gap = distance - r;
    if (gap >= reach) continue;
    if (gap <= 0) {
      ++buffer.crossings;
      continue;
    }
    const int number = buffer.near_numbers[k], feature = one_per_piece ? particles.mesh[body]->part[number] : number,
              a = sphere_is_a ? 0 : feature, b = sphere_is_a ? feature : 0;
    const Vector3d to_centre = particles.orientation[body] * eigen(-1. * at.point), normal = to_centre / distance;
    const Touch touch{pair.a,
                      pair.b,
                      a,
                      b,
                      particles.position[sphere] - to_centre + place * gap * normal,
                      sphere_is_a ? normal : (-normal).eval(),
                      reach - gap};
    const auto own = std::span(buffer.contacts).subspan(first);
    const auto same =
        one_per_piece ? std::ranges::find_if(own, [&](const Touch& t) { return t.feature_a == a && t.feature_b == b; })
                      : own.end();
    if (same == own.end())
      buffer.contacts.push_back(touch);
    else if (touch.overlap > same->overlap)
      *same = touch;
  }
  if (buffer.contacts.size() == first) return;
  if (one_per_piece)
    settle_pieces(particles, std::span(buffer.contacts).subspan(first));
  else
    reduce(particles, first, narrow, buffer);
  book(pair, first, buffer);
}

/// Contacts of all spheres with the meshes whose triangles are noted.
void collide_noted(const Particles& particles, const NarrowPhase& narrow, WorkerBuffer& buffer) {
  if (buffer.near_meshes.empty()) return;
  buffer.kernel.triangle_pairs += buffer.near_triangles.size();
  closest_to_origin(buffer.near_triangles.view(), buffer.near_points);
  for (const WorkerBuffer::NearMesh& near : buffer.near_meshes) collide_sphere_mesh(particles, near, narrow, buffer);
  buffer.near_meshes.clear(), buffer.near_numbers.clear(), buffer.near_triangles.clear();
}

/// The kernel on triangle pairs of two bodies, `b` in the frame of A; appended to `hits`.
void solve(const Particles& particles, BodyPair pair, TrianglesView b, std::span<const PairIndex> triangles,
           double reach, const NarrowPhase& narrow, WorkerBuffer& buffer, Hits& hits) {
  narrow.kernel->closest({particles.mesh[pair.a]->triangles.view(), b, triangles}, {.reach = reach}, hits,
                         buffer.kernel);
}

/// Contacts in the world of triangle pairs; number_b: of each triangle of B in its mesh.
void add_contacts(const Particles& particles, BodyPair pair, std::span<const int> number_b, const Hits& hits,
                  WorkerBuffer& buffer) {
  if (hits.empty()) return;
  const Eigen::Matrix3d to_world = particles.orientation[pair.a].toRotationMatrix();
  const double place = particles.contact_place(pair.a, pair.b);
  for (int k = 0; k < hits.size(); ++k) {
    const Hit hit = hits[k];
    const Vector3d p = eigen(hit.closest.p), q = eigen(hit.closest.q);
    add_contact(pair, hit.i, number_b[hit.j], particles.position[pair.a] + to_world * ((1 - place) * p + place * q),
                to_world * (p - q), buffer);
  }
}

/// Hands the candidates in the buffer over, cut into parts.
SplitPair* split_up(BodyPair pair, const Placement& b_in_a, WorkerBuffer& buffer, SplitPairs& into) {
  SplitPair& split = into.next();
  split.pair = pair;
  split.b_in_a = b_in_a;
  split.reach = buffer.reach;
  std::swap(split.candidates, buffer.candidates);
  split.parts = (static_cast<int>(split.candidates.pairs.size()) + part_size - 1) / part_size;
  split.parts_left.store(split.parts, std::memory_order_relaxed);
  if (split.hits.size() < static_cast<std::size_t>(split.parts)) split.hits.resize(split.parts);
  return &split;
}

// --- two meshes

/// Do two meshes touch by corners and edges?
bool touch_by_features(const Particles& particles, BodyPair pair, const ContactRule& rule) {
  return rule.of_features && !particles.mesh[pair.a]->features.curved && !particles.mesh[pair.b]->features.curved;
}

void add_contacts_of_features(const Particles& particles, BodyPair pair, const Placement& b_in_a,
                              const FeaturePairs& near, WorkerBuffer& buffer) {
  const std::size_t first = buffer.contacts.size();
  add_feature_contacts(particles, pair, b_in_a, near, buffer.reach, buffer.contacts);
  if (buffer.contacts.size() > first) set_collective_mass(particles, std::span(buffer.contacts).subspan(first));
}

/// Finds the features that are nearer than `reach`, from the triangle pairs that are: and how far they may move until
/// others come within reach of the halos, or surfaces may cross (m). Once some do, nothing further than the halos
/// counts.
double find_features(const Particles& particles, BodyPair pair, const Placement& b_in_a, std::span<const int> number_b,
                     std::span<const Hits> parts, double reach, WorkerBuffer& buffer, FeaturePairs& features) {
  NearFaces &a = buffer.near_faces_a, &b = buffer.near_faces_b;
  a.mesh = particles.mesh[pair.a].get(), b.mesh = particles.mesh[pair.b].get();
  a.faces.clear(), b.faces.clear();
  double closest = reach;
  const auto for_hits = [&](const auto& visit) {
    for (const Hits& hits : parts)
      for (int k = 0; k < hits.size(); ++k) visit(hits[k]);
  };
  for_hits([&](const Hit& hit) {
    closest = std::min(closest, hit.closest.distance);
    if (hit.closest.distance == 0) ++buffer.crossings;
  });
  const double near = closest > 0 ? reach : buffer.reach;
  for_hits([&](const Hit& hit) {
    if (hit.closest.distance == 0 || hit.closest.distance > near) return;
    a.faces.push_back(hit.i);
    b.faces.push_back(number_b[hit.j]);
  });
  find_feature_pairs(a, b, b_in_a, buffer.reach, near - buffer.reach, features);
  return std::min(closest, near - buffer.reach);
}

/// Searches two meshes for what is near, keeps that in `near`, and adds their contacts.
SplitPair* search(const Particles& particles, BodyPair pair, const RelativePose& pose, const NarrowPhase& narrow,
                  KeptPair& near, WorkerBuffer& buffer, SplitPairs* split) {
  ++buffer.searched_pairs;
  near.forget();
  const Placement b_in_a = placement_of(pose);
  const double margin = margin_of(narrow, buffer.reach), reach = buffer.reach + margin;
  Candidates& candidates = buffer.candidates;
  narrow.precheck->pairs(view_of(particles, pair.a), view_of(particles, pair.b), b_in_a, reach, candidates);
  if (split && static_cast<int>(candidates.pairs.size()) > part_size) return split_up(pair, b_in_a, buffer, *split);
  buffer.hits.clear();
  solve(particles, pair, candidates.b.view(), candidates.pairs, reach, narrow, buffer, buffer.hits);
  const std::size_t first = buffer.contacts.size();
  double room = margin;
  near.of_features = touch_by_features(particles, pair, *narrow.rule);
  if (near.of_features) {
    room = find_features(particles, pair, b_in_a, candidates.number_b, {&buffer.hits, 1}, reach, buffer, near.features);
    add_contacts_of_features(particles, pair, b_in_a, near.features, buffer);
  } else {
    if (margin > 0) near.keep_triangles(buffer.hits, candidates.number_b);
    add_contacts(particles, pair, candidates.number_b, buffer.hits, buffer);
    reduce(particles, first, narrow, buffer);
  }
  book(pair, first, buffer);
  near.keep(pose, room - rounding_of(particles, pair, pose.centre));
  return nullptr;
}

/// The contacts of two meshes from what is known to be near.
void look_again(const Particles& particles, BodyPair pair, const RelativePose& pose, const NarrowPhase& narrow,
                const KeptPair& near, WorkerBuffer& buffer) {
  if (near.of_features ? near.features.empty() : near.triangles.empty()) return;
  const Placement b_in_a = placement_of(pose);
  const std::size_t first = buffer.contacts.size();
  if (near.of_features) {
    add_contacts_of_features(particles, pair, b_in_a, near.features, buffer);
  } else {
    Candidates& candidates = buffer.candidates;
    candidates.clear();
    place(particles.mesh[pair.b]->triangles.view(), b_in_a, near.triangles_b, candidates.b);
    buffer.hits.clear();
    solve(particles, pair, candidates.b.view(), near.triangles, buffer.reach, narrow, buffer, buffer.hits);
    add_contacts(particles, pair, near.triangles_b, buffer.hits, buffer);
    reduce(particles, first, narrow, buffer);
  }
  book(pair, first, buffer);
}

SplitPair* collide_meshes(const Particles& particles, BodyPair pair, const NarrowPhase& narrow, WorkerBuffer& buffer,
                          SplitPairs* split) {
  const RelativePose pose = relative_pose(particles, pair);
  if (!narrow.kept_pairs) return search(particles, pair, pose, narrow, buffer.kept_pair, buffer, split);
  KeptPair& near = narrow.kept_pairs->of_meshes.of(pair, particles);
  if (!near.is_complete(pose, std::min(particles.radius[pair.a], particles.radius[pair.b])))
    return search(particles, pair, pose, narrow, near, buffer, split);
  look_again(particles, pair, pose, narrow, near, buffer);
  return nullptr;
}

} // namespace

void touch_of_spheres(const Particles& p, BodyPair pair, Touch& touch) {
  const auto [a, b] = pair;
  const Vector3d ab = p.position[b] - p.position[a];
  const double centres = ab.norm(), gap = centres - p.radius[a] - p.radius[b];
  touch.a = a, touch.b = b;
  touch.feature_a = touch.feature_b = 0;
  touch.overlap = p.halo[a] + p.halo[b] - gap;
  touch.normal = -1 / centres * ab;
  touch.point = p.position[a] - (p.radius[a] + p.contact_place(a, b) * gap) * touch.normal;
  touch.share = 1;
  touch.mass = 1 / (p.inverse_mass[a] + p.inverse_mass[b]);
  touch.push = touch.overlap * touch.normal;
  touch.couple = Vector3d::Zero();
}

void WorkerBuffer::clear() {
  const std::size_t likely = contacts.size() + contacts.size() / 8; // ahead of need: when it comes, vectors double
  if (likely > contacts.capacity()) contacts.reserve(likely + likely / 8);
  contacts.clear();
  found.clear();
  candidate_pairs = body_pairs = searched_pairs = crossings = 0;
  kernel = {};
}

void collide(const Particles& particles, std::span<const BodyPair> pairs, const NarrowPhase& narrow,
             WorkerBuffer& buffer, SplitPairs* split, FunctionRef<void(SplitPair&)> on_split) {
  for (const BodyPair pair : pairs) {
    buffer.reach = particles.halo[pair.a] + particles.halo[pair.b];
    const bool sphere_a = particles.is_sphere(pair.a), sphere_b = particles.is_sphere(pair.b);
    if (sphere_a && sphere_b)
      collide_spheres(particles, pair, buffer);
    else if (sphere_a || sphere_b)
      note_near_triangles(particles, pair, narrow, buffer);
    else if (SplitPair* const handed_over = collide_meshes(particles, pair, narrow, buffer, split))
      on_split(*handed_over);
  }
  collide_noted(particles, narrow, buffer);
}

void solve_part(const Particles& particles, SplitPair& split, int part, const NarrowPhase& narrow,
                WorkerBuffer& buffer) {
  const auto [pair, reach] = std::pair(split.pair, split.reach);
  buffer.reach = reach;
  split.hits[part].clear();
  const std::span pairs = split.candidates.pairs;
  solve(particles, pair, split.candidates.b.view(),
        pairs.subspan(part * part_size, std::min<std::size_t>(part_size, pairs.size() - part * part_size)), reach,
        narrow, buffer, split.hits[part]);
  if (split.parts_left.fetch_sub(1, std::memory_order_acq_rel) > 1) return;
  const std::size_t first = buffer.contacts.size();
  const std::span<const Hits> parts(split.hits.data(), split.parts);
  const std::span<const int> number_b = split.candidates.number_b;
  if (touch_by_features(particles, pair, *narrow.rule)) {
    FeaturePairs& features = buffer.kept_pair.features;
    find_features(particles, pair, split.b_in_a, number_b, parts, reach, buffer, features);
    add_contacts_of_features(particles, pair, split.b_in_a, features, buffer);
  } else {
    for (const Hits& hits : parts) add_contacts(particles, pair, number_b, hits, buffer);
    reduce(particles, first, narrow, buffer);
  }
  book(pair, first, buffer);
}

} // namespace trigrain
