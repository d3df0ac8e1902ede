// CGAL (LGPL-3 in the parts used): squared distance of two triangles in floating point. It gives no points.
#include "experiments/kernel_bench/contestant.hpp"
#include "experiments/kernel_bench/peer.hpp"
#include <CGAL/Simple_cartesian.h>
#include <CGAL/squared_distance_3.h>
#include <cmath>

namespace trigrain {
namespace {

using Kernel3 = CGAL::Simple_cartesian<double>;

TrianglePass on_triangles(const Problem& problem, const Query&) {
  std::vector<std::pair<Kernel3::Triangle_3, Kernel3::Triangle_3>> pairs;
  for (const Pair& pair : problem.pairs) {
    const auto theirs = [](const Triangle& t) {
      const auto v = [&](int k) { return Kernel3::Point_3(corner(t, k).x, corner(t, k).y, corner(t, k).z); };
      return Kernel3::Triangle_3(v(0), v(1), v(2));
    };
    pairs.emplace_back(theirs(pair.a), theirs(pair.b));
  }
  return [pairs = std::move(pairs)](int first, int count, Hits& hits, KernelCounts& counts) {
    for (int k = first; k < first + count; ++k) {
      const double d = std::sqrt(CGAL::squared_distance(pairs[k].first, pairs[k].second));
      hits.push_back({k, k, unbounded({}, {}, d)});
    }
    counts.triangle_pairs += count;
  };
}

} // namespace

Contestant cgal_contestant() {
  return {"cgal", "double", 1, "CGAL: squared_distance of two triangles, without points", nullptr, on_triangles, {}};
}

} // namespace trigrain
