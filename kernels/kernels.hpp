#pragma once
#include "kernels/triangles.hpp"
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace trigrain {

/// Answer for one triangle pair: p on A, q on B (m), and bounds of the distance: lower <= d(A, B) <= upper = |p - q|.
struct Closest {
  Vec3<double> p, q;
  double upper, lower;
  bool fell_back = false; ///< a hybrid kernel could not prove its own answer and took brute force's
};

/// A triangle pair (i of A, j of B) whose `upper` is within reach.
struct Hit {
  int i, j;
  Closest closest;
};

/// What a kernel did; added to, never reset.
struct KernelCounts {
  std::int64_t triangle_pairs = 0; ///< pairs looked at
  std::int64_t newton_steps = 0;   ///< Newton steps of iterative and hybrid kernels, one per pair and step
  std::int64_t fall_backs = 0;     ///< pairs redone by brute force
};

/// All pairs of a x b with upper <= reach (m), appended to `hits` in ascending (i, j).
/// A reach of infinity reports every pair.
using KernelFunction = void (*)(TrianglesView a, TrianglesView b, double reach, std::vector<Hit>& hits,
                                KernelCounts& counts);

/// A way to answer "which points of two triangles are closest?"
struct Kernel {
  std::string_view name;
  std::string_view about; ///< one line, with the source of the method
  KernelFunction closest;
  double flops_per_pair; ///< declared work: floating-point operations of one pair without fall-back
  double bytes_per_pair; ///< declared traffic: bytes read and written for one pair without reuse
};

/// Every kernel; see row_named().
std::span<const Kernel> kernels();

} // namespace trigrain
