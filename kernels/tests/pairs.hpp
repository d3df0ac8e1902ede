#pragma once
#include "kernels/kernels.hpp"
#include <cstdint>
#include <limits>
#include <ostream>
#include <random>
#include <string>
#include <vector>

namespace trigrain {

inline constexpr double everywhere = std::numeric_limits<double>::infinity();

struct Pair {
  std::string family;
  Triangle a, b;
};
std::ostream& operator<<(std::ostream& out, const Pair& pair); ///< with hexadecimal coordinates, to be pasted

/// S = max(longest edge, largest coordinate), m: the unit of error.
double scale(const Pair& pair);

struct ReferencePair {
  Pair pair;
  double distance; ///< m, correctly rounded
};

/// data/tripairs_reference.csv; throws if a row is not understood.
std::vector<ReferencePair> reference_pairs();

/// Families of random pairs; each makes one pair of edges around 1 m from a seed.
struct RandomFamily {
  const char* name;
  Pair (*make)(std::mt19937_64&);
};
const std::vector<RandomFamily>& random_families();
/// Pair number k of a family: the same on every machine, moved, scaled and turned about by number.
Pair random_pair(const RandomFamily& family, std::uint64_t k);

/// Corners on a small integer lattice: touching, crossing, coplanar and degenerate pairs abound.
Pair lattice_pair(std::uint64_t k);

Triangles only(const Triangle& t);
/// A kernel's answer for one pair, whatever the distance.
Closest solve(const Kernel& kernel, const Triangle& a, const Triangle& b);

inline void PrintTo(const Kernel& kernel, std::ostream* out) {
  *out << kernel.name << ' ' << kernel.precision << ' ' << kernel.lanes;
}

/// What a kernel's answers are held to, in S.
inline double tolerance_of(const Kernel& kernel) { return kernel.precision == "float" ? 2e-6 : 1e-14; }
/// Whether it claims to find the distance, not only bounds of it.
inline bool finds_distance(const Kernel& kernel) { return kernel.name != "iterative"; }

/// "" if the answer is right: bounds, points in their triangles, |p - q| = upper, all finite; else what is wrong.
/// `tolerance` in S; kernels that find it must also give `distance` itself and zero only for zero.
std::string fault(const Closest& c, const Pair& pair, double distance, double tolerance, bool finds_distance);

} // namespace trigrain
