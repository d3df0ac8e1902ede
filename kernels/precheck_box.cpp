// Pre-check of small meshes: a separating direction and its slab, then box against box and plane against corners.
#include "kernels/placement.hpp"
#include <bit>

namespace trigrain {
namespace {

using Point = Vec3<double>;

struct Support {
  double value; ///< largest u.x (m)
  Point point;  ///< where
};

FLATTEN_OCTETS Support support(const Octree& octree, const Point& u) {
  const auto [x, y, z] = octree.vertices();
  const Vec3<Octet> direction{Octet(u.x), Octet(u.y), Octet(u.z)};
  Octet best(-std::numeric_limits<double>::infinity()), where(0.);
  for (int k = 0; k < octree.vertex_octets(); ++k) {
    const Octet value = dot(direction, {load<Octet>(x + 8 * k), load<Octet>(y + 8 * k), load<Octet>(z + 8 * k)});
    where = select(value > best, Octet(static_cast<double>(8 * k)), where);
    best = max(best, value);
  }
  const double value = stdx::hmax(best);
  const int lane = std::countr_zero(bits_of(best == Octet(value)));
  const int v = static_cast<int>(lane_of(where, lane)) + lane;
  return {value, {x[v], y[v], z[v]}};
}

/// Direction from A to B of length 1, and how far A and how near B reach along it (m).
struct Slab {
  Point u;
  double end_of_a, start_of_b;
  double gap() const { return start_of_b - end_of_a; }
};

/// First directions that separate, if any do: each is mirrored in the supports it found to overlap, Chung and Wang
/// (1996). Then Gilbert (1966): from the last supports to the point of the convex hull of B - A nearest to the origin,
/// by steps towards supports; each gives a lower bound of the distance. Stops when the bound exceeds `reach` or is near
/// the distance, and early where no direction separates yet: the triangles are asked then.
FLATTEN_OCTETS Slab separating_slab(const MeshView& a, const MeshView& b, const Placement& at, double reach) {
  constexpr int steps = 6, steps_to_separate = 3;
  constexpr double infinite = std::numeric_limits<double>::infinity();
  Slab best{{1, 0, 0}, infinite, -infinite};
  Point w = at.translation; // the direction, and once `in_hull` the point of the hull
  bool in_hull = false;
  double distance = infinite; // of the hull's point
  for (int step = 0; step < steps; ++step) {
    const double ww = squared(w);
    if (!(ww > 0)) break;
    // Supports along w itself: they need not wait for its length.
    const Support sa = support(*a.octree, w), sb = support(*b.octree, turned_back(-1. * w, at));
    const double length = std::sqrt(ww), scale = 1 / length;
    const Slab slab{scale * w, scale * sa.value, scale * (dot(w, at.translation) - sb.value)};
    if (slab.gap() > best.gap()) best = slab;
    if (in_hull) distance = length;
    if (best.gap() > reach || distance - best.gap() <= 0.25 * reach) break;
    if (step + 1 == steps_to_separate && best.gap() <= 0) break;
    const Point v = placed(sb.point, at) - sa.point, d = w - v;
    if (in_hull) {
      const double t = clamp01(dot(w, d) * inverse_or_zero(squared(d)));
      if (!(t > 0)) break;
      w = w - t * d;
    } else if (slab.gap() > 0) {
      w = v;
      in_hull = true;
    } else {
      w = w - (2 * dot(w, v) * inverse_or_zero(squared(v))) * v;
    }
  }
  return best;
}

Corners<Octet> corners_at(const TrianglesView& t, int first) {
  const auto at = [&](int k) {
    return Vec3<Octet>{load<Octet>(t.coordinate[k] + first), load<Octet>(t.coordinate[k + 1] + first),
                       load<Octet>(t.coordinate[k + 2] + first)};
  };
  return {at(0), at(3), at(6)};
}

/// Squared distances of eight triangles' boxes from those of eight others.
[[gnu::always_inline]] inline Octet box_distance2(const Corners<Octet>& a, const Corners<Octet>& b) {
  const auto between = [&](Octet Vec3<Octet>::*axis) {
    const auto low = [&](const Corners<Octet>& t) { return min(min(t[0].*axis, t[1].*axis), t[2].*axis); };
    const auto high = [&](const Corners<Octet>& t) { return max(max(t[0].*axis, t[1].*axis), t[2].*axis); };
    return max(max(low(b) - high(a), low(a) - high(b)), Octet(0.));
  };
  const Octet dx = between(&Vec3<Octet>::x), dy = between(&Vec3<Octet>::y), dz = between(&Vec3<Octet>::z);
  return dx * dx + dy * dy + dz * dz;
}

/// Ascending numbers of the triangles with a corner x where u.x >= least and whose box is within reach of `other`.
FLATTEN_OCTETS void triangles_beyond(TrianglesView t, const Point& u, double least, const Box& other, double reach,
                                     std::vector<int>& indices) {
  indices.resize(t.size + 8);
  const Vec3<Octet> direction = in_octet(u), low = in_octet({other.low[0], other.low[1], other.low[2]}),
                    high = in_octet({other.high[0], other.high[1], other.high[2]});
  const Corners<Octet> box{low, high, high};
  int n = 0;
  for (int first = 0; first < t.size; first += 8) {
    const auto [x, y, z] = corners_at(t, first);
    const Octet furthest = max(max(dot(direction, x), dot(direction, y)), dot(direction, z));
    unsigned near = bits_of((furthest >= Octet(least)) & (box_distance2({x, y, z}, box) <= Octet(reach * reach)));
    if (t.size - first < 8) near &= (1u << (t.size - first)) - 1;
    std::array<int, 8> number;
    for (int lane = 0; lane < 8; ++lane) number[lane] = first + lane;
    n += store_selected(number, near, indices.data() + n);
  }
  indices.resize(n);
}

/// Bits of the eight triangles `b` that box and plane of triangle `a` leave within reach.
FLATTEN_OCTETS unsigned near_triangle(const Triangle& ta, const Corners<Octet>& b, double reach, double extent) {
  const Corners<Octet> a{in_octet(ta.a0), in_octet(ta.a1), in_octet(ta.a2)};
  const auto by_box = box_distance2(a, b) <= Octet(reach * reach);
  const Point e = ta.a1 - ta.a0, f = ta.a2 - ta.a0, n = cross(e, f);
  const double beyond =
      reach * std::sqrt(squared(n)) + slack * extent * std::sqrt(squared(e) * squared(f)); // rounding of n is in it
  const Vec3<Octet> normal = in_octet(n);
  const auto height = [&](const Vec3<Octet>& x) { return dot(normal, x - a[0]); };
  const Octet h0 = height(b[0]), h1 = height(b[1]), h2 = height(b[2]);
  const auto by_plane = (min(min(h0, h1), h2) <= Octet(beyond)) & (max(max(h0, h1), h2) >= Octet(-beyond));
  return bits_of(by_box & by_plane);
}

} // namespace

void pairs_by_box(const MeshView& a, const MeshView& b, const Placement& at, double reach, Candidates& c) {
  c.clear();
  const double extent = extent_of(a, b, at), limit = reach + slack * extent;
  const Slab slab = separating_slab(a, b, at, limit);
  if (slab.gap() > limit) return;
  const Point back = turned_back(-1. * slab.u, at), origin_a = turned_back(-1. * at.translation, at);
  const Placement a_in_b{{Point{at.rows[0].x, at.rows[1].x, at.rows[2].x},
                          {at.rows[0].y, at.rows[1].y, at.rows[2].y},
                          {at.rows[0].z, at.rows[1].z, at.rows[2].z}},
                         origin_a};
  triangles_beyond(a.triangles, slab.u, slab.start_of_b - limit, placed(b.octree->cut(0).box, at), limit, c.near_a);
  if (c.near_a.empty()) return;
  triangles_beyond(b.triangles, back, dot(slab.u, at.translation) - slab.end_of_a - limit,
                   placed(a.octree->cut(0).box, a_in_b), limit, c.near_b);
  place(b, at, c);
  const TrianglesView placed_b = c.b.view();
  PairIndex* next = room_for_pairs(c, c.near_a.size() * ((placed_b.size + 7) / 8 * 8) + 8);
  for (int i : c.near_a) {
    const Triangle ta = a.triangles[i];
    for (int first = 0; first < placed_b.size; first += 8) {
      unsigned near = near_triangle(ta, corners_at(placed_b, first), limit, extent);
      if (placed_b.size - first < 8) near &= (1u << (placed_b.size - first)) - 1;
      std::array<PairIndex, 8> pair;
      for (int lane = 0; lane < 8; ++lane) pair[lane] = {i, first + lane};
      next += store_selected(pair, near, next);
    }
  }
  c.pairs = {c.list.data(), next};
}

} // namespace trigrain
