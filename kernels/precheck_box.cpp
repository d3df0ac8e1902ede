// Pre-check of small meshes: a separating direction and its slab, then box against box and plane against corners.
#include "kernels/placement.hpp"
#include <bit>
#include <utility>

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

/// Eight boxes, or one in all lanes.
struct Boxes {
  Vec3<Octet> low, high;
};

[[gnu::always_inline]] inline Vec3<Octet> lower(const Vec3<Octet>& a, const Vec3<Octet>& b) {
  return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)};
}
[[gnu::always_inline]] inline Vec3<Octet> higher(const Vec3<Octet>& a, const Vec3<Octet>& b) {
  return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)};
}
[[gnu::always_inline]] inline Boxes boxes_of(const Corners<Octet>& t) {
  return {lower(lower(t[0], t[1]), t[2]), higher(higher(t[0], t[1]), t[2])};
}
/// Squared distances of boxes.
[[gnu::always_inline]] inline Octet distance2(const Boxes& a, const Boxes& b) {
  const Octet zero = broadcast<Octet>(0);
  return squared(higher(higher(b.low - a.high, a.low - b.high), {zero, zero, zero}));
}

/// Ascending numbers of the triangles with a corner x where u.x >= least and whose box is within reach of `other`.
FLATTEN_OCTETS void triangles_beyond(TrianglesView t, const Point& u, double least, const Box& other, double reach,
                                     std::vector<int>& indices) {
  indices.resize(t.size + 8);
  const Vec3<Octet> direction = in_octet(u);
  const Boxes box{in_octet({other.low[0], other.low[1], other.low[2]}),
                  in_octet({other.high[0], other.high[1], other.high[2]})};
  int n = 0;
  for (int first = 0; first < t.size; first += 8) {
    const Corners<Octet> x = corners_of(t, first);
    const Octet furthest = max(max(dot(direction, x[0]), dot(direction, x[1])), dot(direction, x[2]));
    unsigned near = bits_of((furthest >= broadcast<Octet>(least)) &
                            (distance2(boxes_of(x), box) <= broadcast<Octet>(reach * reach)));
    if (t.size - first < 8) near &= (1u << (t.size - first)) - 1;
    std::array<int, 8> number;
    for (int lane = 0; lane < 8; ++lane) number[lane] = first + lane;
    n += store_selected(number, near, indices.data() + n);
  }
  indices.resize(n);
}

/// Eight triangles, or one of them in all lanes, with their boxes and slabs: the points x that are within reach of a
/// triangle's plane have lowest <= normal.x <= highest.
struct Facets {
  static constexpr int columns = 20;
  Corners<Octet> corner;
  Boxes box;
  Vec3<Octet> normal; ///< cross product of two edges (m2)
  Octet lowest, highest;
};

/// The facets of the triangles of which corners(first) gives eight, after one another in memory.
template <class CornersAt>
FLATTEN_OCTETS void prepare(int count, const CornersAt& corners, double reach, double extent, Column<double>& facets) {
  const std::size_t room = (count + 7) / 8 * 8 * Facets::columns;
  if (facets.size() < room) facets.resize(2 * room);
  double* to = facets.data();
  for (int first = 0; first < count; first += 8) {
    Facets f;
    f.corner = corners(first);
    f.box = boxes_of(f.corner);
    const Vec3<Octet> e = f.corner[1] - f.corner[0], g = f.corner[2] - f.corner[0];
    f.normal = cross(e, g);
    const Octet height = dot(f.normal, f.corner[0]),
                beyond = broadcast<Octet>(reach) * sqrt(squared(f.normal)) +
                         broadcast<Octet>(slack * extent) * sqrt(squared(e) * squared(g)); // rounding is in it
    f.lowest = height - beyond;
    f.highest = height + beyond;
    const auto put = [&](const Octet& x) { store(x, std::exchange(to, to + 8)); };
    const auto put_all = [&](const Vec3<Octet>& x) { put(x.x), put(x.y), put(x.z); };
    put_all(f.corner[0]), put_all(f.corner[1]), put_all(f.corner[2]);
    put_all(f.box.low), put_all(f.box.high), put_all(f.normal);
    put(f.lowest), put(f.highest);
  }
}

/// get(0), get(1), ... as facets.
template <class Get> [[gnu::always_inline]] inline Facets facets_from(const Get& get) {
  const auto at = [&](int c) { return Vec3<Octet>{get(c), get(c + 1), get(c + 2)}; };
  return {{at(0), at(3), at(6)}, {at(9), at(12)}, at(15), get(18), get(19)};
}

/// Are all corners beyond reach of the facets' planes, on one side? Not where a number is NaN: no area, infinite reach.
[[gnu::always_inline]] inline auto beyond(const Facets& f, const Corners<Octet>& x) {
  const Octet h0 = dot(f.normal, x[0]), h1 = dot(f.normal, x[1]), h2 = dot(f.normal, x[2]);
  return (min(min(h0, h1), h2) > f.highest) | (max(max(h0, h1), h2) < f.lowest);
}

/// Bits of the eight facets from `b` on that facet number `lane` of those from `a` on may come within reach of: neither
/// boxes nor planes tell them apart.
FLATTEN_OCTETS unsigned near_facet(const double* a, int lane, const double* b, double reach) {
  const Facets one = facets_from([&](int c) { return broadcast<Octet>(a[8 * c + lane]); }),
               eight = facets_from([&](int c) { return load<Octet>(b + 8 * c); });
  return bits_of((distance2(one.box, eight.box) <= broadcast<Octet>(reach * reach)) & !beyond(one, eight.corner) &
                 !beyond(eight, one.corner));
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
                   placed(a.octree->cut(0).box, a_in_b), limit, c.number_b);
  place(b.triangles, at, c.number_b, c.b);
  const TrianglesView placed_b = c.b.view();
  const int count_a = static_cast<int>(c.near_a.size());
  prepare(
      count_a, [&](int first) { return corners_of(a.triangles, c.near_a, first); }, limit, extent, c.facets_a);
  prepare(
      placed_b.size, [&](int first) { return corners_of(placed_b, first); }, limit, extent, c.facets_b);
  PairIndex* next = room_for_pairs(c, count_a * ((placed_b.size + 7) / 8 * 8) + 8);
  for (int k = 0; k < count_a; ++k) {
    const double* const facets_a = c.facets_a.data() + k / 8 * 8 * Facets::columns;
    for (int first = 0; first < placed_b.size; first += 8) {
      unsigned near = near_facet(facets_a, k % 8, c.facets_b.data() + first * Facets::columns, limit);
      if (placed_b.size - first < 8) near &= (1u << (placed_b.size - first)) - 1;
      std::array<PairIndex, 8> pair;
      for (int lane = 0; lane < 8; ++lane) pair[lane] = {c.near_a[k], first + lane};
      next += store_selected(pair, near, next);
    }
  }
  c.pairs = {c.list.data(), next};
}

} // namespace trigrain
