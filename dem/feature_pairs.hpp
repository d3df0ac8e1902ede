#pragma once
#include "dem/mesh.hpp"
#include "kernels/precheck.hpp"
#include <array>
#include <span>
#include <vector>

namespace trigrain {

/// Which corners, edges and faces of two meshes are near each other. Vertices are numbered as in Side::vertices.
struct FeaturePairs {
  struct Facet {
    std::array<int, 3> corner;
    int part; ///< connected piece of surface
  };
  struct Corner {
    int at, vertex; ///< in Side::vertices and in the mesh
  };
  struct Edge {
    int from, to;
    int edge; ///< in ShapeFeatures::edges
  };
  struct Side {
    std::vector<int> vertices; ///< of the mesh, each once
    std::vector<Facet> facets;
    std::vector<Corner> corners;
    std::vector<Edge> edges;
  };
  struct Pair {
    int first, second;
  };

  Side a, b;
  std::vector<Pair> corner_of_a, corner_of_b; ///< a corner of that body and a facet of the other one, by corner
  std::vector<Pair> edges; ///< an edge of A and the first of as many of B as are computed with at once, by edge

  bool empty() const { return corner_of_a.empty() && corner_of_b.empty() && edges.empty(); }
  void clear();
};

/// A mesh in contact and those of its faces that are near the other one, in any order.
struct NearFaces {
  const Mesh* mesh;
  std::vector<int> faces;
};

/// Fills `pairs` with the corners, edges and facets of the near faces that are closer than `reach` (m) where B is. The
/// faces are sorted and each is left once.
void find_feature_pairs(NearFaces& a, NearFaces& b, const Placement& b_in_a, double reach, FeaturePairs& pairs);

} // namespace trigrain
