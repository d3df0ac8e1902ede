#include "dem/feature_contacts.hpp"
#include "dem/contact_rule.hpp"
#include "dem/edge_array.hpp"
#include "dem/vectors.hpp"
#include "kernels/lanes.hpp"
#include "kernels/placement.hpp"
#include "kernels/point_triangle.hpp"
#include "kernels/segment.hpp"
#include <algorithm>
#include <array>
#include <cmath>

namespace trigrain {
namespace {

using Eigen::Vector3d;
using Point = Vec3<double>;

struct Segment {
  Point x0, x1;
};

/// Writes contacts found in the frame of A into the world's.
class Writer {
 public:
  Writer(const Particles& p, BodyPair pair, std::vector<Touch>& contacts)
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

/// Every corner of one body against each piece of the other one's surface, where that is nearest. `at`: where the
/// points of a side are.
void corners_against(const FeaturePairs::Side& mine, const std::vector<Point>& my_at, const FeaturePairs::Side& theirs,
                     const std::vector<Point>& their_at, std::span<const FeaturePairs::Pair> pairs, bool mine_is_a,
                     double reach, Writer& writer) {
  struct Nearest {
    int piece;
    double d2;
    Point from_corner;
  };
  static thread_local std::vector<Nearest> nearest; // scratch memory that has grown stays
  for (std::size_t p = 0; p < pairs.size();) {
    const int corner = pairs[p].first;
    const Point x = my_at[mine.corners[corner].point];
    nearest.clear();
    for (; p < pairs.size() && pairs[p].first == corner; ++p) {
      const FeaturePairs::Facet& facet = theirs.facets[pairs[p].second];
      const auto seen_at = [&](int k) { return their_at[facet.corner[k]] - x; };
      const Point from = closest_on_triangle_by_zones({0, 0, 0}, {seen_at(0), seen_at(1), seen_at(2)}).point;
      const double d2 = squared(from);
      if (d2 >= reach * reach) continue;
      const auto known =
          std::find_if(nearest.begin(), nearest.end(), [&](const Nearest& n) { return n.piece == facet.piece; });
      if (known == nearest.end())
        nearest.push_back({facet.piece, d2, from});
      else if (d2 < known->d2)
        *known = {facet.piece, d2, from};
    }
    for (const Nearest& n : nearest) {
      if (n.d2 == 0) continue; // crossing: the kernel has counted it
      const int name = mine.corners[corner].name;
      const Vector3d mine_x = eigen(x), y = mine_x + eigen(n.from_corner);
      if (mine_is_a)
        writer.add(name, n.piece, mine_x, y, reach);
      else
        writer.add(n.piece, name, y, mine_x, reach);
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

/// The term X of one pair of edges, and half its negative gradient: push and couple about P.
void edges_cross(int feature_a, int feature_b, const Segment& e, const Segment& f, double reach, Writer& writer) {
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

/// Bits of the edges first, first + 1, ... that are closest to `e` between their ends and within reach (m), but for
/// rounding: without a division. Those beyond the last edge are undefined.
unsigned may_cross(const Segment& e, const EdgeArray& edges, int first, double reach) {
  const auto all = [](const Point& x) {
    return Vec3<Lanes>{broadcast<Lanes>(x.x), broadcast<Lanes>(x.y), broadcast<Lanes>(x.z)};
  };
  const auto [y0, y1] = edges.at(first);
  const Vec3<Lanes> u = all(e.x1 - e.x0), v = y1 - y0, r = y0 - all(e.x0), n = cross(u, v);
  const Lanes nn = squared(n), height = dot(r, n), s = dot(cross(r, v), n), t = dot(cross(r, u), n),
              none = broadcast<Lanes>(0);
  return bits_of((s > none) & (s < nn) & (t > none) & (t < nn) &
                 (height * height < broadcast<Lanes>(reach * reach) * nn));
}

} // namespace

void add_feature_contacts(const Particles& particles, BodyPair pair, const Placement& b_in_a, const FeaturePairs& near,
                          double reach, std::vector<Touch>& contacts) {
  if (near.empty()) return;
  static thread_local std::vector<Point> at_a, at_b; // scratch memory that has grown stays
  static thread_local EdgeArray edges_b;
  const FeaturePairs::Side a = near.a(), b = near.b();
  at_a.assign(a.points.begin(), a.points.end());
  at_b.clear(), edges_b.clear();
  for (const Point& x : b.points) at_b.push_back(placed(x, b_in_a));
  for (const FeaturePairs::Edge& f : b.edges) edges_b.push_back(at_b[f.from], at_b[f.to]);
  Writer writer(particles, pair, contacts);
  const auto first = static_cast<std::ptrdiff_t>(contacts.size());
  corners_against(a, at_a, b, at_b, near.corner_pairs_of_a(), true, reach, writer);
  corners_against(b, at_b, a, at_a, near.corner_pairs_of_b(), false, reach, writer);
  for (const auto& [i, pack] : near.edge_pairs()) {
    const FeaturePairs::Edge& e = a.edges[i];
    const Segment of_a{at_a[e.from], at_a[e.to]};
    for_lanes(may_cross(of_a, edges_b, pack, reach), pack, edges_b.size(), [&](int j) {
      const FeaturePairs::Edge& f = b.edges[j];
      edges_cross(e.name, f.name, of_a, {at_b[f.from], at_b[f.to]}, reach, writer);
    });
  }
  std::sort(contacts.begin() + first, contacts.end(), by_features);
}

} // namespace trigrain
