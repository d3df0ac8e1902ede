// Pre-checks: their table, the two that work on lists of triangles, and what they share.
#include "kernels/placement.hpp"
#include "kernels/sphere.hpp"
#include <numeric>

namespace trigrain {

using Point = Vec3<double>;

/// Box that holds the turned and moved box of B.
Box placed(const Box& b, const Placement& at) {
  const Point middle{(b.low[0] + b.high[0]) / 2, (b.low[1] + b.high[1]) / 2, (b.low[2] + b.high[2]) / 2};
  const Point half{(b.high[0] - b.low[0]) / 2, (b.high[1] - b.low[1]) / 2, (b.high[2] - b.low[2]) / 2};
  const Point m = placed(middle, at);
  const auto reach = [&](const Point& row) {
    return std::fabs(row.x) * half.x + std::fabs(row.y) * half.y + std::fabs(row.z) * half.z;
  };
  const Point h{reach(at.rows[0]), reach(at.rows[1]), reach(at.rows[2])};
  return {{m.x - h.x, m.y - h.y, m.z - h.z}, {m.x + h.x, m.y + h.y, m.z + h.z}};
}

FLATTEN_OCTETS void place(TrianglesView b, const Placement& at, std::span<const int> numbers, Triangles& in_a) {
  in_a.resize(static_cast<int>(numbers.size()));
  const std::array<Vec3<Octet>, 3> rows{in_octet(at.rows[0]), in_octet(at.rows[1]), in_octet(at.rows[2])};
  const Vec3<Octet> translation = in_octet(at.translation);
  for (std::size_t first = 0; first < numbers.size(); first += 8) {
    int c = 0;
    for (const Vec3<Octet>& x : corners_of(b, numbers, first)) {
      store(dot(rows[0], x) + translation.x, in_a.coordinate(c++) + first);
      store(dot(rows[1], x) + translation.y, in_a.coordinate(c++) + first);
      store(dot(rows[2], x) + translation.z, in_a.coordinate(c++) + first);
    }
  }
}

PairIndex* room_for_pairs(Candidates& c, std::size_t count) {
  if (c.list.size() < count) c.list.resize(count);
  return c.list.data();
}

namespace {

// --- none and sphere: lists of triangles, every one of A's against every one of B's

void pair_all(const MeshView& b, const Placement& at, Candidates& c) {
  place(b.triangles, at, c.number_b, c.b);
  PairIndex* next = room_for_pairs(c, c.near_a.size() * c.b.size());
  for (int i : c.near_a)
    for (int j = 0; j < c.b.size(); ++j) *next++ = {i, j};
  c.pairs = {c.list.data(), next};
}

void all_triangles(const MeshView& mesh, const Point&, double, std::vector<int>& indices) {
  indices.resize(mesh.triangles.size);
  std::iota(indices.begin(), indices.end(), 0);
}

void pairs_of_all(const MeshView& a, const MeshView& b, const Placement& at, double, Candidates& c) {
  c.clear();
  all_triangles(a, {}, 0, c.near_a);
  all_triangles(b, {}, 0, c.number_b);
  pair_all(b, at, c);
}

void triangles_by_sphere(const MeshView& mesh, const Point& point, double reach, std::vector<int>& indices) {
  triangles_near_point(mesh.triangles, point, reach, indices);
}

void pairs_by_sphere(const MeshView& a, const MeshView& b, const Placement& at, double reach, Candidates& c) {
  c.clear();
  triangles_near_point(a.triangles, at.translation, b.octree->radius() + reach, c.near_a);
  if (c.near_a.empty()) return;
  triangles_near_point(b.triangles, -1. * turned_back(at.translation, at), a.octree->radius() + reach, c.number_b);
  pair_all(b, at, c);
}

constexpr Precheck table[] = {
    {"none", "every triangle pair of every candidate body pair", false, pairs_of_all, all_triangles},
    {"sphere", "bounding spheres of the bodies, then triangles against the other body's sphere", true, pairs_by_sphere,
     triangles_by_sphere},
    {"box", "a separating direction and its slab, then boxes and planes of triangles: for small meshes", true,
     pairs_by_box, triangles_by_octree},
    {"octree", "hierarchical cubic cuts of both bodies, refined where they meet: for large meshes", true,
     pairs_by_octree, triangles_by_octree},
};

} // namespace

std::span<const Precheck> prechecks() { return table; }

} // namespace trigrain
