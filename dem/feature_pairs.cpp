#include "dem/feature_pairs.hpp"
#include "kernels/lanes.hpp"
#include "kernels/placement.hpp"
#include "kernels/point_triangle.hpp"
#include "kernels/segment.hpp"
#include <algorithm>
#include <bit>
#include <cstdint>

namespace trigrain {
namespace {

using Point = Vec3<double>;

Point vec3(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// Axis-parallel box.
struct Bounds {
  Point low, high;
  void extend(const Point& x) {
    low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
  }
  bool near(const Bounds& o, double reach) const {
    return (low.x - o.high.x <= reach) & (o.low.x - high.x <= reach) & (low.y - o.high.y <= reach) &
           (o.low.y - high.y <= reach) & (low.z - o.high.z <= reach) & (o.low.z - high.z <= reach);
  }
};

/// Boxes as structure of arrays: one is compared with many at once.
class BoundsArray {
 public:
  void clear() { size_ = 0; }
  void push_back(const Bounds& b) {
    if (size_ + lane_count > static_cast<int>(column_[0].size())) // the last pack may reach beyond
      for (auto& column : column_) column.resize(size_ + 8 * lane_count);
    const std::array<double, 6> x{b.low.x, b.low.y, b.low.z, b.high.x, b.high.y, b.high.z};
    for (int k = 0; k < 6; ++k) column_[k][size_] = x[k];
    ++size_;
  }
  /// Calls visit(j) for the boxes within reach of `box` (m) in every direction, in order.
  template <class Visit> void for_near(const Bounds& box, double reach, const Visit& visit) const {
    const auto all = [](double x) { return broadcast<Lanes>(x); };
    const Lanes x0 = all(box.low.x - reach), y0 = all(box.low.y - reach), z0 = all(box.low.z - reach),
                x1 = all(box.high.x + reach), y1 = all(box.high.y + reach), z1 = all(box.high.z + reach);
    for (int at = 0; at < size_; at += lane_count) {
      const auto column = [&](int k) { return load<Lanes>(&column_[k][at]); };
      unsigned near = bits_of((column(0) <= x1) & (column(1) <= y1) & (column(2) <= z1) & (column(3) >= x0) &
                              (column(4) >= y0) & (column(5) >= z0));
      if (size_ - at < lane_count) near &= (1u << (size_ - at)) - 1;
      for (; near != 0; near &= near - 1) visit(at + std::countr_zero(near));
    }
  }

 private:
  std::array<std::vector<double>, 6> column_;
  int size_ = 0;
};

/// Numbers that have been met since clear(), with a value each, without clearing memory.
class Numbered {
 public:
  void clear(std::size_t count) {
    if (when_.size() < count) when_.resize(count, 0), value_.resize(count);
    ++now_;
  }
  bool first_time(int i) {
    const bool first = when_[i] != now_;
    when_[i] = now_;
    return first;
  }
  int& operator[](int i) { return value_[i]; }

 private:
  std::vector<std::uint64_t> when_;
  std::vector<int> value_;
  std::uint64_t now_ = 0;
};

/// One body of a pair while its near features are looked for, in the frame of A.
class Search {
 public:
  std::vector<Point> at; ///< of side.vertices
  BoundsArray facets, edges;
  Bounds all; ///< of all facets

  /// Numbers vertices and facets of the faces.
  template <class Place> void gather_facets(NearFaces& near, const Place& place, FeaturePairs::Side& side) {
    auto& [mesh, faces] = near;
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    at.clear(), facets.clear(), edges.clear();
    vertex_.clear(mesh->vertices.size());
    for (const int f : faces) {
      FeaturePairs::Facet& facet = side.facets.emplace_back();
      facet.part = mesh->part[f];
      for (int k = 0; k < 3; ++k) facet.corner[k] = number(mesh->faces[f][k], place, side);
      Bounds box{at[facet.corner[0]], at[facet.corner[0]]};
      box.extend(at[facet.corner[1]]), box.extend(at[facet.corner[2]]);
      facets.push_back(box);
      if (side.facets.size() == 1) all = box;
      all.extend(box.low), all.extend(box.high);
    }
  }

  /// Corners and edges of the facets that are near the other body's facets.
  template <class Place> void gather_features(const NearFaces& near, const Place& place, const Bounds& other,
                                              double reach, FeaturePairs::Side& side) {
    const ShapeFeatures& features = near.mesh->features;
    corner_.clear(near.mesh->vertices.size()), edge_.clear(features.edges.size());
    for (const int f : near.faces) {
      for (const int v : features.corner_of[f]) {
        if (v < 0 || !corner_.first_time(v)) continue;
        const int i = vertex_[v];
        if (other.near({at[i], at[i]}, reach)) side.corners.push_back({i, v});
      }
      for (const int e : features.edge_of[f]) {
        if (e < 0 || !edge_.first_time(e)) continue;
        const auto [v0, v1] = features.edges[e];
        const int from = number(v0, place, side), to = number(v1, place, side);
        Bounds box{at[from], at[from]};
        box.extend(at[to]);
        if (!other.near(box, reach)) continue;
        side.edges.push_back({from, to, e});
        edges.push_back(box);
      }
    }
  }

 private:
  template <class Place> int number(int vertex, const Place& place, FeaturePairs::Side& side) {
    if (vertex_.first_time(vertex)) {
      vertex_[vertex] = static_cast<int>(at.size());
      at.push_back(place(vertex));
      side.vertices.push_back(vertex);
    }
    return vertex_[vertex];
  }

  Numbered vertex_, corner_, edge_;
};

void pair_corners(const FeaturePairs::Side& mine, const Search& my, const FeaturePairs::Side& theirs,
                  const Search& their, double reach, std::vector<FeaturePairs::Pair>& pairs) {
  for (int c = 0; c < static_cast<int>(mine.corners.size()); ++c) {
    const Point& x = my.at[mine.corners[c].at];
    their.facets.for_near({x, x}, reach, [&](int f) {
      const auto& v = theirs.facets[f].corner;
      const Corners<double> seen{their.at[v[0]] - x, their.at[v[1]] - x, their.at[v[2]] - x};
      if (squared(closest_on_triangle_by_zones({0, 0, 0}, seen).point) <= reach * reach) pairs.push_back({c, f});
    });
  }
}

void pair_edges(const FeaturePairs& found, const Search& a, const Search& b, double reach,
                std::vector<FeaturePairs::Pair>& pairs) {
  for (int e = 0; e < static_cast<int>(found.a.edges.size()); ++e) {
    const Point &x0 = a.at[found.a.edges[e].from], &x1 = a.at[found.a.edges[e].to];
    Bounds box{x0, x0};
    box.extend(x1);
    b.edges.for_near(box, reach, [&](int f) {
      const Point &y0 = b.at[found.b.edges[f].from], &y1 = b.at[found.b.edges[f].to];
      const auto [s, t] = closest_on_segments(x0, x1, y0, y1);
      const Point p = x0 + s * (x1 - x0), q = y0 + t * (y1 - y0);
      if (squared(p - q) <= reach * reach) pairs.push_back({e, f});
    });
  }
}

/// Drops what no pair uses, and numbers the rest anew. `edge`: which of a pair of edges is of this side.
void drop_unused(FeaturePairs::Side& side, std::vector<FeaturePairs::Pair>& of_corners,
                 std::vector<FeaturePairs::Pair>& of_facets, std::vector<FeaturePairs::Pair>& of_edges,
                 int FeaturePairs::Pair::*edge) {
  static thread_local std::vector<int> number; // -1: unused
  const auto keep_used = [&](auto& list, const auto& for_users) {
    number.assign(list.size(), -1);
    for_users([&](int& i) { number[i] = 0; });
    int kept = 0;
    for (std::size_t i = 0; i < list.size(); ++i)
      if (number[i] == 0) {
        list[kept] = list[i];
        number[i] = kept++;
      }
    list.resize(kept);
    for_users([&](int& i) { i = number[i]; });
  };
  const auto users = [](std::vector<FeaturePairs::Pair>& pairs, int FeaturePairs::Pair::*item) {
    return [&pairs, item](const auto& visit) {
      for (FeaturePairs::Pair& pair : pairs) visit(pair.*item);
    };
  };
  keep_used(side.corners, users(of_corners, &FeaturePairs::Pair::first));
  keep_used(side.facets, users(of_facets, &FeaturePairs::Pair::second));
  keep_used(side.edges, users(of_edges, edge));
  keep_used(side.vertices, [&](const auto& visit) {
    for (auto& facet : side.facets)
      for (int& v : facet.corner) visit(v);
    for (auto& corner : side.corners) visit(corner.at);
    for (auto& e : side.edges) visit(e.from), visit(e.to);
  });
}

/// Single edges of B become packs of them.
void pack_edges(std::vector<FeaturePairs::Pair>& pairs) {
  std::size_t kept = 0;
  for (const auto& [e, f] : pairs) {
    const FeaturePairs::Pair pack{e, f / lane_count * lane_count};
    if (kept == 0 || pairs[kept - 1].first != e || pairs[kept - 1].second != pack.second) pairs[kept++] = pack;
  }
  pairs.resize(kept);
}

} // namespace

void FeaturePairs::clear() {
  for (Side* side : {&a, &b}) side->vertices.clear(), side->facets.clear(), side->corners.clear(), side->edges.clear();
  corner_of_a.clear(), corner_of_b.clear(), edges.clear();
}

void find_feature_pairs(NearFaces& near_a, NearFaces& near_b, const Placement& b_in_a, double reach,
                        FeaturePairs& pairs) {
  static thread_local Search a, b; // scratch memory that has grown stays
  pairs.clear();
  const double far = reach * (1 + 1e-9); // rounding must lose nothing
  const auto place_a = [&](int v) { return vec3(near_a.mesh->vertices[v]); };
  const auto place_b = [&](int v) { return placed(vec3(near_b.mesh->vertices[v]), b_in_a); };
  a.gather_facets(near_a, place_a, pairs.a);
  b.gather_facets(near_b, place_b, pairs.b);
  a.gather_features(near_a, place_a, b.all, far, pairs.a);
  b.gather_features(near_b, place_b, a.all, far, pairs.b);
  pair_corners(pairs.a, a, pairs.b, b, far, pairs.corner_of_a);
  pair_corners(pairs.b, b, pairs.a, a, far, pairs.corner_of_b);
  pair_edges(pairs, a, b, far, pairs.edges);
  drop_unused(pairs.a, pairs.corner_of_a, pairs.corner_of_b, pairs.edges, &FeaturePairs::Pair::first);
  drop_unused(pairs.b, pairs.corner_of_b, pairs.corner_of_a, pairs.edges, &FeaturePairs::Pair::second);
  pack_edges(pairs.edges);
}

} // namespace trigrain
