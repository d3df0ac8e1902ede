#include "dem/mesh.hpp"
#include "dem/random.hpp"
#include "kernels/name_table.hpp"
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <map>
#include <memory>
#include <new>
#include <numbers>
#include <utility>
extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace trigrain {
namespace {

using Eigen::Vector3d;
using Face = std::array<int, 3>;

void require_lengths(const char* shape, std::initializer_list<double> lengths) {
  for (const double l : lengths)
    if (!(std::isfinite(l) && l > 0))
      throw InputError("a length is " + std::to_string(l) + " (" + shape + "). Give positive finite lengths in m.");
}

void require_count(const char* shape, const char* what, int count, int lowest, int highest) {
  if (count < lowest || count > highest)
    throw InputError(std::string(what) + " is " + std::to_string(count) + " (" + shape + "). Give a number from " +
                     std::to_string(lowest) + " to " + std::to_string(highest) + ".");
}

/// Two triangles for each of the six faces of a hexahedron; corner number = x + 2 y + 4 z with x, y, z in {0, 1}.
void append_hexahedron(const std::array<Vector3d, 8>& corners, std::vector<Vector3d>& vertices,
                       std::vector<Face>& faces) {
  constexpr std::array<std::array<int, 4>, 6> quads{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  const int first = static_cast<int>(vertices.size());
  vertices.insert(vertices.end(), corners.begin(), corners.end());
  for (const auto& [a, b, c, d] : quads) {
    faces.push_back({first + a, first + b, first + c});
    faces.push_back({first + a, first + c, first + d});
  }
}

/// Faces of the convex hull of the points, counter-clockwise seen from outside (Barber, Dobkin, Huhdanpaa 1996).
std::vector<Face> convex_hull(std::vector<Vector3d>& points) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> silent(std::fopen("/dev/null", "w"), std::fclose);
  qhT qh;
  qh_zero(&qh, silent.get());
  char command[] = "qhull Qt"; // Qt: facets of more than three corners come as triangles
  const int failed = qh_new_qhull(&qh, 3, static_cast<int>(points.size()), points.front().data(), False, command,
                                  nullptr, silent.get());
  std::vector<Face> faces;
  for (facetT* facet = qh.facet_list; !failed && facet && facet->next; facet = facet->next) {
    Face& face = faces.emplace_back();
    for (int k = 0; k < 3; ++k) face[k] = qh_pointid(&qh, static_cast<vertexT*>(facet->vertices->e[k].p)->point);
    if (facet->toporient == qh_ORIENTclock) std::swap(face[1], face[2]);
  }
  qh_freeqhull(&qh, qh_ALL);
  int left_long, left_bytes;
  qh_memfreeshort(&qh, &left_long, &left_bytes); // its pools: 128 KiB per hull
  if (failed == qh_ERRmem) throw std::bad_alloc();
  if (failed) throw InputError("the points have no convex hull of positive volume (granulate). Take another seed.");
  return faces;
}

} // namespace

Mesh box(const Vector3d& size, int subdivide) {
  require_lengths("box", {size.x(), size.y(), size.z()});
  require_count("box", "subdivide", subdivide, 1, 512);
  std::vector<Vector3d> vertices;
  std::vector<Face> faces;
  const int n = subdivide;
  // The same bits for i on one face and n on its neighbour; exactly +-1/2 at the ends.
  const auto coordinate = [&](int axis, int i) { return size[axis] * ((2. * i - n) / (2. * n)); };
  for (int axis = 0; axis < 3; ++axis)
    for (const int end : {0, n}) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3, first = static_cast<int>(vertices.size());
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i) {
          Vector3d& p = vertices.emplace_back();
          p[axis] = coordinate(axis, end), p[u] = coordinate(u, i), p[v] = coordinate(v, j);
        }
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
          const int a = first + j * (n + 1) + i, b = a + 1, c = b + n + 1, d = a + n + 1;
          if (end == n) {
            faces.push_back({a, b, c}), faces.push_back({a, c, d});
          } else {
            faces.push_back({a, c, b}), faces.push_back({a, d, c});
          }
        }
    }
  return make_mesh("box", std::move(vertices), std::move(faces));
}

Mesh icosphere(double radius, int level) {
  require_lengths("icosphere", {radius});
  require_count("icosphere", "level", level, 0, 8);
  const double t = std::numbers::phi;
  std::vector<Vector3d> points{{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                               {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  std::vector<Face> faces{{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                          {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                          {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (Vector3d& p : points) p.normalize();
  for (int l = 0; l < level; ++l) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [at, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<int>(points.size()));
      if (is_new) points.push_back((points[a] + points[b]).normalized());
      return at->second;
    };
    std::vector<Face> finer;
    finer.reserve(4 * faces.size());
    for (const auto& [a, b, c] : faces) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    faces = std::move(finer);
  }
  for (Vector3d& p : points) p *= radius;
  Mesh mesh = make_mesh("icosphere", std::move(points), std::move(faces));
  mesh.curvature_radius = radius;
  return mesh;
}

Mesh granulate(double diameter, int points, std::uint64_t seed) {
  require_lengths("granulate", {diameter});
  require_count("granulate", "the number of points", points, 4, 10000);
  Random random(seed);
  std::vector<Vector3d> vertices;
  for (int i = 0; i < points; ++i) {
    const Vector3d direction = random.direction();
    vertices.push_back(direction * (.75 + .25 * random.uniform()));
  }
  std::vector<Face> faces = convex_hull(vertices);
  for (Vector3d& p : vertices) p *= diameter / 2;
  return make_mesh("granulate", std::move(vertices), std::move(faces));
}

Mesh hopper(double width, double height, double opening, double thickness) {
  require_lengths("hopper", {width, height, opening, thickness});
  if (opening > width)
    throw InputError("the opening is wider than the top (hopper). Give an opening of at most the width.");
  // Plates as prisms between the planes y = +-height/2. Measured along y = const they are thicker by 1 / cos(slope).
  const double run = (width - opening) / 2, wall = thickness * std::hypot(1., run / height);
  std::vector<Vector3d> vertices;
  std::vector<Face> faces;
  for (int turn = 0; turn < 4; ++turn) {
    // Each plate ends half a wall beyond the corner, inside its neighbour: no gap, and no vertex in common.
    std::array<Vector3d, 8> corners;
    for (int c = 0; c < 8; ++c) {
      const double inner = (c & 2 ? width : opening) / 2;
      const double x = inner + (c & 1 ? wall : 0), y = (c & 2 ? height : -height) / 2;
      const double z = (c & 4 ? 1 : -1) * (inner + wall / 2);
      const std::array<std::pair<double, double>, 4> turned{{{x, z}, {z, -x}, {-x, -z}, {-z, x}}};
      corners[c] = {turned[turn].first, y, turned[turn].second};
    }
    append_hexahedron(corners, vertices, faces);
  }
  return make_mesh("hopper", std::move(vertices), std::move(faces));
}

Mesh plane(double size) {
  require_lengths("plane", {size});
  const double h = size / 2;
  return make_mesh("plane", {{-h, 0, -h}, {-h, 0, h}, {h, 0, h}, {h, 0, -h}}, {{0, 1, 2}, {0, 2, 3}});
}

} // namespace trigrain
