#include "experiments/verify.hpp"
#include "dem/vectors.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <set>
#include <sstream>

namespace trigrain {
namespace {

using Eigen::Vector3d;

constexpr double tolerance = 1e-12; // of S: some hundred roundings of double
constexpr int block_side = 8;       // triangles per body of a block

Vector3d centroid(const Triangle& t) { return (eigen(t.a0) + eigen(t.a1) + eigen(t.a2)) / 3; }

template <class Map> Triangle mapped(const Triangle& t, const Map& map) {
  return {vec3(map(eigen(t.a0))), vec3(map(eigen(t.a1))), vec3(map(eigen(t.a2)))};
}

double largest_coordinate(const Triangle& t) {
  return std::max(
      {eigen(t.a0).cwiseAbs().maxCoeff(), eigen(t.a1).cwiseAbs().maxCoeff(), eigen(t.a2).cwiseAbs().maxCoeff()});
}
double longest_edge(const Triangle& t) {
  return std::max(
      {(eigen(t.a1) - eigen(t.a0)).norm(), (eigen(t.a2) - eigen(t.a1)).norm(), (eigen(t.a0) - eigen(t.a2)).norm()});
}
double size_of(const Triangle& a, const Triangle& b) {
  return std::max({longest_edge(a), longest_edge(b), largest_coordinate(a), largest_coordinate(b)});
}

/// Up to block_side indices of the mesh's triangles: one half nearest to `point` (body frame), the rest at random.
std::vector<int> choose(const Mesh& mesh, const Vector3d& point, std::mt19937_64& random) {
  const TrianglesView triangles = mesh.triangles.view();
  std::vector<int> order(triangles.size);
  std::iota(order.begin(), order.end(), 0);
  const auto distance2 = [&](int i) { return (centroid(triangles[i]) - point).squaredNorm(); };
  const int near = std::min<int>(block_side / 2, triangles.size);
  std::partial_sort(order.begin(), order.begin() + near, order.end(),
                    [&](int i, int j) { return distance2(i) < distance2(j); });
  const int count = std::min<int>(block_side, triangles.size);
  for (int i = near; i < count; ++i) std::swap(order[i], order[i + random() % (order.size() - i)]);
  order.resize(count);
  return order;
}

TriangleBlock make_block(const Particles& p, BodyPair pair, std::mt19937_64& random) {
  const auto [a, b] = pair;
  // x in b's body frame -> a's body frame
  const auto to_a = [&, a = a, b = b](const Vector3d& x) -> Vector3d {
    return p.orientation[a].conjugate() * (p.position[b] - p.position[a] + p.orientation[b] * x);
  };
  const Vector3d b_seen_from_a = to_a(Vector3d::Zero());
  const Vector3d a_seen_from_b = p.to_body(b, p.position[a]);
  TriangleBlock block{.a = {}, .b = {}, .reach = p.halo[a] + p.halo[b]};
  for (const int i : choose(*p.mesh[a], b_seen_from_a, random)) block.a.push_back(p.mesh[a]->triangles.view()[i]);
  for (const int j : choose(*p.mesh[b], a_seen_from_b, random))
    block.b.push_back(mapped(p.mesh[b]->triangles.view()[j], to_a));
  return block;
}

Hits answers(const Kernel& kernel, const TriangleBlock& block, double reach) {
  Hits hits;
  KernelCounts counts;
  closest_of_all(kernel, block.a.view(), block.b.view(), {.reach = reach}, hits, counts);
  return hits;
}

/// Moves b along the shortest connection until `gap` (m) is left of it; blocks that touch already stay as they are.
void bring_near(TriangleBlock& block, double gap) {
  const Hits hits = answers(kernel_named("brute"), block, std::numeric_limits<double>::infinity());
  int nearest = 0;
  for (int k = 1; k < hits.size(); ++k)
    if (hits[k].closest.distance < hits[nearest].closest.distance) nearest = k;
  if (hits.empty() || hits[nearest].closest.distance <= gap) return;
  const Vector3d connection = eigen(hits[nearest].closest.p) - eigen(hits[nearest].closest.q);
  const Vector3d shift = connection * (1 - gap / connection.norm());
  Triangles moved;
  for (int j = 0; j < block.b.size(); ++j)
    moved.push_back(mapped(block.b.view()[j], [&](const Vector3d& x) -> Vector3d { return x + shift; }));
  block.b = std::move(moved);
}

/// Mesh body whose bounding sphere is nearest to that of `body`; -1 if there is none. Not both fixed.
int neighbour(const Particles& p, int body) {
  int nearest = -1;
  double least = std::numeric_limits<double>::infinity();
  for (int other = 0; other < p.size(); ++other) {
    if (other == body || p.is_sphere(other) || (p.fixed(body) && p.fixed(other))) continue;
    const double gap = (p.position[other] - p.position[body]).norm() - p.radius[other];
    if (gap < least) {
      least = gap;
      nearest = other;
    }
  }
  return nearest;
}

/// Up to `count` pairs of mesh bodies: half of them in contact if so many are, the rest neighbours of random bodies.
std::vector<BodyPair> choose_bodies(const Simulation& simulation, int count, std::mt19937_64& random) {
  const Particles& p = simulation.particles();
  std::set<std::pair<int, int>> touching, chosen;
  for (const Contact& c : simulation.contacts())
    if (!p.is_sphere(c.a) && !p.is_sphere(c.b)) touching.insert({c.a, c.b});
  std::vector<std::pair<int, int>> order(touching.begin(), touching.end());
  for (std::size_t i = 0; i < order.size() && std::ssize(chosen) < count / 2; ++i) {
    std::swap(order[i], order[i + random() % (order.size() - i)]);
    chosen.insert(order[i]);
  }
  std::vector<int> bodies;
  for (int i = 0; i < p.size(); ++i)
    if (!p.is_sphere(i)) bodies.push_back(i);
  for (std::size_t i = 0; i < bodies.size() && std::ssize(chosen) < count; ++i) {
    std::swap(bodies[i], bodies[i + random() % (bodies.size() - i)]);
    if (const int other = neighbour(p, bodies[i]); other >= 0) chosen.insert(std::minmax(bodies[i], other));
  }
  std::vector<BodyPair> pairs;
  for (const auto& [a, b] : chosen) pairs.push_back({a, b});
  return pairs;
}

std::string text(double value) {
  std::ostringstream out;
  out.precision(3);
  out << value;
  return out.str();
}

CheckItem compare_hashes(const std::string& what, const std::string& against, std::uint64_t found,
                         std::uint64_t expected) {
  return {what, found == expected,
          "state hash " + std::string(found == expected ? "equal to" : "differs from") + " that of " + against};
}

} // namespace

bool Check::passed() const {
  return std::all_of(how.begin(), how.end(), [](const CheckItem& item) { return item.passed; });
}

CheckItem check_scheme(const Options& options, const HashAfter& hash_after) {
  Options serial = options;
  serial.scheme = "serial";
  serial.runtime = Options{}.runtime;
  serial.threads = 1;
  return compare_hashes("scheme", "serial on one thread", hash_after(options), hash_after(serial));
}

CheckItem check_grid(const Options& options, const HashAfter& hash_after) {
  Options all_pairs = options;
  all_pairs.grid = "none";
  all_pairs.triangle_search = "every-step";
  return compare_hashes("grid", "all body pairs compared, their triangles searched in every step", hash_after(options),
                        hash_after(all_pairs));
}

std::vector<TriangleBlock> sample_triangle_pairs(const Simulation& simulation, int pairs, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<TriangleBlock> blocks;
  int found = 0;
  const std::vector<BodyPair> bodies =
      choose_bodies(simulation, std::max(1, pairs / (2 * block_side * block_side)), random);
  for (int round = 0; round < 64 && found < pairs && !bodies.empty();
       ++round) // few bodies: other triangles of the same
    for (const BodyPair& pair : bodies) {
      blocks.push_back(make_block(simulation.particles(), pair, random));
      if (blocks.size() % 2 == 0) bring_near(blocks.back(), blocks.back().reach / 2);
      found += blocks.back().a.size() * blocks.back().b.size();
    }
  return blocks;
}

CheckItem check_kernel(const Kernel& kernel, const Kernel& reference, std::span<const TriangleBlock> blocks) {
  constexpr double everything = std::numeric_limits<double>::infinity();
  double worst = 0; // of |d - d*| / S and ||p - q| - d| / S
  std::int64_t pairs = 0, contacts = 0, unlike = 0, missing = 0;
  for (const TriangleBlock& block : blocks) {
    const auto found = answers(kernel, block, everything), expected = answers(reference, block, everything);
    missing += std::abs(expected.size() - found.size());
    const auto found_near = answers(kernel, block, block.reach), expected_near = answers(reference, block, block.reach);
    std::set<std::pair<int, int>> near, near_expected;
    for (int k = 0; k < found_near.size(); ++k) near.insert({found_near[k].i, found_near[k].j});
    for (int k = 0; k < expected_near.size(); ++k) near_expected.insert({expected_near[k].i, expected_near[k].j});
    for (int k = 0; k < std::min(found.size(), expected.size()); ++k) {
      const auto& [i, j, closest] = found[k];
      if (i != expected[k].i || j != expected[k].j) {
        ++missing;
        continue;
      }
      const double size = size_of(block.a.view()[i], block.b.view()[j]), distance = expected[k].closest.distance;
      const double error = std::max(std::abs(closest.distance - distance),
                                    std::abs((eigen(closest.p) - eigen(closest.q)).norm() - closest.distance));
      worst = std::isfinite(error) ? std::max(worst, error / size) : everything;
      const bool borderline = std::abs(distance - block.reach) <= tolerance * size;
      unlike += !borderline && near.contains({i, j}) != near_expected.contains({i, j});
      ++pairs;
    }
    contacts += std::ssize(near_expected);
  }
  std::string detail = std::string(kernel.name) + " against " + std::string(reference.name) + " on " +
                       std::to_string(pairs) + " triangle pairs of the scene, " + std::to_string(contacts) +
                       " within reach: largest error " + text(worst) + " S (allowed " + text(tolerance) + " S), " +
                       std::to_string(unlike) + " contacts unlike, " + std::to_string(missing) + " answers missing";
  if (blocks.empty()) detail = "no two bodies of triangles in the scene: the kernel is not used";
  return {"kernel", worst <= tolerance && unlike == 0 && missing == 0, std::move(detail)};
}

CheckItem check_state(const Particles& p) {
  int bad = 0;
  for (int i = 0; i < p.size(); ++i)
    bad += !p.position[i].allFinite() || !p.velocity[i].allFinite() || !p.angular_momentum[i].allFinite() ||
           !(std::abs(p.orientation[i].norm() - 1) < 1e-9);
  return {"state", bad == 0,
          std::to_string(bad) + " of " + std::to_string(p.size()) +
              " bodies with numbers that are not finite or an orientation that is not a unit quaternion"};
}

int bodies_outside(const Particles& p, const Domain& domain) {
  int outside = 0;
  for (int i = 0; i < p.size(); ++i) {
    const Vector3d x = p.position[i] - domain.min;
    outside += !p.fixed(i) && !(x.minCoeff() >= 0 && x.maxCoeff() <= domain.size);
  }
  return outside;
}

Check verify(const Scene& scene, const Options& options, std::int64_t steps) {
  const auto hash_of = [steps](const Scene& start, const Options& chosen) {
    Simulation simulation(start, chosen);
    simulation.run(steps);
    return simulation.state_hash();
  };
  const auto hash_after = [&](const Options& chosen) { return hash_of(scene, chosen); };
  Simulation simulation(scene, options);
  const StepStats stats = simulation.run(steps);
  Check check;
  check.how.push_back(check_state(simulation.particles()));
  check.how.push_back(check_scheme(options, hash_after));
  const double bodies = simulation.particles().size();
  if (bodies * bodies * static_cast<double>(steps) <= 1e8) // seconds; larger scenes rely on the engine's own tests
    check.how.push_back(check_grid(options, [&](const Options& chosen) {
      Scene fixed = scene; // with any other control the step depends on what the grid knows of bodies that are apart
      fixed.time.control = "fixed";
      return hash_of(fixed, chosen);
    }));
  check.how.push_back(
      check_kernel(kernel_named(options.kernel), kernel_named("brute"), sample_triangle_pairs(simulation, 2048, 1)));
  if (stats.contacts == 0)
    check.warnings.push_back("no contact in the " + std::to_string(steps) + " steps that were checked");
  return check;
}

} // namespace trigrain
