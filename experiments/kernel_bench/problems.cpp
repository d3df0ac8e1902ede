#include "experiments/kernel_bench/problems.hpp"
#include <charconv>
#include <cmath>

namespace trigrain {
namespace {

constexpr double radius = .5; // m

/// The number in a name such as granulates_20_apart.
int number_in(const std::string& name) {
  int n = 0;
  const char* begin = name.data() + name.find('_') + 1;
  std::from_chars(begin, name.data() + name.size(), n);
  return n;
}

Eigen::Vector3d gaussian(Random& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random), y = normal(random), z = normal(random);
  return {x, y, z};
}
Eigen::Matrix3d rotation(Random& random) {
  const Eigen::Vector3d axis = gaussian(random).normalized();
  return Eigen::AngleAxisd(std::uniform_real_distribution<double>(0, 6.283)(random), axis).toRotationMatrix();
}

/// Moves B from `start` along the line of closest points until the gap is right.
void set_gap(MeshPair& pair, double start, double gap) {
  const Kernel& kernel = kernel_named("brute-simd");
  const Precheck& precheck = prechecks().back();
  pair.translation *= start / pair.translation.norm();
  Candidates candidates;
  double distance = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < 20 && distance > gap * (1 + 1e-9); ++pass) {
    Hits hits;
    KernelCounts counts;
    for (double reach = std::min(distance, 2 * gap) * (1 + 1e-9); hits.empty(); reach *= 2) {
      precheck.pairs({pair.a->triangles.view(), &pair.a->octree}, {pair.b->triangles.view(), &pair.b->octree},
                     pair.placement(), reach, candidates);
      kernel.closest({pair.a->triangles.view(), candidates.b.view(), candidates.pairs}, {.reach = reach}, hits, counts);
    }
    int nearest = 0;
    for (int k = 1; k < hits.size(); ++k)
      if (hits[k].closest.distance < hits[nearest].closest.distance) nearest = k;
    const Closest c = hits[nearest].closest;
    distance = c.distance;
    const Eigen::Vector3d to_a(c.p.x - c.q.x, c.p.y - c.q.y, c.p.z - c.q.z);
    pair.translation += (1 - gap / distance) * to_a;
  }
}

} // namespace

std::vector<BenchFamily> bench_families() {
  std::vector<BenchFamily> list;
  for (const RandomFamily& family : random_families())
    list.push_back({std::string(family.name), std::string(family.about)});
  list.push_back({"every", "one pair of each of these families in turn"});
  for (const char* points : {"10", "20", "40"}) {
    const std::string name = std::string("granulates_") + points;
    list.push_back({name, std::string("meshes: two hulls of ") + points + " points in contact", true});
    list.push_back({name + "_apart", "meshes: the same beyond each other's reach", true});
  }
  for (const char* triangles : {"80", "320", "1280", "5120", "20480", "81920"})
    list.push_back({std::string("spheres_") + triangles,
                    std::string("meshes: two icospheres of ") + triangles + " triangles, one small contact", true});
  return list;
}

Problem triangle_problem(const BenchFamily& family, std::uint64_t seed, int pairs) {
  const std::uint64_t first = seed << 32;
  const auto all = random_families();
  for (const RandomFamily& row : all)
    if (row.name == family.name) return problem(row, first, pairs);
  std::vector<Pair> mixed;
  for (int k = 0; k < pairs; ++k) mixed.push_back(random_pair(all[k % all.size()], first + k));
  return problem(mixed);
}

MeshProblem mesh_problem(const BenchFamily& family, std::uint64_t seed, int pairs, Cuts cuts) {
  const bool granulates = family.name.starts_with("granulates"), apart = family.name.ends_with("apart");
  const int number = number_in(family.name);
  const double gap = (apart ? .1 : .01) * radius;
  MeshProblem problem{{}, {}, granulates ? .02 * radius : gap + 1e-5 * radius};
  Random random(seed);
  const auto body = [&](int k) -> const Mesh* {
    if (granulates)
      problem.meshes.push_back(std::make_unique<Mesh>(
          granulate(2 * radius, number, 2 * seed * static_cast<std::uint64_t>(pairs) + static_cast<std::uint64_t>(k))));
    else if (problem.meshes.empty())
      problem.meshes.push_back(std::make_unique<Mesh>(
          icosphere(radius, static_cast<int>(std::lround(std::log(number / 20.) / std::log(4.))))));
    return problem.meshes.back().get();
  };
  for (int k = 0; k < pairs; ++k) {
    const Mesh *a = body(2 * k), *b = body(2 * k + 1);
    const Eigen::Matrix3d turn = rotation(random);
    MeshPair& pair = problem.pairs.emplace_back(MeshPair{a, b, turn, gaussian(random).normalized()});
    set_gap(pair, granulates ? 2.2 * radius : 2 * radius + 2 * gap, gap); // spheres are too many triangles from afar
  }
  if (cuts != Cuts::adaptive)
    for (auto& mesh : problem.meshes) index_triangles(*mesh, cuts);
  return problem;
}

double smooth_gap_error(const MeshProblem& spheres) {
  double worst = 0;
  for (const MeshPair& pair : spheres.pairs)
    worst = std::max(worst, (.01 * radius - (pair.translation.norm() - 2 * radius)) / radius);
  return worst;
}

} // namespace trigrain
