#pragma once
#include "experiments/kernel_bench/contestant.hpp"
#include <array>

namespace trigrain {

inline constexpr int most_steps = 16;

/// How right the answers to a problem are; shares are of all its pairs, errors of the distance in S.
struct Accuracy {
  double p50 = 0, p90 = 0, p99 = 0, worst = 0; ///< error
  double wrong = 0; ///< error above 1e-13 S (float 1e-6 S) or not a number, or zero where d* is not or the other way
  double wrong_unflagged = 0; ///< off by more than the tolerance asked for although its own bounds say otherwise
  double flagged = 0;         ///< bounds further apart than the tolerance asked for
  double faults = 0;          ///< fails a bar of kernel_proof; what the first one is:
  std::string first_fault = "";
  double contacts = 0; ///< within reach, per pair
  double fell_back = 0;
  double recall = 1; ///< of meshes: share of the true contacts that were found, mean over the pairs
};

Accuracy triangle_accuracy(const Contestant& contestant, const Problem& problem, const Query& query);

/// The iterative kernel step by step. proven[s]: share of pairs whose bounds agree to the tolerance for the first time
/// after s steps. `believed`: share whose points moved by no more than the tolerance (in S) in the last of query.steps
/// steps, the usual test of convergence; `believed_wrong`: those of them that are off by more.
struct Convergence {
  std::array<double, most_steps + 1> proven{};
  double believed = 0, believed_wrong = 0;
};
Convergence convergence(const Kernel& kernel, const Problem& problem, const Query& query);

/// Contacts of all mesh pairs against those of another pre-check and brute force in lanes (`none`, or `box` beyond 1500
/// triangles per mesh): wrong = pairs with another set of contacts or, for a peer, another least distance (by more than
/// 1e-9 S).
Accuracy mesh_accuracy(const Contestant& contestant, const MeshProblem& problem, const Query& query,
                       const Precheck& precheck);

} // namespace trigrain
