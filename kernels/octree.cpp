#include "kernels/octree.hpp"
#include <algorithm>
#include <cmath>
#include <numeric>

namespace trigrain {
namespace {

constexpr double far = 1e150; // its square is finite
constexpr Box empty{{far, far, far}, {-far, -far, -far}};

Box box_of(const Triangle& t) {
  const auto axis = [](double a, double b, double c) { return std::minmax({a, b, c}); };
  const auto x = axis(t.a0.x, t.a1.x, t.a2.x), y = axis(t.a0.y, t.a1.y, t.a2.y), z = axis(t.a0.z, t.a1.z, t.a2.z);
  return {{x.first, y.first, z.first}, {x.second, y.second, z.second}};
}

Box hull(const Box& a, const Box& b) {
  Box r;
  for (int k = 0; k < 3; ++k) {
    r.low[k] = std::min(a.low[k], b.low[k]);
    r.high[k] = std::max(a.high[k], b.high[k]);
  }
  return r;
}

Vec3<double> middle_of(const Triangle& t) { return (1. / 3) * (t.a0 + t.a1 + t.a2); }

} // namespace

struct Octree::Builder {
  std::vector<Cut>& cuts;
  TrianglesView triangles;
  std::vector<Box> box;                      ///< of each triangle
  std::vector<std::array<double, 3>> middle; ///< of each box
  int shallowest, deepest;                   ///< leaf: as asked for, and as found

  /// Makes the cut of some triangles in a cube and returns its number.
  int make(std::span<int> numbers, const std::array<double, 3>& centre, double half, int depth) {
    const int number = static_cast<int>(cuts.size());
    cuts.emplace_back();
    Cut cut{};
    cut.leaf = numbers.size() <= 8 && depth >= shallowest;
    deepest = std::max(deepest, depth);
    std::array<Box, 8> part;
    part.fill(empty);
    std::array<Disc, 8> disc{};
    if (cut.leaf)
      for (std::size_t k = 0; k < numbers.size(); ++k) {
        cut.entry[k] = numbers[k];
        part[k] = box[numbers[k]];
        disc[k] = disc_of(numbers.subspan(k, 1));
      }
    else
      divide(numbers, centre, half, depth, [&](int k, std::span<int> of_part, const std::array<double, 3>& at) {
        cut.entry[k] = make(of_part, at, half / 2, depth + 1);
        part[k] = cuts[cut.entry[k]].box;
        disc[k] = cuts[cut.entry[k]].disc;
      });
    cut.disc = disc_of(numbers);
    cut.box = empty;
    for (int k = 0; k < 8; ++k) {
      cut.box = hull(cut.box, part[k]);
      for (int axis = 0; axis < 3; ++axis) {
        cut.boxes.low[axis][k] = part[k].low[axis];
        cut.boxes.high[axis][k] = part[k].high[axis];
      }
      const auto set = [&](std::array<std::array<double, 8>, 3>& to, const Vec3<double>& x) {
        to[0][k] = x.x, to[1][k] = x.y, to[2][k] = x.z;
      };
      set(cut.discs.centre, disc[k].centre);
      set(cut.discs.normal, disc[k].normal);
      cut.discs.half_height[k] = disc[k].half_height;
      cut.discs.radius[k] = disc[k].radius;
    }
    cuts[number] = cut;
    return number;
  }

  /// A disc square to the mean normal.
  Disc disc_of(std::span<const int> numbers) const {
    Vec3<double> normal{0, 0, 0}, centre{0, 0, 0};
    for (int t : numbers) {
      const Triangle tri = triangles[t];
      normal = normal + cross(tri.a1 - tri.a0, tri.a2 - tri.a0);
      centre = centre + (1. / numbers.size()) * middle_of(tri);
    }
    const double length = std::sqrt(dot(normal, normal));
    normal = length > 0 ? (1 / length) * normal : Vec3<double>{0, 0, 1};
    double low = far, high = -far, radius2 = 0;
    for (int t : numbers) {
      const Triangle tri = triangles[t];
      for (const Vec3<double>& x : {tri.a0, tri.a1, tri.a2}) {
        const double height = dot(normal, x - centre);
        const Vec3<double> across = x - centre - height * normal;
        low = std::min(low, height);
        high = std::max(high, height);
        radius2 = std::max(radius2, dot(across, across));
      }
    }
    return {centre + ((low + high) / 2) * normal, normal, (high - low) / 2, std::sqrt(radius2)};
  }

  /// Calls visit(octant, its triangles, its middle) for the octants of a cube that are not empty.
  template <class Visit>
  void divide(std::span<int> numbers, const std::array<double, 3>& centre, double half, int depth, Visit visit) {
    constexpr int deepest = 40; // middles that cubes do not tell apart are divided by number
    const auto in_octant = [&](int t, int k) {
      for (int axis = 0; axis < 3; ++axis)
        if ((middle[t][axis] > centre[axis]) != (k >> axis & 1)) return false;
      return true;
    };
    std::span<int> rest = numbers;
    for (int k = 0; k < 8; ++k) {
      const std::size_t count =
          depth > deepest
              ? (rest.size() + 7 - k) / (8 - k)
              : std::stable_partition(rest.begin(), rest.end(), [&](int t) { return in_octant(t, k); }) - rest.begin();
      if (count == 0) continue;
      std::array<double, 3> at;
      for (int axis = 0; axis < 3; ++axis) at[axis] = centre[axis] + (k >> axis & 1 ? half : -half) / 2;
      visit(k, rest.first(count), at);
      rest = rest.subspan(count);
    }
  }
};

Octree::Octree(std::span<const Vec3<double>> vertices, TrianglesView triangles, Cuts cuts) {
  const std::size_t padded = (vertices.size() + 7) / 8 * 8;
  for (std::size_t v = 0; v < padded; ++v) {
    const Vec3<double>& x = vertices[v < vertices.size() ? v : 0];
    vertex_[0].push_back(x.x);
    vertex_[1].push_back(x.y);
    vertex_[2].push_back(x.z);
    radius_ = std::max(radius_, std::sqrt(x.x * x.x + x.y * x.y + x.z * x.z));
  }
  Builder builder{cuts_, triangles, {}, {}, 0, 0};
  Box all = empty;
  for (int k = 0; k < triangles.size; ++k) {
    const Box b = box_of(triangles[k]);
    builder.box.push_back(b);
    builder.middle.push_back({(b.low[0] + b.high[0]) / 2, (b.low[1] + b.high[1]) / 2, (b.low[2] + b.high[2]) / 2});
    all = hull(all, b);
  }
  std::array<double, 3> centre;
  double half = 0;
  for (int axis = 0; axis < 3; ++axis) {
    centre[axis] = (all.low[axis] + all.high[axis]) / 2;
    half = std::max(half, (all.high[axis] - all.low[axis]) / 2);
  }
  std::vector<int> order(triangles.size);
  std::iota(order.begin(), order.end(), 0);
  builder.make(order, centre, half, 0);
  if (cuts == Cuts::adaptive) return;
  cuts_.clear();
  builder.shallowest = builder.deepest;
  builder.make(order, centre, half, 0);
}

} // namespace trigrain
