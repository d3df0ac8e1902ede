#pragma once
#include "kernels/triangles.hpp"
#include <cstdint>
#include <ostream>
#include <random>
#include <span>
#include <string>
#include <string_view>

namespace trigrain {

struct Pair {
  std::string family;
  Triangle a, b;
};
std::ostream& operator<<(std::ostream& out, const Pair& pair); ///< with hexadecimal coordinates, to be pasted

/// S = max(longest edge, largest coordinate), m: the unit of error.
double scale(const Pair& pair);

using Random = std::mt19937_64;
struct TwoTriangles {
  Triangle a, b;
};

/// A kind of triangle pair, made at random. Edges are around 1 m where `about` does not say otherwise.
struct RandomFamily {
  std::string_view name;
  std::string_view about;
  TwoTriangles (*make)(Random&);
};
std::span<const RandomFamily> random_families();

/// Pair number k of a family: the same on every machine; half of them scaled by a power of two, corners and triangles
/// in any order.
Pair random_pair(const RandomFamily& family, std::uint64_t k);

} // namespace trigrain
