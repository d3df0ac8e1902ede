#pragma once
#include "kernels/lanes.hpp"
#include "kernels/triangles.hpp"
#include <array>
#include <span>
#include <vector>

namespace trigrain {

/// Axis-parallel box (m); empty, and far from everything, if low > high.
struct Box {
  std::array<double, 3> low, high;
};

using Octet = Pack<double, 8>;

/// Eight boxes, to be tested at once.
struct alignas(cache_line) BoxOctet {
  std::array<std::array<double, 8>, 3> low, high;
};

/// Flat cylinder (m): points within half_height of the plane through `centre` and within `radius` of the axis. Around a
/// smooth piece of surface of size s it is of height s^2, where a box has s: without it the pairs of cuts that two
/// touching spheres leave would grow with the fineness of their meshes.
struct Disc {
  Vec3<double> centre, normal; ///< normal of length 1
  double half_height, radius;
};

/// Eight discs.
struct alignas(cache_line) DiscOctet {
  std::array<std::array<double, 8>, 3> centre, normal;
  std::array<double, 8> half_height, radius;
};

/// Cubic cut of a surface: boxes, discs and numbers of up to eight smaller cuts, or of up to eight triangles in a leaf.
struct Cut {
  BoxOctet boxes;
  DiscOctet discs;
  std::array<int, 8> entry; ///< of cuts or triangles; those of empty boxes mean nothing
  Box box;                  ///< of all
  Disc disc;                ///< of all
  bool leaf;
};

/// How deep an octree cuts: each cube as its triangles need, or all of them as the one that needs most.
enum class Cuts { adaptive, regular };

/// A mesh as the pre-checks want it, in its body frame; built once per mesh. The octree halves cubes until at most
/// eight triangles have their middle in one, and keeps the box of what is inside: Krestenitis (2018), hierarchical
/// cubic cuts, here with tight boxes so that a triangle belongs to one cut only.
class Octree {
 public:
  Octree() = default;
  /// Copies what it needs; triangle k of `triangles` keeps its number. At least one triangle.
  Octree(std::span<const Vec3<double>> vertices, TrianglesView triangles, Cuts cuts = Cuts::adaptive);

  /// Coordinates of the vertices, padded to a multiple of eight with the first.
  std::array<const double*, 3> vertices() const { return {vertex_[0].data(), vertex_[1].data(), vertex_[2].data()}; }
  int vertex_octets() const { return static_cast<int>(vertex_[0].size() / 8); }
  double radius() const { return radius_; } ///< of the bounding sphere about the body frame's origin (m)
  /// Cut 0 holds the whole surface.
  const Cut& cut(int k) const { return cuts_[k]; }
  int cuts() const { return static_cast<int>(cuts_.size()); }

 private:
  struct Builder;
  std::array<std::vector<double>, 3> vertex_;
  std::vector<Cut> cuts_;
  double radius_ = 0;
};

} // namespace trigrain
