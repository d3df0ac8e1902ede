#include "dem/feature_contacts.hpp"
#include "kernels/lanes.hpp"
#include "kernels/point_triangle.hpp"
#include "kernels/segment.hpp"
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace trigrain {
namespace {

using Eigen::Vector3d;
using Point = Vec3<double>;

Point vec3(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Vector3d eigen(const Point& v) { return {v.x, v.y, v.z}; }

/// Axis-parallel box of a triangle or an edge.
struct Box {
  Point low, high;
  void extend(const Point& x) {
    low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
  }
  bool near(const Box& o, double reach) const {
    return (low.x - o.high.x <= reach) & (o.low.x - high.x <= reach) & (low.y - o.high.y <= reach) &
           (o.low.y - high.y <= reach) & (low.z - o.high.z <= reach) & (o.low.z - high.z <= reach);
  }
};

template <class T> Vec3<T> in_all_lanes(const Point& x) {
  return {broadcast<T>(x.x), broadcast<T>(x.y), broadcast<T>(x.z)};
}

/// Pairs of points, the ends of edges or of boxes, as structure of arrays: one box is compared with many at once.
class PointPairs {
 public:
  void clear() { size_ = 0; }
  void push_back(const Point& first, const Point& second) {
    if (size_ + lane_count > static_cast<int>(column_[0].size())) // the last pack may reach beyond
      for (auto& column : column_) column.resize(size_ + 8 * lane_count);
    const std::array<double, 6> x{first.x, first.y, first.z, second.x, second.y, second.z};
    for (int k = 0; k < 6; ++k) column_[k][size_] = x[k];
    ++size_;
  }
  /// Calls visit(j) for the pairs whose box is within reach of `box` (m) in every direction and for which
  /// also(first points, second points) is true, in order.
  template <class Also, class Visit>
  void for_near(const Box& box, double reach, const Also& also, const Visit& visit) const {
    const Vec3<Lanes> low = in_all_lanes<Lanes>(box.low - Point{reach, reach, reach}),
                      high = in_all_lanes<Lanes>(box.high + Point{reach, reach, reach});
    for (int at = 0; at < size_; at += lane_count) {
      const Vec3<Lanes> x = points(0, at), y = points(3, at);
      unsigned near = bits_of((min(x.x, y.x) <= high.x) & (max(x.x, y.x) >= low.x) & (min(x.y, y.y) <= high.y) &
                              (max(x.y, y.y) >= low.y) & (min(x.z, y.z) <= high.z) & (max(x.z, y.z) >= low.z));
      if (size_ - at < lane_count) near &= (1u << (size_ - at)) - 1;
      if (near != 0) near &= bits_of(also(x, y));
      for (; near != 0; near &= near - 1) visit(at + std::countr_zero(near));
    }
  }

 private:
  Vec3<Lanes> points(int k, int at) const {
    return {load<Lanes>(&column_[k][at]), load<Lanes>(&column_[k + 1][at]), load<Lanes>(&column_[k + 2][at])};
  }
  std::array<std::vector<double>, 6> column_;
  int size_ = 0;
};

struct Corner {
  int vertex;
  Point x;
};
struct Edge {
  int index;
  Point x0, x1;
  Box box;
};
struct Facet {
  int part;
  Corners<double> x;
  Box box;
};

/// Which of many numbers have been met since clear(), without clearing memory.
class Met {
 public:
  void clear(std::size_t count) {
    if (when_.size() < count) when_.resize(count, 0);
    ++now_;
  }
  bool first_time(int i) {
    const bool first = when_[i] != now_;
    when_[i] = now_;
    return first;
  }

 private:
  std::vector<std::uint64_t> when_;
  std::uint64_t now_ = 0;
};

/// What one body of a pair has near the other one, in the frame of A.
struct Side {
  const Mesh* mesh;
  std::vector<int> faces;
  std::vector<Facet> facets;
  std::vector<Corner> corners;
  std::vector<Edge> edges;
  PointPairs boxes, ends; ///< of the facets, of the edges
  Box box;                ///< of all facets

  /// Fills facets and box from `faces`, which are sorted here; place(vertex) is where a vertex is.
  template <class Place> void gather_facets(const Place& place) {
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
    facets.clear(), boxes.clear();
    placed_.clear(mesh->vertices.size());
    at_.resize(std::max(at_.size(), mesh->vertices.size()));
    for (const int f : faces) {
      Facet& facet = facets.emplace_back(Facet{mesh->part[f], {}, {}});
      for (int k = 0; k < 3; ++k) facet.x[k] = at(mesh->faces[f][k], place);
      facet.box = {facet.x[0], facet.x[0]};
      facet.box.extend(facet.x[1]), facet.box.extend(facet.x[2]);
      boxes.push_back(facet.box.low, facet.box.high);
      if (facets.size() == 1) box = facet.box;
      box.extend(facet.box.low), box.extend(facet.box.high);
    }
  }

  /// Fills corners and edges: those of the facets that are near the other body's facets.
  template <class Place> void gather_features(const Place& place, const Box& other, double reach) {
    const ShapeFeatures& features = mesh->features;
    corners.clear(), edges.clear(), ends.clear();
    met_corner_.clear(mesh->vertices.size()), met_edge_.clear(features.edges.size());
    for (const int f : faces) {
      for (const int v : features.corner_of[f])
        if (v >= 0 && met_corner_.first_time(v))
          if (const Point x = at(v, place); other.near({x, x}, reach)) corners.push_back({v, x});
      for (const int e : features.edge_of[f]) {
        if (e < 0 || !met_edge_.first_time(e)) continue;
        const auto [v0, v1] = features.edges[e];
        Edge edge{e, at(v0, place), at(v1, place), {}};
        edge.box = {edge.x0, edge.x0};
        edge.box.extend(edge.x1);
        if (!other.near(edge.box, reach)) continue;
        edges.push_back(edge);
        ends.push_back(edge.x0, edge.x1);
      }
    }
  }

 private:
  template <class Place> const Point& at(int vertex, const Place& place) {
    if (placed_.first_time(vertex)) at_[vertex] = place(vertex);
    return at_[vertex];
  }

  Met placed_, met_corner_, met_edge_;
  std::vector<Point> at_;
};

/// Writes contacts found in the frame of A into the world's.
class Writer {
 public:
  Writer(const Particles& p, const Touch& pair, std::vector<Touch>& contacts)
      : a_(pair.a), b_(pair.b), place_(p.contact_place(a_, b_)), origin_(p.position[a_]),
        turn_(p.orientation[a_].toRotationMatrix()), contacts_(contacts) {}

  /// P on A, Q on B; `push` is that of Touch in the frame of A, `couple` the same but about P.
  void add(int feature_a, int feature_b, const Vector3d& p, const Vector3d& q, double reach, double share,
           const Vector3d& push, const Vector3d& couple) {
    Touch& c = contacts_.emplace_back(Touch{.a = a_, .b = b_, .feature_a = feature_a, .feature_b = feature_b});
    const double distance = (p - q).norm();
    c.point = origin_ + turn_ * ((1 - place_) * p + place_ * q);
    c.normal = turn_ * ((p - q) / distance);
    c.overlap = reach - distance;
    c.share = share;
    c.push = turn_ * push;
    c.couple = turn_ * (couple + (place_ * (p - q)).cross(push)); // from P to the point
  }
  void add(int feature_a, int feature_b, const Vector3d& p, const Vector3d& q, double reach) {
    const double distance = (p - q).norm();
    add(feature_a, feature_b, p, q, reach, 1, (reach / distance - 1) * (p - q), Vector3d::Zero());
  }

 private:
  int a_, b_;
  double place_;
  Vector3d origin_;
  Eigen::Matrix3d turn_;
  std::vector<Touch>& contacts_;
};

/// Names of features that neither cut nor order of the faces can change within one mesh: corners by vertex, edges
/// after them, whole pieces of surface below 0.
int piece_name(int part) { return -1 - part; }
int edge_name(const Side& side, int edge) { return static_cast<int>(side.mesh->vertices.size()) + edge; }

/// Every corner against each piece of the other body, where that is nearest.
void corners_against(const Side& mine, const Side& other, bool mine_is_a, double reach, Writer& writer) {
  struct Nearest {
    int part;
    double d2;
    Point from_corner;
  };
  static thread_local std::vector<Nearest> nearest;
  for (const Corner& corner : mine.corners) {
    nearest.clear();
    const auto every_one = [](const Vec3<Lanes>& low, const Vec3<Lanes>&) { return low.x == low.x; };
    other.boxes.for_near({corner.x, corner.x}, reach, every_one, [&](int i) {
      const Facet& facet = other.facets[i];
      const Corners<double> seen{facet.x[0] - corner.x, facet.x[1] - corner.x, facet.x[2] - corner.x};
      const Point from = closest_on_triangle_by_zones({0, 0, 0}, seen).point;
      const double d2 = squared(from);
      if (d2 >= reach * reach) return;
      const auto known =
          std::find_if(nearest.begin(), nearest.end(), [&](const Nearest& n) { return n.part == facet.part; });
      if (known == nearest.end())
        nearest.push_back({facet.part, d2, from});
      else if (d2 < known->d2)
        *known = {facet.part, d2, from};
    });
    for (const Nearest& n : nearest) {
      if (n.d2 == 0) continue; // crossing: the kernel has counted it
      const Vector3d x = eigen(corner.x), y = x + eigen(n.from_corner);
      if (mine_is_a)
        writer.add(corner.vertex, piece_name(n.part), x, y, reach);
      else
        writer.add(piece_name(n.part), corner.vertex, y, x, reach);
    }
  }
}

Point closest_on_segment(const Point& x, const Point& x0, const Point& x1) {
  return x0 + share_on_segment(x, x0, x1 - x0) * (x1 - x0);
}

double psi(double x) { return x * x * (3 - 2 * x); }
double psi_slope(double x) { return 6 * x * (1 - x); }

/// Overlap of an edge's end with the other edge, and the unit direction that takes A away.
struct EndOverlap {
  double overlap = 0;
  Vector3d on_a{0, 0, 0}, normal{0, 0, 0};
  double phi() const { return overlap * overlap; }
};

EndOverlap end_overlap(const Point& on_a, const Point& on_b, double reach) {
  const Vector3d pq = eigen(on_a - on_b);
  const double distance = pq.norm();
  if (distance >= reach || distance == 0) return {};
  return {reach - distance, eigen(on_a), pq / distance};
}

/// Whether edges x0 x1 and y0 y1 are closest between their ends and within reach (m), but for rounding: without a
/// division.
template <class T>
MaskOf<T> may_cross(const Vec3<T>& x0, const Vec3<T>& x1, const Vec3<T>& y0, const Vec3<T>& y1, double reach) {
  const Vec3<T> u = x1 - x0, v = y1 - y0, r = y0 - x0, n = cross(u, v);
  const T nn = squared(n), height = dot(r, n), s = dot(cross(r, v), n), t = dot(cross(r, u), n), none = constant<T>(0);
  return (s > none) & (s < nn) & (t > none) & (t < nn) & (height * height < constant<T>(reach * reach) * nn);
}

/// The term X of one pair of edges, and half its negative gradient: push and couple about P.
void edges_cross(int feature_a, int feature_b, const Edge& e, const Edge& f, double reach, Writer& writer) {
  const auto [s, t] = closest_on_segments(e.x0, e.x1, f.x0, f.x1);
  if (!(s > 0 && s < 1 && t > 0 && t < 1)) return;
  const Vector3d u = eigen(e.x1 - e.x0), v = eigen(f.x1 - f.x0);
  const Vector3d p = eigen(e.x0) + s * u, q = eigen(f.x0) + t * v, r = p - q;
  const double distance = r.norm(), overlap = reach - distance;
  if (overlap <= 0 || distance == 0) return;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
  const EndOverlap e0 = end_overlap(e.x0, closest_on_segment(e.x0, f.x0, f.x1), reach),
                   e1 = end_overlap(e.x1, closest_on_segment(e.x1, f.x0, f.x1), reach),
                   f0 = end_overlap(closest_on_segment(f.x0, e.x0, e.x1), f.x0, reach),
                   f1 = end_overlap(closest_on_segment(f.x1, e.x0, e.x1), f.x1, reach);
  const double phi = overlap * overlap;
  const double a = std::min(1., (psi(1 - s) * e0.phi() + psi(s) * e1.phi()) / phi),
               b = std::min(1., (psi(1 - t) * f0.phi() + psi(t) * f1.phi()) / phi);
  const double share = (1 - a) * (1 - b);
  if (share < 1e-12) return; // parallel, or at an end: what rounding leaves
  Vector3d push = (1 - a * b) * overlap / distance * r, couple(0, 0, 0);
  const auto relieve = [&](double weight, const EndOverlap& end) {
    const Vector3d back = -weight * end.overlap * end.normal;
    push += back;
    couple += (end.on_a - p).cross(back);
  };
  if (a > 0) relieve((1 - b) * psi(1 - s), e0), relieve((1 - b) * psi(s), e1);
  if (b > 0) relieve((1 - a) * psi(1 - t), f0), relieve((1 - a) * psi(t), f1);
  // s and t of the closest points of two lines move with A by the implicit function theorem.
  const double by_s = (1 - b) * psi_slope(s) * (e1.phi() - e0.phi()) / 2,
               by_t = (1 - a) * psi_slope(t) * (f1.phi() - f0.phi()) / 2;
  const double nn = u.cross(v).squaredNorm();
  if ((by_s != 0 || by_t != 0) && nn > 0) {
    push -= (by_s * (vv * u - uv * v) + by_t * (uv * u - uu * v)) / nn;
    couple -= (by_s * vv + by_t * uv) / nn * u.cross(r);
  }
  writer.add(feature_a, feature_b, p, q, reach, share, push, couple);
}

} // namespace

void keep_features(const Particles& particles, std::vector<Touch>& contacts, std::size_t first) {
  static thread_local Side a, b; // scratch memory that has grown stays
  const Touch pair = contacts[first];
  a.mesh = particles.mesh[pair.a].get(), b.mesh = particles.mesh[pair.b].get();
  a.faces.clear(), b.faces.clear();
  for (std::size_t c = first; c < contacts.size(); ++c) {
    if (a.faces.empty() || a.faces.back() != contacts[c].feature_a) a.faces.push_back(contacts[c].feature_a);
    b.faces.push_back(contacts[c].feature_b);
  }
  contacts.resize(first);
  const Eigen::Quaterniond to_a = particles.orientation[pair.a].conjugate();
  const Eigen::Matrix3d turn = (to_a * particles.orientation[pair.b]).toRotationMatrix();
  const Vector3d centre_b = to_a * (particles.position[pair.b] - particles.position[pair.a]);
  const auto place_a = [](int v) { return vec3(a.mesh->vertices[v]); };
  const auto place_b = [&](int v) { return vec3(turn * b.mesh->vertices[v] + centre_b); };
  const double reach = particles.halo[pair.a] + particles.halo[pair.b];
  a.gather_facets(place_a), b.gather_facets(place_b);
  a.gather_features(place_a, b.box, reach), b.gather_features(place_b, a.box, reach);
  Writer writer(particles, pair, contacts);
  corners_against(a, b, true, reach, writer);
  corners_against(b, a, false, reach, writer);
  for (const Edge& e : a.edges) {
    const Vec3<Lanes> x0 = in_all_lanes<Lanes>(e.x0), x1 = in_all_lanes<Lanes>(e.x1);
    b.ends.for_near(
        e.box, reach, [&](const Vec3<Lanes>& y0, const Vec3<Lanes>& y1) { return may_cross(x0, x1, y0, y1, reach); },
        [&](int i) {
          const Edge& f = b.edges[i];
          edges_cross(edge_name(a, e.index), edge_name(b, f.index), e, f, reach, writer);
        });
  }
  std::sort(contacts.begin() + static_cast<std::ptrdiff_t>(first), contacts.end(), [](const Touch& l, const Touch& r) {
    return l.feature_a != r.feature_a ? l.feature_a < r.feature_a : l.feature_b < r.feature_b;
  });
}

} // namespace trigrain
