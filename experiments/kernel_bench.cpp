// Kernel x family of triangle pairs, timed by Google Benchmark: ns per pair, declared work, share redone by brute
// force. Every contestant's answers are compared with brute force before it is timed.
#include "kernels/kernels.hpp"
#include "kernels/name_table.hpp"
#include <benchmark/benchmark.h>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

namespace {

using namespace trigrain;
using Random = std::mt19937_64;
using Point = Vec3<double>;

constexpr double unlimited = std::numeric_limits<double>::infinity();
constexpr std::uint64_t seed = 20180115;

/// All pairs of a x b are one call of a kernel.
struct Batch {
  Triangles a, b;
};

/// What is timed: batches (edges of order 1 m) and the reach (m) asked for.
struct Family {
  std::string_view name;
  std::string_view about;
  double reach;
  std::vector<Batch> (*make)(Random&);
};

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}
Point point_in_cube(Random& random, double half) {
  return {uniform(random, -half, half), uniform(random, -half, half), uniform(random, -half, half)};
}
Point direction(Random& random) {
  const double z = uniform(random, -1, 1), phi = uniform(random, 0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}
Triangle random_triangle(Random& random, double half) {
  return {point_in_cube(random, half), point_in_cube(random, half), point_in_cube(random, half)};
}
Triangle moved(const Triangle& t, const Point& by) { return {t.a0 + by, t.a1 + by, t.a2 + by}; }
Triangle jittered(const Triangle& t, double half, Random& random) {
  return {t.a0 + point_in_cube(random, half), t.a1 + point_in_cube(random, half), t.a2 + point_in_cube(random, half)};
}

/// Random triangles of a unit cube against those of a cube beside it.
std::vector<Batch> make_separated(Random& random) {
  std::vector<Batch> batches(64);
  for (Batch& batch : batches)
    for (int k = 0; k < 16; ++k) {
      batch.a.push_back(random_triangle(random, 0.5));
      batch.b.push_back(moved(random_triangle(random, 0.5), {1.5, 0, 0}));
    }
  return batches;
}

/// 16 variations of each triangle of a random pair that has been moved to distance `gap` along its closest direction,
/// or, for a negative gap, of a pair that crosses.
std::vector<Batch> make_around(Random& random, double gap, double jitter) {
  std::vector<Batch> batches;
  while (batches.size() < 256) {
    const Triangle a = random_triangle(random, 0.5);
    Triangle b = random_triangle(random, 0.5);
    if (gap > 0) b = moved(b, {2, 0, 0});
    Triangles ta, tb;
    ta.push_back(a);
    tb.push_back(b);
    Hits hits;
    KernelCounts counts;
    closest_of_all(kernel_named("brute"), ta.view(), tb.view(), {}, hits, counts);
    const Closest closest = hits[0].closest;
    if (gap > 0)
      b = moved(b, (1 - gap / closest.distance) * (closest.p - closest.q));
    else if (closest.distance > 0)
      continue;
    Batch& batch = batches.emplace_back();
    for (int k = 0; k < 16; ++k) {
      batch.a.push_back(jittered(a, jitter, random));
      batch.b.push_back(jittered(b, jitter, random));
    }
  }
  return batches;
}
std::vector<Batch> make_near(Random& random) { return make_around(random, 0.02, 0.004); }
std::vector<Batch> make_crossing(Random& random) { return make_around(random, -1, 0.004); }

/// Convex hull of 20 points at radii in [.75, 1], by trying every triple: the outline of a grain.
std::vector<Triangle> hull(Random& random) {
  std::vector<Point> points;
  for (int k = 0; k < 20; ++k) points.push_back(uniform(random, 0.75, 1) * direction(random));
  std::vector<Triangle> faces;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = i + 1; j < points.size(); ++j)
      for (std::size_t k = j + 1; k < points.size(); ++k) {
        const Point n = cross(points[j] - points[i], points[k] - points[i]);
        int above = 0, below = 0;
        for (std::size_t l = 0; l < points.size(); ++l)
          if (l != i && l != j && l != k) ++(dot(n, points[l] - points[i]) > 0 ? above : below);
        if (above == 0 || below == 0) faces.push_back({points[i], points[j], points[k]});
      }
  return faces;
}

