#pragma once
#include "kernels/triangles.hpp"
#include <optional>

namespace trigrain {

/// Do triangles a and b have a point in common? Decided exactly from the coordinates as given, zero-area triangles
/// included. If they do: where an edge of one meets the plane of the other, to rounding (m); where they only share a
/// plane or lie on a line, `guess`, the best common point known so far.
std::optional<Vec3<double>> common_point(const Triangle& a, const Triangle& b, const Vec3<double>& guess);

} // namespace trigrain
