#pragma once
#include "kernels/kernels.hpp"
#include "kernels/octree.hpp"
#include <span>
#include <string_view>
#include <vector>

namespace trigrain {

/// Where body B is, seen from body A: x_a = rotation x_b + translation (m).
struct Placement {
  std::array<Vec3<double>, 3> rows; ///< of the rotation
  Vec3<double> translation;
};

/// A mesh: its triangles and what pre-checks know of them, in its body frame.
struct MeshView {
  TrianglesView triangles;
  const Octree* octree;
};

/// The triangle pairs of two meshes that a pre-check leaves, and scratch memory. B's triangles are those that some
/// pair needs, in A's frame; the same triangle has the same bits whatever the pre-check.
struct Candidates {
  Triangles b;                      ///< in A's frame (m)
  std::vector<int> number_b;        ///< of each triangle of `b` in its mesh
  std::span<const PairIndex> pairs; ///< i in mesh A, j in `b`; ascending in (i, number_b[j])

  void clear() {
    b.clear();
    number_b.clear();
    pairs = {};
  }

  // scratch of the pre-checks
  std::vector<PairIndex> list; ///< holds `pairs`; never shrinks
  std::vector<int> near_a;
  Column<double> facets_a, facets_b;
  std::vector<int> place; ///< of each triangle of B in `b`; -1 between calls
};

/// Cheap tests before the kernel. Conservative: no pair with distance <= reach is lost.
struct Precheck {
  std::string_view name;
  std::string_view about;
  bool spheres; ///< are bodies whose bounding spheres are further apart than reach left out before?
  /// Candidates of two meshes.
  void (*pairs)(const MeshView& a, const MeshView& b, const Placement& b_in_a, double reach, Candidates& candidates);
  /// Ascending numbers of the triangles that may come closer than `reach` to the point (m, the mesh's frame).
  void (*triangles)(const MeshView& mesh, const Vec3<double>& point, double reach, std::vector<int>& indices);
};

std::span<const Precheck> prechecks();

} // namespace trigrain
