// Which triangle pairs of two meshes may be within reach: all, by spheres, by boxes in a slab, or by octrees.
#include "kernels/precheck.hpp"
#include "kernels/sphere.hpp"
#include "kernels/triangle_pair.hpp"
#include <algorithm>
#include <bit>
#include <numeric>

// GCC 12 miscompiles flattened functions over packs that are wider than a register.
#ifdef __AVX512F__
#define FLATTEN_OCTETS [[gnu::flatten]]
#else
#define FLATTEN_OCTETS
#endif

namespace trigrain {
namespace {

using Point = Vec3<double>;

/// What rounding can do to a distance between the two meshes, in units of the largest coordinate.
constexpr double slack = 64 * epsilon;

/// No coordinate of two meshes is larger in A's frame (m).
double extent_of(const MeshView& a, const MeshView& b, const Placement& b_in_a) {
  return a.octree->radius() + b.octree->radius() + std::sqrt(squared(b_in_a.translation));
}

Point placed(const Point& x, const Placement& at) {
  return Point{dot(at.rows[0], x), dot(at.rows[1], x), dot(at.rows[2], x)} + at.translation;
}

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

/// Not inlined: compiled once, it gives a triangle the same bits for every pre-check.
[[gnu::noinline]] Triangle placed(const Triangle& t, const Placement& at) {
  return {placed(t.a0, at), placed(t.a1, at), placed(t.a2, at)};
}

/// A direction or point of A's frame turned back into B's.
Point turned_back(const Point& u, const Placement& at) {
  return u.x * at.rows[0] + u.y * at.rows[1] + u.z * at.rows[2];
}

void place(const MeshView& b, const Placement& at, Candidates& c) {
  c.number_b = c.near_b;
  for (int j : c.number_b) c.b.push_back(placed(b.triangles[j], at));
}

PairIndex* room_for_pairs(Candidates& c, std::size_t count) {
  if (c.list.size() < count) c.list.resize(count);
  return c.list.data();
}

void clear(Candidates& c) {
  c.b.clear();
  c.number_b.clear();
  c.pairs = {};
}

// --- none and sphere: lists of triangles, every one of A's against every one of B's

void pair_all(const MeshView& b, const Placement& at, Candidates& c) {
  place(b, at, c);
  PairIndex* next = room_for_pairs(c, c.near_a.size() * c.b.size());
  for (int i : c.near_a)
    for (int j = 0; j < c.b.size(); ++j) *next++ = {i, j};
  c.pairs = {c.list.data(), next};
}

void all_triangles(TrianglesView triangles, const Point&, double, std::vector<int>& indices) {
  indices.resize(triangles.size);
  std::iota(indices.begin(), indices.end(), 0);
}

void pairs_of_all(const MeshView& a, const MeshView& b, const Placement& at, double, Candidates& c) {
  clear(c);
  all_triangles(a.triangles, {}, 0, c.near_a);
  all_triangles(b.triangles, {}, 0, c.near_b);
  pair_all(b, at, c);
}

void pairs_by_sphere(const MeshView& a, const MeshView& b, const Placement& at, double reach, Candidates& c) {
  clear(c);
  triangles_near_point(a.triangles, at.translation, b.octree->radius() + reach, c.near_a);
  if (c.near_a.empty()) return;
  triangles_near_point(b.triangles, -1. * turned_back(at.translation, at), a.octree->radius() + reach, c.near_b);
  pair_all(b, at, c);
}

// --- box: a separating direction, the slab it leaves, then box against box and plane against corners

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

/// Gilbert (1966): the point of the convex hull of B - A nearest to the origin, by steps towards supports; each gives a
/// lower bound of the distance. Stops when the bound exceeds `reach` or is near the distance.
FLATTEN_OCTETS Slab separating_slab(const MeshView& a, const MeshView& b, const Placement& at, double reach) {
  constexpr int steps = 4;
  Slab best{{1, 0, 0}, std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  Point w = at.translation;
  for (int step = 0; step < steps; ++step) {
    const double length = std::sqrt(squared(w));
    if (!(length > 0)) break;
    const Point u = (1 / length) * w;
    const Support sa = support(*a.octree, u), sb = support(*b.octree, turned_back(-1. * u, at));
    const Slab slab{u, sa.value, dot(u, at.translation) - sb.value};
    if (slab.gap() > best.gap()) best = slab;
    if (best.gap() > reach || length - best.gap() <= 0.25 * reach) break;
    const Point d = w - (placed(sb.point, at) - sa.point);
    const double t = clamp01(dot(w, d) * inverse_or_zero(squared(d)));
    if (!(t > 0)) break;
    w = w - t * d;
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

Vec3<Octet> in_octet(const Point& x) { return {Octet(x.x), Octet(x.y), Octet(x.z)}; }

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

void pairs_by_box(const MeshView& a, const MeshView& b, const Placement& at, double reach, Candidates& c) {
  clear(c);
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

// --- octree: both trees at once, the larger cut first

/// Boxes that hold the turned and moved boxes of B.
FLATTEN_OCTETS BoxOctet placed(const BoxOctet& b, const Placement& at) {
  std::array<Octet, 3> middle, half;
  for (int axis = 0; axis < 3; ++axis) {
    const Octet low = load<Octet>(b.low[axis].data()), high = load<Octet>(b.high[axis].data());
    middle[axis] = Octet(.5) * (low + high);
    half[axis] = Octet(.5) * (high - low);
  }
  const std::array<double, 3> t{at.translation.x, at.translation.y, at.translation.z};
  BoxOctet r;
  for (int axis = 0; axis < 3; ++axis) {
    const Point& row = at.rows[axis];
    const Octet m = Octet(row.x) * middle[0] + Octet(row.y) * middle[1] + Octet(row.z) * middle[2] + Octet(t[axis]);
    const Octet h =
        Octet(std::fabs(row.x)) * half[0] + Octet(std::fabs(row.y)) * half[1] + Octet(std::fabs(row.z)) * half[2];
    store(m - h, r.low[axis].data());
    store(m + h, r.high[axis].data());
  }
  return r;
}

Box box_in(const BoxOctet& boxes, int k) {
  return {{boxes.low[0][k], boxes.low[1][k], boxes.low[2][k]}, {boxes.high[0][k], boxes.high[1][k], boxes.high[2][k]}};
}

/// Bits of the boxes whose distance from `box` is at most reach.
FLATTEN_OCTETS unsigned near_boxes(const Box& box, const BoxOctet& boxes, double reach) {
  Octet distance2(0.);
  for (int axis = 0; axis < 3; ++axis) {
    const Octet low = load<Octet>(boxes.low[axis].data()), high = load<Octet>(boxes.high[axis].data());
    const Octet between = max(max(low - Octet(box.high[axis]), Octet(box.low[axis]) - high), Octet(0.));
    distance2 = distance2 + between * between;
  }
  return bits_of(distance2 <= Octet(reach * reach));
}

/// The discs of B, turned and moved.
FLATTEN_OCTETS DiscOctet placed(const DiscOctet& b, const Placement& at) {
  DiscOctet r = b;
  const auto turn = [&](const std::array<std::array<double, 8>, 3>& from, const Point& by,
                        std::array<std::array<double, 8>, 3>& to) {
    const Vec3<Octet> x{load<Octet>(from[0].data()), load<Octet>(from[1].data()), load<Octet>(from[2].data())};
    store(dot(in_octet(at.rows[0]), x) + Octet(by.x), to[0].data());
    store(dot(in_octet(at.rows[1]), x) + Octet(by.y), to[1].data());
    store(dot(in_octet(at.rows[2]), x) + Octet(by.z), to[2].data());
  };
  turn(b.centre, at.translation, r.centre);
  turn(b.normal, {0, 0, 0}, r.normal);
  return r;
}

Disc placed(const Disc& b, const Placement& at) {
  const Placement turned{at.rows, {0, 0, 0}};
  return {placed(b.centre, at), placed(b.normal, turned), b.half_height, b.radius};
}

Disc disc_in(const DiscOctet& d, int k) {
  return {{d.centre[0][k], d.centre[1][k], d.centre[2][k]},
          {d.normal[0][k], d.normal[1][k], d.normal[2][k]},
          d.half_height[k],
          d.radius[k]};
}

/// Bits of the discs that neither axis, nor that of `disc`, shows to be further than reach from `disc`.
FLATTEN_OCTETS unsigned near_discs(const Disc& disc, const DiscOctet& discs, double reach) {
  const auto at = [](const std::array<std::array<double, 8>, 3>& x) {
    return Vec3<Octet>{load<Octet>(x[0].data()), load<Octet>(x[1].data()), load<Octet>(x[2].data())};
  };
  const Vec3<Octet> normal = at(discs.normal), d = at(discs.centre) - in_octet(disc.centre),
                    axis = in_octet(disc.normal);
  const Octet h = load<Octet>(discs.half_height.data()), r = load<Octet>(discs.radius.data());
  const Octet cosine = abs(dot(normal, axis));
  const Octet sine = sqrt(max(Octet(1.) - cosine * cosine, Octet(0.)) + Octet(16 * epsilon)); // never too small
  const Octet along_axis = abs(dot(d, axis)) - Octet(disc.half_height) - (h * cosine + r * sine);
  const Octet along_normal = abs(dot(d, normal)) - h - (Octet(disc.half_height) * cosine + Octet(disc.radius) * sine);
  return bits_of(max(along_axis, along_normal) <= Octet(reach));
}

double size_of(const Box& box) {
  return std::max({box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]});
}

class Descent {
 public:
  Descent(const MeshView& a, const MeshView& b, const Placement& at, double reach, Candidates& c)
      : a_(a), b_(b), at_(at), extent_(extent_of(a, b, at)), reach_(reach + slack * extent_), c_(c) {}

  void visit(int number_a, int number_b) {
    const Cut &a = a_.octree->cut(number_a), &b = b_.octree->cut(number_b);
    const double size_a = size_of(a.box), size_b = size_of(b.box);
    const bool open_a = !a.leaf && (b.leaf || size_b <= 2 * size_a),
               open_b = !b.leaf && (a.leaf || size_a <= 2 * size_b);
    if (open_a && !open_b) {
      const unsigned near = near_boxes(trigrain::placed(b.box, at_), a.boxes, reach_) &
                            near_discs(trigrain::placed(b.disc, at_), a.discs, reach_);
      for (unsigned bits = near; bits != 0; bits &= bits - 1) visit(a.entry[std::countr_zero(bits)], number_b);
      return;
    }
    const BoxOctet boxes_b = trigrain::placed(b.boxes, at_);
    const DiscOctet discs_b = trigrain::placed(b.discs, at_);
    if (open_b && !open_a) {
      const unsigned near = near_boxes(a.box, boxes_b, reach_) & near_discs(a.disc, discs_b, reach_);
      for (unsigned bits = near; bits != 0; bits &= bits - 1) visit(number_a, b.entry[std::countr_zero(bits)]);
      return;
    }
    for (unsigned within = near_boxes(hull_of(boxes_b), a.boxes, reach_); within != 0; within &= within - 1) {
      const int k = std::countr_zero(within);
      unsigned near = near_boxes(box_in(a.boxes, k), boxes_b, reach_);
      if (near != 0) near &= near_discs(disc_in(a.discs, k), discs_b, reach_);
      for (; near != 0; near &= near - 1) {
        const int l = std::countr_zero(near);
        if (open_a)
          visit(a.entry[k], b.entry[l]);
        else
          add(a.entry[k], b.entry[l]);
      }
    }
  }

 private:
  static Box hull_of(const BoxOctet& boxes) {
    Box r;
    for (int axis = 0; axis < 3; ++axis) {
      r.low[axis] = stdx::hmin(load<Octet>(boxes.low[axis].data()));
      r.high[axis] = stdx::hmax(load<Octet>(boxes.high[axis].data()));
    }
    return r;
  }

  void add(int i, int j) {
    if (c_.place[j] < 0) {
      c_.place[j] = c_.b.size();
      c_.b.push_back(trigrain::placed(b_.triangles[j], at_));
      c_.number_b.push_back(j);
    }
    c_.list.push_back({i, c_.place[j]});
  }

  const MeshView &a_, &b_;
  const Placement& at_;
  double extent_, reach_;
  Candidates& c_;
};

void pairs_by_octree(const MeshView& a, const MeshView& b, const Placement& at, double reach, Candidates& c) {
  clear(c);
  if (c.place.size() < static_cast<std::size_t>(b.triangles.size)) c.place.resize(b.triangles.size, -1);
  c.list.clear();
  Descent(a, b, at, reach, c).visit(0, 0);
  for (int j : c.number_b) c.place[j] = -1;
  std::sort(c.list.begin(), c.list.end(), [&](const PairIndex& x, const PairIndex& y) {
    return std::pair(x.i, c.number_b[x.j]) < std::pair(y.i, c.number_b[y.j]);
  });
  c.pairs = c.list;
}

constexpr Precheck table[] = {
    {"none", "every triangle pair of every candidate body pair", false, pairs_of_all, all_triangles},
    {"sphere", "bounding spheres of the bodies, then triangles against the other body's sphere", true, pairs_by_sphere,
     triangles_near_point},
    {"box", "a separating direction and its slab, then boxes and planes of triangles: for small meshes", true,
     pairs_by_box, triangles_near_point},
    {"octree", "hierarchical cubic cuts of both bodies, refined where they meet: for large meshes", true,
     pairs_by_octree, triangles_near_point},
};

} // namespace

std::span<const Precheck> prechecks() { return table; }

} // namespace trigrain
