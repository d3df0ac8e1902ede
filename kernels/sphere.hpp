#pragma once
#include "kernels/triangles.hpp"
#include <vector>

namespace trigrain {

struct Sphere {
  Vec3<double> centre; ///< m
  double radius;       ///< m
};

/// Points p on sphere A and q on sphere B along the line of centres, and gap = |cA - cB| - rA - rB, negative where the
/// spheres overlap (m). Concentric spheres: along x.
struct SphereClosest {
  Vec3<double> p, q;
  double gap;
};
SphereClosest closest_points(const Sphere& a, const Sphere& b);

/// Point of a triangle (m) and its squared distance (m2) from where it was asked for.
struct PointOnTriangle {
  Vec3<double> point;
  double distance2;
};

/// Point of triangle t closest to `point`: exact to a few epsilon of the largest coordinate. A sphere of radius r about
/// `point` has the gap sqrt(distance2) - r. Ericson (2005) 5.1.5.
PointOnTriangle closest_point(const Vec3<double>& point, const Triangle& t);

/// The same for each of many triangles and the origin, a pack at a time. Equal triangles get equal bits.
void closest_to_origin(TrianglesView t, std::vector<PointOnTriangle>& points);

/// Replaces `indices` by the triangles, ascending, whose distance from `centre` is at most `reach` (m): the contacts of
/// a sphere with a mesh, and the pre-check of two meshes by the bounding sphere of one. Conservative: none is missed,
/// and those further than reach + 32 epsilon E are left out, E being the largest coordinate of the triangle seen from
/// centre.
void triangles_near_point(TrianglesView t, const Vec3<double>& centre, double reach, std::vector<int>& indices);

} // namespace trigrain
