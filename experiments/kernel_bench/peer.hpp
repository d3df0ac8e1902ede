#pragma once
#include "kernels/hits.hpp"
#include "kernels/triangles.hpp"
#include <limits>

namespace trigrain {

/// The answer of a library that gives points but no bounds.
inline Closest unbounded(const Vec3<double>& p, const Vec3<double>& q, double distance) {
  return {p, q, distance, 0, std::numeric_limits<double>::infinity()};
}

inline const Vec3<double>& corner(const Triangle& t, int k) { return k == 0 ? t.a0 : k == 1 ? t.a1 : t.a2; }

} // namespace trigrain
