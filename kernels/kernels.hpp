#pragma once
#include "kernels/hits.hpp"
#include "kernels/triangles.hpp"
#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace trigrain {

/// Constants of the penalty method, in units of the trace of H = 2 W^T W so that they hold at every scale: penalty
/// weight (lambda^2 = 0.0125 tr H is in it), damping of the first Newton step, and its factor from step to step.
struct PenaltySchedule {
  std::string_view name;
  std::string_view about;
  double weight, damping, growth;
};

std::span<const PenaltySchedule> penalty_schedules();

inline constexpr int largest_batch = 64;

/// What is asked of a kernel, and how hard it may try.
struct Query {
  double reach = std::numeric_limits<double>::infinity();        ///< report pairs with distance <= reach (m)
  int steps = 4;                                                 ///< Newton steps of iterative and hybrid kernels
  double tolerance = 6 * std::numeric_limits<double>::epsilon(); ///< of a hybrid's proof: upper - lower, in S
  int batch = 8; ///< pairs that hybrid-batch proves, or redoes, together: 1 to largest_batch
  const PenaltySchedule* schedule = &penalty_schedules()[0];
};

/// What a kernel did; added to, never reset.
struct KernelCounts {
  std::int64_t triangle_pairs = 0; ///< pairs looked at
  std::int64_t newton_steps = 0;   ///< Newton steps of iterative and hybrid kernels, one per pair and step
  std::int64_t fall_backs = 0;     ///< pairs redone by scalar brute force
};

/// Triangle i of A against triangle j of B.
struct PairIndex {
  int i, j;
};

/// What a kernel works on: a list of pairs of the triangles of A and B.
struct PairList {
  TrianglesView a, b;
  std::span<const PairIndex> pairs;

  int size() const { return static_cast<int>(pairs.size()); }
  PairList part(int first, int count) const {
    return {a, b, pairs.subspan(first, std::min<std::size_t>(count, pairs.size() - first))};
  }
};

/// The pairs of the list with distance <= reach, appended to `hits` in the order of the list. An answer depends on its
/// two triangles alone, never on the rest of the list (but for hybrid-batch, whose batches are the pairs 0-7, 8-15, ...
/// of the list): a list may be cut and its parts solved anywhere.
using KernelFunction = void (*)(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts);

/// A way to answer "which points of two triangles are closest?", in one precision and width.
struct Kernel {
  std::string_view name;
  std::string_view precision; ///< "double", "float" (search and answer), "mixed" (float search, double answer)
  int lanes;                  ///< pairs computed at once
  std::string_view about;     ///< one line, with the source of the method
  bool exact;                 ///< answers are right to 1e-14 S; else only honest: d is within [lower, upper]
  KernelFunction closest;
  double flops_per_pair; ///< declared work: floating-point operations of one pair without fall-back
  double bytes_per_pair; ///< declared traffic: bytes read and written for one pair without reuse
};

/// The kernel on all pairs of a x b, in ascending (i, j).
void closest_of_all(const Kernel& kernel, TrianglesView a, TrianglesView b, const Query& query, Hits& hits,
                    KernelCounts& counts);

/// Every kernel; rows of one name stand together.
std::span<const Kernel> kernels();

/// The kernel of that name and precision; lanes 0 is as many as fill a register of this build. InputError lists what
/// there is.
const Kernel& kernel_named(std::string_view name, std::string_view precision = "double", int lanes = 0);

} // namespace trigrain
