#pragma once
#include "kernels/octree.hpp"
#include "kernels/precheck.hpp"
#include "kernels/triangle_pair.hpp"
#include <cmath>

// GCC 12 miscompiles flattened functions over packs that are wider than a register.
#ifdef __AVX512F__
#define FLATTEN_OCTETS [[gnu::flatten]]
#else
#define FLATTEN_OCTETS
#endif

namespace trigrain {

// What the pre-checks share.

/// What rounding can do to a distance between the two meshes, in units of the largest coordinate.
inline constexpr double slack = 64 * epsilon;

/// No coordinate of two meshes is larger in A's frame (m).
inline double extent_of(const MeshView& a, const MeshView& b, const Placement& b_in_a) {
  return a.octree->radius() + b.octree->radius() + std::sqrt(squared(b_in_a.translation));
}

inline Vec3<double> placed(const Vec3<double>& x, const Placement& at) {
  return Vec3<double>{dot(at.rows[0], x), dot(at.rows[1], x), dot(at.rows[2], x)} + at.translation;
}

/// A direction or point of A's frame turned back into B's.
inline Vec3<double> turned_back(const Vec3<double>& u, const Placement& at) {
  return u.x * at.rows[0] + u.y * at.rows[1] + u.z * at.rows[2];
}

/// Box that holds the turned and moved box of B.
Box placed(const Box& b, const Placement& at);

/// Compiled once, not inlined: a triangle has the same bits for every pre-check.
Triangle placed(const Triangle& t, const Placement& at);

/// Appends those triangles of B, in A's frame.
void place(TrianglesView b, const Placement& at, std::span<const int> numbers, Triangles& in_a);
/// Fills `b` with the triangles that near_b names.
void place(const MeshView& b, const Placement& at, Candidates& c);

/// Grows the list to at least `count` pairs; where it begins.
PairIndex* room_for_pairs(Candidates& c, std::size_t count);

inline Vec3<Octet> in_octet(const Vec3<double>& x) { return {Octet(x.x), Octet(x.y), Octet(x.z)}; }

// Rows of the table of pre-checks.
using PairsFunction = void(const MeshView& a, const MeshView& b, const Placement& b_in_a, double reach, Candidates& c);
PairsFunction pairs_by_box, pairs_by_octree;
void triangles_by_octree(const MeshView& mesh, const Vec3<double>& point, double reach, std::vector<int>& indices);

} // namespace trigrain
