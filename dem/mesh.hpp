#pragma once
#include "dem/shape_features.hpp"
#include "kernels/octree.hpp"
#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace trigrain {

/// A rigid shape made of triangles in its body frame: origin = centre of mass, axes = principal axes of inertia.
/// Open surfaces have no mass properties (volume 0); their body frame is the shape's own and only fixed bodies use
/// them.
struct Mesh {
  std::string name;                      ///< the shape in words, for messages and records
  std::vector<Eigen::Vector3d> vertices; ///< m, body frame
  std::vector<std::array<int, 3>> faces; ///< indices into vertices, counter-clockwise seen from outside
  std::vector<int> part;                 ///< per face: number of its connected piece of surface, from 0
  ShapeFeatures features;                ///< corners and edges of the shape
  Triangles triangles;                   ///< the faces as the kernels want them, in the order of `faces`
  Octree octree;                         ///< boxes and octree of the triangles
  double volume = 0;                     ///< m3
  Eigen::Vector3d inertia{0, 0, 0};      ///< principal moments at density 1 (m5)
  Eigen::Vector3d origin{0, 0, 0};       ///< centre of mass in the shape's own frame (m)
  Eigen::Quaterniond axes{1, 0, 0, 0};   ///< turn the body frame into the shape's own
  double curvature_radius =              ///< of the smooth surface that the mesh stands for (m); infinite if flat
      std::numeric_limits<double>::infinity();
  double radius = 0; ///< of the bounding sphere about the body frame's origin (m)

  /// x (m, body frame) in the shape's own frame.
  Eigen::Vector3d in_shape_frame(const Eigen::Vector3d& x) const { return origin + axes * x; }
};

/// Finishes a mesh from vertices and faces in the shape's own frame (m): merges equal vertices, numbers the connected
/// pieces, and where all pieces are closed finds volume, centre and principal inertia from signed tetrahedra (Tonon
/// 2004). Closed pieces are turned outward, those inside another inward (cavities); the mass of pieces that overlap
/// counts twice. Closed means that every edge is used once in each direction. Faces without area and repeated faces
/// stay, for they do no harm to contact, but do not open a surface. A surface that is not closed, or encloses nothing,
/// has volume 0. InputError if a vertex is not finite, an index is out of range or there are no faces.
Mesh make_mesh(std::string name, std::vector<Eigen::Vector3d> vertices, std::vector<std::array<int, 3>> faces);

/// Fills `triangles` and `octree` from vertices and faces.
void index_triangles(Mesh& mesh, Cuts cuts = Cuts::adaptive);

/// Cuboid of edge lengths `size` (m) about the origin; each face cut into subdivide x subdivide oblongs of two
/// triangles.
Mesh box(const Eigen::Vector3d& size, int subdivide = 1);

/// Sphere of radius r (m) inscribed by an icosahedron whose triangles are cut in four `level` times.
Mesh icosphere(double radius, int level);

/// Convex hull of `points` >= 4 random points: uniform directions, radius uniform in [.75, 1] diameter / 2 (m); seeded,
/// the same points on every machine (the turn into the body frame may differ in the last bits). At most 2 points - 4
/// triangles. Krestenitis (2018) calls `points` vertices per particle. InputError for fewer.
Mesh granulate(double diameter, int points, std::uint64_t seed);

/// Funnel of four plates about the origin, y up: `width` at the top, `opening` at the bottom (both inside, square), and
/// wall `thickness` (m), measured square to the wall. Each plate is a closed convex piece of its own; at the corners
/// they overlap by half a wall, so that the funnel is tight.
Mesh hopper(double width, double height, double opening, double thickness);

/// Open square of edge `size` (m) in the plane y = 0, facing +y.
Mesh plane(double size);

/// Reads STL, OBJ, PLY or OFF and multiplies by `scale` (m per file unit). Coordinates have the precision of float.
/// InputError names the file, the line where the format has lines, and what to do.
Mesh load_mesh(const std::filesystem::path& file, double scale = 1);

} // namespace trigrain
