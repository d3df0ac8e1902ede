// FCL (BSD-3): TriangleDistance, after Gottschalk's PQP, and the distance of two BVHs of oriented boxes.
#include "experiments/kernel_bench/contestant.hpp"
#include "experiments/kernel_bench/peer.hpp"
#include <fcl/fcl.h>
#include <fcl/narrowphase/detail/primitive_shape_algorithm/triangle_distance.h>
#include <map>

namespace trigrain {
namespace {

using Vector = fcl::Vector3d;
using Corners = std::array<Vector, 3>;
using Bvh = fcl::BVHModel<fcl::OBBRSS<double>>;

Vec3<double> ours(const Vector& v) { return {v.x(), v.y(), v.z()}; }

TrianglePass on_triangles(const Problem& problem, const Query&) {
  std::vector<std::pair<Corners, Corners>> pairs;
  for (const Pair& pair : problem.pairs) {
    const auto corners = [](const Triangle& t) {
      const auto v = [&](int k) { return Vector(corner(t, k).x, corner(t, k).y, corner(t, k).z); };
      return Corners{v(0), v(1), v(2)};
    };
    pairs.emplace_back(corners(pair.a), corners(pair.b));
  }
  return [pairs = std::move(pairs)](int first, int count, Hits& hits, KernelCounts& counts) {
    for (int k = first; k < first + count; ++k) {
      Vector p, q;
      const auto& [a, b] = pairs[k];
      const double d = fcl::detail::TriangleDistance<double>::triDistance(a.data(), b.data(), p, q);
      hits.push_back({k, k, unbounded(ours(p), ours(q), d)});
    }
    counts.triangle_pairs += count;
  };
}

std::shared_ptr<Bvh> bvh(const Mesh& mesh) {
  auto model = std::make_shared<Bvh>();
  std::vector<fcl::Triangle> faces;
  for (const auto& face : mesh.faces) faces.emplace_back(face[0], face[1], face[2]);
  model->beginModel();
  model->addSubModel(mesh.vertices, faces);
  model->endModel();
  return model;
}

MeshPass on_meshes(const MeshProblem& problem, const Query&, const Precheck&) {
  std::map<const Mesh*, std::shared_ptr<Bvh>> models;
  for (const auto& mesh : problem.meshes) models[mesh.get()] = bvh(*mesh);
  struct Placed {
    std::shared_ptr<Bvh> a, b;
    fcl::Transform3d b_in_a = fcl::Transform3d::Identity();
  };
  std::vector<Placed> pairs;
  for (const MeshPair& pair : problem.pairs) {
    Placed& placed = pairs.emplace_back(Placed{models[pair.a], models[pair.b]});
    placed.b_in_a.linear() = pair.rotation;
    placed.b_in_a.translation() = pair.translation;
  }
  return [pairs = std::move(pairs), reach = problem.reach](int k, Hits& hits, KernelCounts&) {
    const Placed& placed = pairs[k];
    const fcl::DistanceRequest<double> request(true); // with both points
    fcl::DistanceResult<double> result;
    const double d =
        fcl::distance(placed.a.get(), fcl::Transform3d::Identity(), placed.b.get(), placed.b_in_a, request, result);
    if (d <= reach)
      hits.push_back({static_cast<int>(result.b1), static_cast<int>(result.b2),
                      unbounded(ours(result.nearest_points[0]), ours(result.nearest_points[1]), d)});
  };
}

} // namespace

Contestant fcl_contestant() {
  return {"fcl",   "double",     1,        "FCL: TriangleDistance; for meshes, distance of two BVHs (OBBRSS)",
          nullptr, on_triangles, on_meshes};
}

} // namespace trigrain
