#include "experiments/stability/numbers.hpp"
#include "kernels/kernels.hpp"
#include "kernels/proof/families.hpp"
#include <cmath>

namespace trigrain {
namespace {

bool same(const Vec3<double>& x, const Vec3<double>& y) { return x.x == y.x && x.y == y.y && x.z == y.z; }

Triangle scaled(const Triangle& t, double factor) { return {factor * t.a0, factor * t.a1, factor * t.a2}; }

/// The kernel's answer to a pair scaled by `factor`.
Closest answer(const Kernel& kernel, const Pair& pair, double factor) {
  Triangles a, b;
  a.push_back(scaled(pair.a, factor)), b.push_back(scaled(pair.b, factor));
  Hits hits;
  KernelCounts counts;
  closest_of_all(kernel, a.view(), b.view(), {}, hits, counts);
  return hits[0].closest;
}

} // namespace

std::vector<Metric> scale_invariance(const StudyRequest& request) {
  constexpr int pairs_per_family = 20;
  const double factor = std::ldexp(1., static_cast<int>(request.value));
  std::vector<Metric> metrics;
  for (const Kernel& row : kernels()) {
    if (&row != &kernel_named(row.name, row.precision)) continue; // the widest stands for all
    int all = 0, changed = 0;
    for (const RandomFamily& family : random_families())
      for (int k = 0; k < pairs_per_family; ++k, ++all) {
        const Pair pair = random_pair(family, k);
        const Closest here = answer(row, pair, 1), there = answer(row, pair, factor);
        changed += !(same(factor * here.p, there.p) && same(factor * here.q, there.q) &&
                     factor * here.distance == there.distance);
      }
    metrics.push_back({"changed_share_" + std::string(row.name) + "_" + std::string(row.precision),
                       static_cast<double>(changed) / all,
                       std::abs(request.value) <= 20 ? std::optional(0.) : std::nullopt});
  }
  return metrics;
}

} // namespace trigrain
