#pragma once
#include "kernels/kernels.hpp"
#include "kernels/proof/families.hpp"
#include "kernels/proof/oracle.hpp"
#include <vector>

namespace trigrain {

/// Triangle pairs of a family and the truth about them. Pair k is triangle k of `a` and triangle k of `b`.
struct Problem {
  std::vector<Pair> pairs;
  std::vector<oracle::Quad> distance; ///< m, exact
  std::vector<double> scale;          ///< S, m
  Triangles a, b;
  std::vector<PairIndex> list; ///< (k, k)

  PairList pair_list() const { return {a.view(), b.view(), list}; }
  int size() const { return static_cast<int>(pairs.size()); }
};
Problem problem(const std::vector<Pair>& pairs);
Problem problem(const RandomFamily& family, std::uint64_t first, int count);

/// What a kernel's answers are held to, in S.
double tolerance_of(const Kernel& kernel);
/// Whether a kernel claims to find the distance, not only bounds of it.
bool finds_distance(const Kernel& kernel);

/// How far an answer is off, in S: the distance from the truth, the points from their triangles, |p - q| from the
/// distance.
struct Deviation {
  double distance = 0, points = 0, apart = 0;
};

struct Verdict {
  Deviation deviation;
  std::string fault; ///< what is wrong; "" if nothing
};

/// Whether an answer is right: all finite, lower <= d* <= upper, p in A and q in B, |p - q| = distance; for kernels
/// that find it also distance = d*, and zero if and only if d* is; all but the bounds and the zeros to `tolerance` S.
Verdict judged(const Closest& answer, const Pair& pair, const oracle::Quad& distance, double tolerance,
               bool finds_distance);

/// Distance of p from t (m), at most `good_enough` if that is so and else to rounding.
double distance_from(const Vec3<double>& p, const Triangle& t, double good_enough);

/// What came of a proof. Deviations are the largest.
struct Tally {
  const Kernel* kernel;
  std::int64_t pairs = 0, zeros = 0, fell_back = 0, faults = 0;
  Deviation worst;
  std::vector<std::string> examples; ///< the first faults: what is wrong, with which pair
};

/// Holds the kernels to the bars on pairs first, first + 1, ...: each answer judged(), the same bits at every power of
/// two, and the same contacts as brute force for reaches at, beside and around the distance.
std::vector<Tally> prove(const RandomFamily& family, std::span<const Kernel* const> kernels, std::uint64_t first,
                         int count);

} // namespace trigrain
