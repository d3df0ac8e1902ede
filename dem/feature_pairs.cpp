#include "dem/feature_pairs.hpp"
#include "dem/edge_array.hpp"
#include "dem/vectors.hpp"
#include "kernels/lanes.hpp"
#include "kernels/placement.hpp"
#include "kernels/point_triangle.hpp"
#include "kernels/segment.hpp"
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace trigrain {
namespace {

using Point = Vec3<double>;

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
  /// Calls visit(first, bits) for packs of boxes, in order; bits: those of first, first + 1, ... that are within reach
  /// of `box` (m) in every direction, at least one.
  template <class Visit> void for_near(const Bounds& box, double reach, const Visit& visit) const {
    const auto all = [](double x) { return broadcast<Lanes>(x); };
    const Lanes x0 = all(box.low.x - reach), y0 = all(box.low.y - reach), z0 = all(box.low.z - reach),
                x1 = all(box.high.x + reach), y1 = all(box.high.y + reach), z1 = all(box.high.z + reach);
    for (int at = 0; at < size_; at += lane_count) {
      const auto column = [&](int k) { return load<Lanes>(&column_[k][at]); };
      unsigned near = bits_of((column(0) <= x1) & (column(1) <= y1) & (column(2) <= z1) & (column(3) >= x0) &
                              (column(4) >= y0) & (column(5) >= z0));
      if (size_ - at < lane_count) near &= (1u << (size_ - at)) - 1;
      if (near != 0) visit(at, near);
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

using Found = FeaturePairs::Found;
using FoundSide = FeaturePairs::SideOf<FeaturePairs::Vector>;
using Pairs = std::vector<FeaturePairs::Pair>;

/// One body of a pair while its near features are looked for.
class Search {
 public:
  std::vector<Point> at; ///< the side's points in the frame of A
  BoundsArray facets, edges;
  EdgeArray edge_ends;
  Bounds all; ///< of all facets

  /// Numbers vertices and facets of the faces.
  template <class Place> void gather_facets(NearFaces& near, const Place& place, FoundSide& side) {
    auto& [mesh, faces] = near;
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    side.points.clear(), side.facets.clear(), side.corners.clear(), side.edges.clear();
    at.clear(), facets.clear(), edges.clear(), edge_ends.clear();
    point_.clear(mesh->vertices.size());
    for (const int f : faces) {
      const auto& v = mesh->faces[f];
      const auto& [i, piece] = side.facets.emplace_back(FeaturePairs::Facet{
          {point(v[0], *mesh, place, side), point(v[1], *mesh, place, side), point(v[2], *mesh, place, side)},
          -1 - mesh->part[f]});
      Bounds box{at[i[0]], at[i[0]]};
      box.extend(at[i[1]]), box.extend(at[i[2]]);
      facets.push_back(box);
      if (side.facets.size() == 1) all = box;
      all.extend(box.low), all.extend(box.high);
    }
  }

  /// Corners and edges of the facets that are near the other body's facets.
  template <class Place>
  void gather_features(const NearFaces& near, const Place& place, const Bounds& other, double reach, FoundSide& side) {
    const Mesh& mesh = *near.mesh;
    const int vertices = static_cast<int>(mesh.vertices.size());
    corner_.clear(mesh.vertices.size()), edge_.clear(mesh.features.edges.size());
    for (const int f : near.faces) {
      for (const int v : mesh.features.corner_of[f]) {
        if (v < 0 || !corner_.first_time(v)) continue;
        const int i = point_[v];
        if (other.near({at[i], at[i]}, reach)) side.corners.push_back({i, v});
      }
      for (const int e : mesh.features.edge_of[f]) {
        if (e < 0 || !edge_.first_time(e)) continue;
        const auto [v0, v1] = mesh.features.edges[e];
        const int from = point(v0, mesh, place, side), to = point(v1, mesh, place, side);
        Bounds box{at[from], at[from]};
        box.extend(at[to]);
        if (!other.near(box, reach)) continue;
        side.edges.push_back({from, to, vertices + e});
        edges.push_back(box);
        edge_ends.push_back(at[from], at[to]);
      }
    }
  }

 private:
  template <class Place> int point(int vertex, const Mesh& mesh, const Place& place, FoundSide& side) {
    if (point_.first_time(vertex)) {
      point_[vertex] = static_cast<int>(at.size());
      side.points.push_back(vec3(mesh.vertices[vertex]));
      at.push_back(place(side.points.back()));
    }
    return point_[vertex];
  }

  Numbered point_, corner_, edge_;
};

/// Of each corner of `mine` and each piece of surface of `theirs`: the facets closer than reach + margin that are the
/// closest or become so when each distance changes by `margin` at most.
void pair_corners(const FoundSide& mine, const Search& my, const FoundSide& theirs, const Search& their, double reach,
                  double margin, Pairs& pairs) {
  struct Near {
    int facet, piece;
    double distance;
  };
  static thread_local std::vector<Near> near; // scratch memory that has grown stays
  pairs.clear();
  for (int c = 0; c < static_cast<int>(mine.corners.size()); ++c) {
    const Point& x = my.at[mine.corners[c].point];
    near.clear();
    their.facets.for_near({x, x}, reach + margin, [&](int first, unsigned bits) {
      for (; bits != 0; bits &= bits - 1) {
        const int f = first + std::countr_zero(bits);
        const auto& [i, piece] = theirs.facets[f];
        const Corners<double> seen{their.at[i[0]] - x, their.at[i[1]] - x, their.at[i[2]] - x};
        const double distance = std::sqrt(squared(closest_on_triangle_by_zones({0, 0, 0}, seen).point));
        if (distance <= reach + margin) near.push_back({f, piece, distance});
      }
    });
    for (const Near& n : near) {
      const auto closer = [&](const Near& o) { return o.piece == n.piece && o.distance + 2 * margin < n.distance; };
      if (std::none_of(near.begin(), near.end(), closer)) pairs.push_back({c, n.facet});
    }
  }
}

void pair_edges(const Search& a, const FoundSide& side_a, const Search& b, double reach, Pairs& pairs) {
  const auto all = [](const Point& x) {
    return Vec3<Lanes>{broadcast<Lanes>(x.x), broadcast<Lanes>(x.y), broadcast<Lanes>(x.z)};
  };
  pairs.clear();
  for (int e = 0; e < static_cast<int>(side_a.edges.size()); ++e) {
    const Point &from = a.at[side_a.edges[e].from], &to = a.at[side_a.edges[e].to];
    Bounds box{from, from};
    box.extend(to);
    const Vec3<Lanes> x0 = all(from), x1 = all(to);
    b.edges.for_near(box, reach, [&](int first, unsigned bits) {
      const auto [y0, y1] = b.edge_ends.at(first);
      const auto [s, t] = closest_on_segments(x0, x1, y0, y1);
      const Vec3<Lanes> pq = x0 + s * (x1 - x0) - (y0 + t * (y1 - y0));
      bits &= bits_of(squared(pq) <= broadcast<Lanes>(reach * reach));
      for (; bits != 0; bits &= bits - 1) pairs.push_back({e, first + std::countr_zero(bits)});
    });
  }
}

/// Drops what no pair uses, and numbers the rest anew. `edge`: which of a pair of edges is of this side.
void drop_unused(FoundSide& side, Pairs& of_corners, Pairs& of_facets, Pairs& of_edges, int FeaturePairs::Pair::*edge) {
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
  const auto users = [](Pairs& pairs, int FeaturePairs::Pair::*item) {
    return [&pairs, item](const auto& visit) {
      for (FeaturePairs::Pair& pair : pairs) visit(pair.*item);
    };
  };
  keep_used(side.corners, users(of_corners, &FeaturePairs::Pair::first));
  keep_used(side.facets, users(of_facets, &FeaturePairs::Pair::second));
  keep_used(side.edges, users(of_edges, edge));
  keep_used(side.points, [&](const auto& visit) {
    for (auto& facet : side.facets)
      for (int& i : facet.corner) visit(i);
    for (auto& corner : side.corners) visit(corner.point);
    for (auto& e : side.edges) visit(e.from), visit(e.to);
  });
}

/// Single edges of B become packs of them.
void pack_edges(Pairs& pairs) {
  std::size_t kept = 0;
  for (const auto& [e, f] : pairs) {
    const FeaturePairs::Pair pack{e, f / lane_count * lane_count};
    if (kept == 0 || pairs[kept - 1].first != e || pairs[kept - 1].second != pack.second) pairs[kept++] = pack;
  }
  pairs.resize(kept);
}

} // namespace

void FeaturePairs::assign(const Found& f) {
  const auto join = [](auto& list, auto&... parts) {
    list.clear();
    list.reserve((parts.size() + ...));
    (list.insert(list.end(), parts.begin(), parts.end()), ...);
  };
  const auto size = [](const auto& list) { return static_cast<int>(list.size()); };
  join(points_, f.a.points, f.b.points), join(facets_, f.a.facets, f.b.facets);
  join(corners_, f.a.corners, f.b.corners), join(edges_, f.a.edges, f.b.edges);
  join(pairs_, f.corners_of_a, f.corners_of_b, f.edges);
  points_of_a_ = size(f.a.points), facets_of_a_ = size(f.a.facets);
  corners_of_a_ = size(f.a.corners), edges_of_a_ = size(f.a.edges);
  end_of_a_ = size(f.corners_of_a), end_of_b_ = end_of_a_ + size(f.corners_of_b);
}

void find_feature_pairs(NearFaces& near_a, NearFaces& near_b, const Placement& b_in_a, double reach, double margin,
                        FeaturePairs& pairs) {
  static thread_local Search a, b; // scratch memory that has grown stays
  static thread_local Found found;
  margin += 1e-9 * reach; // rounding must lose nothing
  const double far = reach + margin;
  const auto place_a = [](const Point& x) { return x; };
  const auto place_b = [&](const Point& x) { return placed(x, b_in_a); };
  a.gather_facets(near_a, place_a, found.a);
  b.gather_facets(near_b, place_b, found.b);
  a.gather_features(near_a, place_a, b.all, far, found.a);
  b.gather_features(near_b, place_b, a.all, far, found.b);
  pair_corners(found.a, a, found.b, b, reach, margin, found.corners_of_a);
  pair_corners(found.b, b, found.a, a, reach, margin, found.corners_of_b);
  pair_edges(a, found.a, b, far, found.edges);
  drop_unused(found.a, found.corners_of_a, found.corners_of_b, found.edges, &FeaturePairs::Pair::first);
  drop_unused(found.b, found.corners_of_b, found.corners_of_a, found.edges, &FeaturePairs::Pair::second);
  pack_edges(found.edges);
  pairs.assign(found);
}

} // namespace trigrain
