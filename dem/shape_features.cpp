#include "dem/shape_features.hpp"
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace trigrain {
namespace {

using Eigen::Vector3d;
using Face = std::array<int, 3>;

constexpr double flatness = 1e-6;                    // of the shape's size
constexpr double sharp_angle = std::numbers::pi / 6; // between the normals of neighbours

/// A side that faces share: vertices low < high, and where it is a side of a face.
struct Side {
  int low, high, face, k;
};

std::vector<Side> sides_of(const std::vector<Face>& faces) {
  std::vector<Side> sides;
  for (int f = 0; f < static_cast<int>(faces.size()); ++f)
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(faces[f][k], faces[f][(k + 1) % 3]);
      if (low != high) sides.push_back({low, high, f, k});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& l, const Side& r) {
    return l.low != r.low ? l.low < r.low : l.high != r.high ? l.high < r.high : l.face < r.face;
  });
  return sides;
}

/// Calls visit(first, last) for the sides of each pair of vertices.
template <class Visit> void for_each_segment(const std::vector<Side>& sides, const Visit& visit) {
  for (std::size_t first = 0, last; first < sides.size(); first = last) {
    for (last = first;
         last < sides.size() && sides[last].low == sides[first].low && sides[last].high == sides[first].high;)
      ++last;
    visit(first, last);
  }
}

/// What the search works on.
struct Shape {
  const std::vector<Vector3d>& vertices;
  const std::vector<Face>& faces;
  double tolerance;             // m
  std::vector<Vector3d> normal; // unit; 0 for faces without area
  std::vector<double> area;

  Shape(const std::vector<Vector3d>& v, const std::vector<Face>& f) : vertices(v), faces(f) {
    Eigen::AlignedBox3d box;
    for (const Vector3d& x : v) box.extend(x);
    tolerance = flatness * box.diagonal().norm();
    for (const Face& face : f) {
      const Vector3d e = v[face[1]] - v[face[0]], g = v[face[2]] - v[face[0]], n = e.cross(g);
      area.push_back(n.norm());
      const bool thin = area.back() <= tolerance * std::max({e.norm(), g.norm(), (e - g).norm()});
      normal.push_back(thin ? Vector3d::Zero().eval() : (n / area.back()).eval());
    }
  }
};

/// Number of the flat piece of surface that each face belongs to. Grown from the largest face and measured from its
/// plane, so that many shallow edges do not add up to a bend.
std::vector<int> flat_pieces(const Shape& s, const std::vector<Side>& sides) {
  std::vector<std::vector<int>> neighbours(s.faces.size());
  for_each_segment(sides, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      for (std::size_t j = first; j < last; ++j)
        if (i != j) neighbours[sides[i].face].push_back(sides[j].face);
  });
  std::vector<int> order(s.faces.size()), piece(s.faces.size(), -1), stack;
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int l, int r) { return s.area[l] > s.area[r]; });
  int pieces = 0;
  for (const int seed : order) {
    if (piece[seed] >= 0) continue;
    const Vector3d n = s.normal[seed], o = s.vertices[s.faces[seed][0]];
    const auto in_plane = [&](int f) {
      if (n.isZero(0) || (!s.normal[f].isZero(0) && s.normal[f].dot(n) < .5)) return false;
      return std::all_of(s.faces[f].begin(), s.faces[f].end(),
                         [&](int v) { return std::abs(n.dot(s.vertices[v] - o)) <= s.tolerance; });
    };
    piece[seed] = pieces;
    stack.assign(1, seed);
    while (!stack.empty()) {
      const int f = stack.back();
      stack.pop_back();
      for (const int g : neighbours[f])
        if (piece[g] < 0 && in_plane(g)) piece[g] = pieces, stack.push_back(g);
    }
    ++pieces;
  }
  return piece;
}

/// A part of an edge between two vertices; `edge` is the edge it was found to belong to.
struct Segment {
  std::size_t first, last; // its sides
  int low, high;
  int edge = -1;
  int other(int v) const { return v == low ? high : low; }
};

