#pragma once
#include "kernels/proof/proof.hpp"
#include <limits>
#include <ostream>
#include <string>
#include <vector>

namespace trigrain {

inline constexpr double everywhere = std::numeric_limits<double>::infinity();

struct ReferencePair {
  Pair pair;
  double distance; ///< m, correctly rounded
};

/// data/tripairs_reference.csv; throws if a row is not understood.
std::vector<ReferencePair> reference_pairs();

Triangles only(const Triangle& t);
/// A kernel's answer for one pair, whatever the distance.
Closest solve(const Kernel& kernel, const Triangle& a, const Triangle& b);

inline void PrintTo(const Kernel& kernel, std::ostream* out) {
  *out << kernel.name << ' ' << kernel.precision << ' ' << kernel.lanes;
}

} // namespace trigrain
