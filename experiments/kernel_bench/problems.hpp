#pragma once
#include "experiments/kernel_bench/contestant.hpp"
#include <optional>

namespace trigrain {

/// What is asked of the contestants: pairs of triangles, those of kernel_proof and "every" (all of them in turn), or
/// pairs of meshes.
struct BenchFamily {
  std::string name, about;
  bool meshes = false;
};
std::vector<BenchFamily> bench_families();

/// `pairs` triangle pairs of a family that is not of meshes.
Problem triangle_problem(const BenchFamily& family, std::uint64_t seed, int pairs);

/// Pairs of bodies of radius about .5 m at a gap of .01 radii, or, where the name ends in "apart", of .1, and contacts
/// within .02 radii: "granulates" are two hulls of so many points, "spheres" two icospheres of so many triangles, whose
/// reach is only 1e-5 radii more than the gap: one small contact whatever the number of triangles.
MeshProblem mesh_problem(const BenchFamily& family, std::uint64_t seed, int pairs, Cuts cuts);

/// Two icospheres stand for two smooth spheres: largest difference of the two gaps, in radii.
double smooth_gap_error(const MeshProblem& spheres);

} // namespace trigrain
