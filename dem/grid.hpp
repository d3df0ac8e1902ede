#pragma once
#include "dem/particles.hpp"
#include <cstdint>
#include <span>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace trigrain {

/// Two bodies that may touch; a < b.
struct BodyPair {
  int a, b;
};

/// What a grid kind is asked about a cell that could be split.
struct CellQuestion {
  double child_size;        ///< edge of the cells it would split into (m)
  double smallest_diameter; ///< 2 (radius + halo) of the smallest body that moves (m)
};

/// A rule over the one Grid: may this cell be refined?
struct GridKind {
  std::string_view name;
  std::string_view about;
  bool (*may_refine)(const CellQuestion&);
};

std::span<const GridKind> grid_kinds();

/// Multiscale spacetree (Krestenitis 2018; Weinzierl et al. 2016): the domain's cube is split in k^3 cells, level by
/// level. A body belongs to the vertex nearest to its centre on the finest level whose cells are at least as wide as 2
/// (radius + halo), so two bodies of one level can only touch if their vertices are those of a common cell. A body of a
/// coarser level appears as a virtual copy at every finer vertex whose bodies it may reach. Bodies outside the domain
/// count at its border; no pair is lost. Only vertices that hold bodies take memory.
class Grid {
 public:
  Grid(const GridKind& kind, int subdivision, const Domain& domain, const Particles& particles);

  /// Brings every body to its vertex and rebuilds the virtual copies. Sorted arrays are touched only if a body changed
  /// its vertex or a body that has virtual copies moved.
  void update(const Particles& particles);

  /// Units of traversal: entry e < entries() is one body in the order of vertices.
  int entries() const { return static_cast<int>(order_.size()); }
  /// Appends the pairs in which entry e is the one that reports; over all entries each candidate pair comes once.
  /// Pairs of two fixed bodies are left out.
  void pairs_of(int entry, const Particles& particles, std::vector<BodyPair>& pairs) const;

  int levels() const { return static_cast<int>(level_.size()); }
  int occupied_vertices() const { return static_cast<int>(vertex_.size()); }
  std::int64_t virtual_copies() const { return static_cast<std::int64_t>(copies_.size()); }

 private:
  struct Level {
    double cell_size;    // m
    int cells;           // per side
    std::uint64_t first; // key of the level's first vertex
  };
  struct Range {
    int begin, end; // entries
  };
  /// A vertex that holds bodies. Its partners are the vertices that follow it in key order and share a cell with it;
  /// in key order (x fastest) these are runs in five rows: its own, (y+1), (z+1, y-1), (z+1), (z+1, y+1).
  struct Vertex {
    std::uint64_t key;
    Range bodies;
    Range partners[5]; // partners[0] begins behind the vertex's own bodies
    Range copies;      // into copies_
  };
  using Reach = std::unordered_map<std::uint64_t, bool>;

  int level_for(double diameter) const;
  std::uint64_t key_at(int level, const Eigen::Array3i& index) const;
  Eigen::Array3i index_near(int level, const Eigen::Vector3d& x) const;
  void move_changed();
  void rebuild_vertices();
  void find_partners();
  void project(const Particles& particles);
  void project_to(const Particles& particles, int coarse, int level);
  bool reaches(const Particles& particles, int coarse, int level, const Eigen::Array3i& index);

  Domain domain_;
  std::vector<Level> level_;
  std::vector<int> body_level_;
  std::vector<std::uint64_t> body_key_; // of the body's vertex
  std::vector<int> order_;              // bodies sorted by (key, index)
  std::vector<int> entry_vertex_;       // vertex of each entry
  std::vector<Vertex> vertex_;          // sorted by key
  std::vector<int> level_vertices_;     // vertices of level l: [l], ..., [l + 1] - 1
  std::vector<int> copies_;             // virtual copies: bodies, by vertex
  std::vector<int> coarse_;             // bodies with occupied levels below their own
  std::vector<Eigen::AlignedBox3d> coarse_box_;
  std::vector<Reach> fixed_reach_; // per coarse body that is fixed: answers so far
  bool coarse_moves_ = false;
  std::vector<int> changed_, merged_; // scratch
  std::vector<char> has_changed_;
  std::vector<std::pair<int, int>> projected_; // scratch: (vertex, body)
};

} // namespace trigrain