/// Segments where flat pieces meet or the surface ends. Notes whether the shape is curved.
std::vector<Segment> bent_segments(const Shape& s, const std::vector<Side>& sides, const std::vector<int>& piece,
                                   bool& curved) {
  std::vector<Segment> segments;
  curved = true;
  for_each_segment(sides, [&](std::size_t first, std::size_t last) {
    bool flat = last - first > 1, sharp = last - first == 1;
    for (std::size_t i = first + 1; i < last; ++i) {
      flat &= piece[sides[i].face] == piece[sides[first].face];
      sharp |= s.normal[sides[i].face].dot(s.normal[sides[first].face]) < std::cos(sharp_angle);
    }
    if (flat) return;
    segments.push_back({first, last, sides[first].low, sides[first].high});
    curved &= !sharp;
  });
  curved &= !segments.empty();
  return segments;
}

/// Does an edge run straight on through vertex v?
bool passes(const Shape& s, const std::vector<Segment>& segments, const std::vector<int>& at_v, int v) {
  if (at_v.size() != 2) return false;
  const Vector3d u = s.vertices[segments[at_v[0]].other(v)] - s.vertices[v],
                 w = s.vertices[segments[at_v[1]].other(v)] - s.vertices[v];
  return u.dot(w) < 0 && u.cross(w).norm() <= s.tolerance * (u - w).norm();
}

} // namespace

ShapeFeatures find_features(const std::vector<Vector3d>& vertices, const std::vector<Face>& faces) {
  const Shape shape(vertices, faces);
  const std::vector<Side> sides = sides_of(faces);
  const std::vector<int> piece = flat_pieces(shape, sides);
  ShapeFeatures found;
  std::vector<Segment> segments = bent_segments(shape, sides, piece, found.curved);
  std::vector<std::vector<int>> at(vertices.size());
  for (int i = 0; i < static_cast<int>(segments.size()); ++i)
    for (const int v : {segments[i].low, segments[i].high}) at[v].push_back(i);
  std::vector<char> corner(vertices.size());
  for (int v = 0; v < static_cast<int>(vertices.size()); ++v)
    corner[v] = !at[v].empty() && !passes(shape, segments, at[v], v);
  // Edges run from corner to corner.
  const auto follow = [&](int start, int segment) {
    const int edge = static_cast<int>(found.edges.size());
    int v = start;
    while (segment >= 0 && segments[segment].edge < 0) {
      segments[segment].edge = edge;
      v = segments[segment].other(v);
      segment = corner[v] ? -1 : at[v][0] == segment ? at[v][1] : at[v][0];
    }
    found.edges.push_back({start, v});
  };
  for (int v = 0; v < static_cast<int>(vertices.size()); ++v)
    if (corner[v])
      for (const int i : at[v])
        if (segments[i].edge < 0) follow(v, i);
  for (Segment& each : segments) // a closed line that bends too little to have corners: every segment is an edge
    if (each.edge < 0) {
      each.edge = static_cast<int>(found.edges.size());
      found.edges.push_back({each.low, each.high});
      corner[each.low] = corner[each.high] = 1;
    }
  found.corner_of.assign(faces.size(), {-1, -1, -1});
  found.edge_of.assign(faces.size(), {-1, -1, -1});
  for (const Segment& each : segments)
    for (std::size_t i = each.first; i < each.last; ++i) found.edge_of[sides[i].face][sides[i].k] = each.edge;
  found.flats.resize(piece.empty() ? 0 : *std::max_element(piece.begin(), piece.end()) + 1);
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (int k = 0; k < 3; ++k)
      if (corner[faces[f][k]]) {
        found.corner_of[f][k] = faces[f][k];
        found.flats[piece[f]].push_back(faces[f][k]);
      }
  for (std::vector<int>& flat : found.flats) {
    std::sort(flat.begin(), flat.end());
    flat.erase(std::unique(flat.begin(), flat.end()), flat.end());
  }
  std::erase_if(found.flats, [](const std::vector<int>& flat) { return flat.size() < 3; });
  return found;
}

} // namespace trigrain
