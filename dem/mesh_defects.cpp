#include "dem/mesh_defects.hpp"
#include "dem/surface.hpp"
#include "kernels/name_table.hpp"
#include "kernels/precheck.hpp"
#include <sstream>

namespace trigrain {
namespace {

using Eigen::Vector3d;

/// Where the segment pq goes through triangle abc, by more than `least` (m) from all of their ends.
std::optional<Vector3d> through(const Vector3d& p, const Vector3d& q, const std::array<Vector3d, 3>& triangle,
                                double least) {
  const auto& [a, b, c] = triangle;
  const Vector3d normal = (b - a).cross(c - a).normalized(); // of a triangle without area: 0
  const double from = normal.dot(p - a), to = normal.dot(q - a);
  if (!(std::min(from, to) < -least && std::max(from, to) > least)) return {};
  const Vector3d x = p + from / (from - to) * (q - p);
  for (int k = 0; k < 3; ++k) {
    const Vector3d& corner = triangle[k];
    if (!(normal.cross((triangle[(k + 1) % 3] - corner).normalized()).dot(x - corner) > least)) return {};
  }
  return x;
}

} // namespace

std::string in_words(const Vector3d& point) {
  std::ostringstream words;
  words.precision(4);
  words << '(' << point.x() << ", " << point.y() << ", " << point.z() << ')';
  return words.str();
}

std::string why_massless(const Mesh& mesh) {
  int wrong = 0;
  std::string first;
  for (const EdgeUse& edge : edge_uses(mesh.faces, bounding_faces(mesh.faces))) {
    if (edge.is_closed()) continue;
    const int triangles = edge.up + edge.down;
    if (++wrong == 1)
      first = "the edge from " + in_words(mesh.in_shape_frame(mesh.vertices[edge.low])) + " to " +
              in_words(mesh.in_shape_frame(mesh.vertices[edge.high])) + " m " +
              (triangles == 1   ? "has a triangle on one side only"
               : triangles == 2 ? "has two triangles that face different ways"
                                : "belongs to " + std::to_string(triangles) + " triangles");
  }
  if (wrong == 0) return "the surface encloses no volume";
  return first + (wrong > 1 ? ", the first of " + std::to_string(wrong) + " such edges" : "");
}

std::optional<Vector3d> self_crossing(const Mesh& mesh) {
  constexpr double grazing = 1e-6; // of the size: files hold floats
  const MeshView view{mesh.triangles.view(), &mesh.octree};
  const Placement same{{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {0, 0, 0}};
  Candidates candidates;
  row_named(prechecks(), "precheck", "octree").pairs(view, view, same, 0, candidates);
  const auto corners = [&](int face) {
    const auto& f = mesh.faces[face];
    return std::array<Vector3d, 3>{mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]]};
  };
  for (const PairIndex& pair : candidates.pairs) { // each pair of triangles comes both ways round
    const auto edges = corners(pair.i), face = corners(candidates.number_b[pair.j]);
    for (int k = 0; k < 3; ++k)
      if (const auto x = through(edges[k], edges[(k + 1) % 3], face, grazing * mesh.radius))
        return mesh.in_shape_frame(*x);
  }
  return {};
}

} // namespace trigrain
