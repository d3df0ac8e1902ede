#pragma once
#include "dem/mesh.hpp"
#include "kernels/precheck.hpp"
#include "kernels/proof/proof.hpp"
#include <functional>
#include <string>
#include <vector>

namespace trigrain {

/// Pairs of meshes: B stands at x_a = rotation x_b + translation, seen from A (m).
struct MeshPair {
  const Mesh *a, *b;
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;

  Placement placement() const;
};
struct MeshProblem {
  std::vector<std::unique_ptr<Mesh>> meshes;
  std::vector<MeshPair> pairs;
  double reach; ///< contacts are triangles at most so far apart (m)
  int size() const { return static_cast<int>(pairs.size()); }
};

/// What is timed: appends the answers for `count` pairs of a triangle problem from number `first` on, or for mesh pair
/// k.
using TrianglePass = std::function<void(int first, int count, Hits&, KernelCounts&)>;
using MeshPass = std::function<void(int k, Hits&, KernelCounts&)>;

/// A way to find closest points, ours or somebody else's. `on_triangles` and `on_meshes` turn a problem into the
/// contestant's own types, which is not timed; empty where it has no answer to that question.
struct Contestant {
  std::string name, precision;
  int lanes = 1;
  std::string about;
  const Kernel* kernel = nullptr; ///< if it is one of ours
  std::function<TrianglePass(const Problem&, const Query&)> on_triangles;
  std::function<MeshPass(const MeshProblem&, const Query&, const Precheck&)> on_meshes;
};

/// Those of this build, ours first.
std::vector<Contestant> contestants();

// One file each; those whose library is not there are not built.
std::vector<Contestant> our_kernels();
Contestant fcl_contestant();
Contestant cgal_contestant();
Contestant bullet_contestant();
Contestant ode_contestant();

} // namespace trigrain
