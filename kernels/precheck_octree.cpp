// Pre-check of large meshes: both octrees at once, the larger cut first.
#include "kernels/placement.hpp"
#include <algorithm>
#include <bit>

namespace trigrain {
namespace {

using Point = Vec3<double>;

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

/// Bits of the boxes whose distance from `box` is at most reach; never of empty boxes, which are 1e150 away.
FLATTEN_OCTETS unsigned near_boxes(const Box& box, const BoxOctet& boxes, double reach) {
  Octet distance2(0.);
  for (int axis = 0; axis < 3; ++axis) {
    const Octet low = load<Octet>(boxes.low[axis].data()), high = load<Octet>(boxes.high[axis].data());
    const Octet between = max(max(low - Octet(box.high[axis]), Octet(box.low[axis]) - high), Octet(0.));
    distance2 = distance2 + between * between;
  }
  return bits_of(distance2 <= Octet(std::min(reach * reach, 1e299)));
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
      const unsigned near =
          near_boxes(placed(b.box, at_), a.boxes, reach_) & near_discs(placed(b.disc, at_), a.discs, reach_);
      for (unsigned bits = near; bits != 0; bits &= bits - 1) visit(a.entry[std::countr_zero(bits)], number_b);
      return;
    }
    const BoxOctet boxes_b = placed(b.boxes, at_);
    const DiscOctet discs_b = placed(b.discs, at_);
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
      c_.place[j] = static_cast<int>(c_.number_b.size());
      c_.number_b.push_back(j);
    }
    c_.list.push_back({i, c_.place[j]});
  }

  const MeshView &a_, &b_;
  const Placement& at_;
  double extent_, reach_;
  Candidates& c_;
};

/// Triangles of a cut and of those in it that box and disc leave within reach of a point.
void visit_near(const Octree& octree, int number, const Point& point, double reach, std::vector<int>& indices) {
  const Cut& cut = octree.cut(number);
  const std::array<double, 3> at{point.x, point.y, point.z};
  const unsigned near = near_boxes({at, at}, cut.boxes, reach);
  for (unsigned bits = near & near_discs({point, {0, 0, 1}, 0, 0}, cut.discs, reach); bits != 0; bits &= bits - 1) {
    const int entry = cut.entry[std::countr_zero(bits)];
    if (cut.leaf)
      indices.push_back(entry);
    else
      visit_near(octree, entry, point, reach, indices);
  }
}

} // namespace

void triangles_by_octree(const MeshView& mesh, const Point& point, double reach, std::vector<int>& indices) {
  indices.clear();
  const double extent = mesh.octree->radius() + std::sqrt(squared(point));
  visit_near(*mesh.octree, 0, point, reach + slack * extent, indices);
  std::sort(indices.begin(), indices.end());
}

void pairs_by_octree(const MeshView& a, const MeshView& b, const Placement& at, double reach, Candidates& c) {
  c.clear();
  if (c.place.size() < static_cast<std::size_t>(b.triangles.size)) c.place.resize(b.triangles.size, -1);
  c.list.clear();
  Descent(a, b, at, reach, c).visit(0, 0);
  for (int j : c.number_b) c.place[j] = -1;
  place(b.triangles, at, c.number_b, c.b);
  std::sort(c.list.begin(), c.list.end(), [&](const PairIndex& x, const PairIndex& y) {
    return std::pair(x.i, c.number_b[x.j]) < std::pair(y.i, c.number_b[y.j]);
  });
  c.pairs = c.list;
}

} // namespace trigrain
