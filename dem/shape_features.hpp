#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

namespace trigrain {

/// Corners and straight edges of a shape, however its faces are cut into triangles: vertices and sides inside a flat
/// face, and vertices along a straight edge, are no features. Flat and straight: within 1e-6 of the shape's size, ten
/// times what coordinates of float precision leave.
struct ShapeFeatures {
  std::vector<std::array<int, 2>> edges;     ///< the vertices at the ends of each edge
  std::vector<std::array<int, 3>> corner_of; ///< per face: those of its vertices that are corners, else -1
  std::vector<std::array<int, 3>> edge_of;   ///< per face: the edges that its sides k, k + 1 are part of, else -1
  std::vector<std::vector<int>> flats;       ///< corners of each flat face with three of them or more
  bool curved = false; ///< closed, without an edge sharper than 30 degrees: the mesh stands for a curved surface
};

/// `vertices` are distinct points, `faces` counter-clockwise seen from outside.
ShapeFeatures find_features(const std::vector<Eigen::Vector3d>& vertices, const std::vector<std::array<int, 3>>& faces);

} // namespace trigrain
