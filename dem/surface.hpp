#pragma once
#include <array>
#include <vector>

namespace trigrain {

/// Per face (indices of vertices, of which equal ones are one): does it bound a solid? Faces whose corners coincide and
/// repetitions of a face do not.
std::vector<char> bounding_faces(const std::vector<std::array<int, 3>>& faces);

/// An edge between vertices low < high, and how many of the faces that bound a solid run it from low to high (up) and
/// back (down).
struct EdgeUse {
  int low, high;
  int up, down;
  bool is_closed() const { return up == 1 && down == 1; }
};

/// All edges of the faces for which `bounds` says so, sorted by (low, high).
std::vector<EdgeUse> edge_uses(const std::vector<std::array<int, 3>>& faces, const std::vector<char>& bounds);

} // namespace trigrain
