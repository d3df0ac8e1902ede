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

/// Makes `in_a` those triangles of B, in A's frame. The one way to place triangles: the same triangle has the same bits
/// for every pre-check.
void place(TrianglesView b, const Placement& at, std::span<const int> numbers, Triangles& in_a);

/// Grows the list to at least `count` pairs; where it begins.
PairIndex* room_for_pairs(Candidates& c, std::size_t count);

inline Vec3<Octet> in_octet(const Vec3<double>& x) {
  return {broadcast<Octet>(x.x), broadcast<Octet>(x.y), broadcast<Octet>(x.z)};
}

/// Corners of eight triangles: coordinate(c) gives pack c of TrianglesView::coordinate.
template <class Coordinate> [[gnu::always_inline]] inline Corners<Octet> corners_of(const Coordinate& coordinate) {
  const auto at = [&](int c) { return Vec3<Octet>{coordinate(c), coordinate(c + 1), coordinate(c + 2)}; };
  return {at(0), at(3), at(6)};
}
/// Triangles first to first + 7.
[[gnu::always_inline]] inline Corners<Octet> corners_of(const TrianglesView& t, int first) {
  return corners_of([&](int c) { return load<Octet>(t.coordinate[c] + first); });
}
/// The eight triangles that are named from numbers[first] on; where there are fewer, the last again.
[[gnu::always_inline]] inline Corners<Octet> corners_of(const TrianglesView& t, std::span<const int> numbers,
                                                        std::size_t first) {
  std::array<int, 8> number;
  for (std::size_t lane = 0; lane < 8; ++lane) number[lane] = numbers[std::min(first + lane, numbers.size() - 1)];
  return corners_of([&](int c) { return gathered<Octet>([&](int lane) { return t.coordinate[c][number[lane]]; }); });
}

// Rows of the table of pre-checks.
using PairsFunction = void(const MeshView& a, const MeshView& b, const Placement& b_in_a, double reach, Candidates& c);
PairsFunction pairs_by_box, pairs_by_octree;
void triangles_by_octree(const MeshView& mesh, const Vec3<double>& point, double reach, std::vector<int>& indices);

} // namespace trigrain
