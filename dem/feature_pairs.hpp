#pragma once
#include "dem/mesh.hpp"
#include "kernels/precheck.hpp"
#include <array>
#include <span>
#include <vector>

namespace trigrain {

/// Which corners, edges and faces of two meshes may touch, with all that contacts need of the meshes, in few pieces of
/// memory. Features have names that neither cut nor order of the faces can change within one mesh: corners by vertex,
/// edges after them, whole pieces of surface below 0.
class FeaturePairs {
 public:
  using Point = Vec3<double>;
  struct Facet {
    std::array<int, 3> corner; ///< numbers of points
    int piece;                 ///< name of the connected piece of surface
  };
  struct Corner {
    int point, name;
  };
  struct Edge {
    int from, to; ///< points
    int name;
  };
  struct Pair {
    int first, second;
  };
  /// What one body has near the other. Each feature and point is used by some pair.
  template <template <class> class List> struct SideOf {
    List<Point> points; ///< in the body's own frame (m)
    List<Facet> facets;
    List<Corner> corners;
    List<Edge> edges;
  };
  template <class T> using View = std::span<const T>;
  template <class T> using Vector = std::vector<T>;
  using Side = SideOf<View>;
  /// Both sides and their pairs while they are looked for.
  struct Found {
    SideOf<Vector> a, b;
    std::vector<Pair> corners_of_a, corners_of_b, edges;
  };

  /// Copies what was found.
  void assign(const Found& found);
  bool empty() const { return pairs_.empty(); }
  Side a() const {
    return {first(points_, points_of_a_), first(facets_, facets_of_a_), first(corners_, corners_of_a_),
            first(edges_, edges_of_a_)};
  }
  Side b() const {
    return {rest(points_, points_of_a_), rest(facets_, facets_of_a_), rest(corners_, corners_of_a_),
            rest(edges_, edges_of_a_)};
  }
  /// A corner of that body and a facet of the other one, by corner.
  View<Pair> corner_pairs_of_a() const { return first(pairs_, end_of_a_); }
  View<Pair> corner_pairs_of_b() const { return rest(first(pairs_, end_of_b_), end_of_a_); }
  /// An edge of A and the first of as many of B as are computed with at once, by edge.
  View<Pair> edge_pairs() const { return rest(pairs_, end_of_b_); }

 private:
  template <class T> static View<T> first(View<T> list, int count) { return list.first(count); }
  template <class T> static View<T> rest(View<T> list, int from) { return list.subspan(from); }
  template <class T> static View<T> first(const std::vector<T>& list, int count) { return View<T>(list).first(count); }
  template <class T> static View<T> rest(const std::vector<T>& list, int from) { return View<T>(list).subspan(from); }

  std::vector<Point> points_; // of A, then of B; so are the others
  std::vector<Facet> facets_;
  std::vector<Corner> corners_;
  std::vector<Edge> edges_;
  std::vector<Pair> pairs_; // corners of A, corners of B, edges
  int points_of_a_ = 0, facets_of_a_ = 0, corners_of_a_ = 0, edges_of_a_ = 0, end_of_a_ = 0, end_of_b_ = 0;
};

/// A mesh in contact and those of its faces that are near the other one, in any order.
struct NearFaces {
  const Mesh* mesh;
  std::vector<int> faces;
};

/// What may touch, of the near faces, where B is and where no point of it is further than `margin` (m) from there:
/// edges closer than reach + margin (m), and of each corner and piece of surface the facets that may be closest. The
/// faces are sorted and each is left once.
void find_feature_pairs(NearFaces& a, NearFaces& b, const Placement& b_in_a, double reach, double margin,
                        FeaturePairs& pairs);

} // namespace trigrain