/// Two grains of radius 1 at a gap of .01; all triangles of one against all of the other.
std::vector<Batch> make_granulates(Random& random) {
  std::vector<Batch> batches(32);
  for (Batch& batch : batches) {
    for (const Triangle& t : hull(random)) batch.a.push_back(t);
    Triangles far;
    const std::vector<Triangle> other = hull(random);
    const Point away = direction(random);
    for (const Triangle& t : other) far.push_back(moved(t, 3. * away));
    Point shift = 3. * away; // moved along the line of closest points until the gap is right
    for (int step = 0; step < 4; ++step) {
      Hits hits;
      KernelCounts counts;
      closest_of_all(kernel_named("brute"), batch.a.view(), far.view(), {}, hits, counts);
      int nearest = 0;
      for (int h = 1; h < hits.size(); ++h)
        if (hits[h].closest.distance < hits[nearest].closest.distance) nearest = h;
      const Closest c = hits[nearest].closest;
      shift = shift + (1 - 0.01 / c.distance) * (c.p - c.q);
      far.clear();
      for (const Triangle& t : other) far.push_back(moved(t, shift));
    }
    batch.b = far;
  }
  return batches;
}

constexpr std::array families{
    Family{"random_sep", "separated at random, distance wanted", unlimited, make_separated},
    Family{"random_far", "separated at random, only contacts wanted", 0.02, make_separated},
    Family{"near", "gap .02 +- .01, all in contact", 0.05, make_near},
    Family{"crossing", "most cross", unlimited, make_crossing},
    Family{"granulates", "hulls of 20 points, gap .01, contacts within .02", 0.02, make_granulates},
};

std::vector<Hit> answers(const Kernel& kernel, const Batch& batch, double reach, KernelCounts& counts) {
  Hits hits;
  closest_of_all(kernel, batch.a.view(), batch.b.view(), {.reach = reach}, hits, counts);
  std::vector<Hit> answers;
  for (int k = 0; k < hits.size(); ++k) answers.push_back(hits[k]);
  return answers;
}

/// Pairs whose answer differs from brute force's: contact or not, or distance by more than 1e-13 (coordinates are < 4
/// m).
std::int64_t wrong_answers(const std::vector<Hit>& found, const std::vector<Hit>& truth) {
  std::int64_t wrong = 0;
  auto f = found.begin();
  for (const Hit& t : truth) {
    const auto before = [](const Hit& x, const Hit& y) { return std::pair(x.i, x.j) < std::pair(y.i, y.j); };
    for (; f != found.end() && before(*f, t); ++f) ++wrong;
    if (f == found.end() || before(t, *f))
      ++wrong;
    else if (const Hit& hit = *f++; !(std::fabs(hit.closest.distance - t.closest.distance) <= 1e-13))
      ++wrong;
  }
  return wrong + (found.end() - f);
}

void run(benchmark::State& state, const Kernel& kernel, const Family& family) {
  Random random(seed);
  const std::vector<Batch> batches = family.make(random);
  const Kernel& reference = kernel_named("brute");
  KernelCounts checked, ignored;
  std::int64_t wrong = 0, contacts = 0;
  for (const Batch& batch : batches) {
    const std::vector<Hit> truth = answers(reference, batch, family.reach, ignored);
    contacts += static_cast<std::int64_t>(truth.size());
    wrong += wrong_answers(answers(kernel, batch, family.reach, checked), truth);
  }
  const double pairs = static_cast<double>(checked.triangle_pairs);
  const bool may_be_inexact = !kernel.exact;
  if (wrong > 0 && !may_be_inexact) {
    const std::string message = std::to_string(wrong) + " answers differ from brute force";
    state.SkipWithError(message.c_str());
    return;
  }

  Hits hits;
  KernelCounts counts;
  for (auto _ : state)
    for (const Batch& batch : batches) {
      hits.clear();
      closest_of_all(kernel, batch.a.view(), batch.b.view(), {.reach = family.reach}, hits, counts);
      benchmark::DoNotOptimize(hits.next_i());
    }
  using benchmark::Counter;
  state.SetItemsProcessed(counts.triangle_pairs);
  // A rate inverted: seconds per 1e-9 pairs, that is, nanoseconds per pair.
  state.counters["ns_per_pair"] =
      Counter(static_cast<double>(counts.triangle_pairs) * 1e-9, Counter::kIsRate | Counter::kInvert);
  state.counters["flops_per_pair"] = kernel.flops_per_pair;
  state.counters["bytes_per_pair"] = kernel.bytes_per_pair;
  state.counters["fall_back_share"] = static_cast<double>(checked.fall_backs) / pairs;
  state.counters["contact_share"] = static_cast<double>(contacts) / pairs;
  state.counters["wrong_share"] = static_cast<double>(wrong) / pairs;
}

} // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 3;
  for (const Family& family : families)
    for (const Kernel& kernel : kernels())
      benchmark::RegisterBenchmark((std::string(kernel.name) + "/" + std::string(family.name)).c_str(), run, kernel,
                                   family);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
