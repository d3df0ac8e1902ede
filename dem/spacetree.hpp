#pragma once
#include "dem/grid_kind.hpp"
#include "dem/runtime.hpp"
#include "dem/scene.hpp"
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace trigrain {

/// Index of a vertex or cell on its level: x, y, z.
using Index3 = Eigen::Array3i;

/// The cells of a grid: the domain's cube, split in k^3, level by level, where the kind says so (Krestenitis 2018;
/// Weinzierl et al. 2016). A vertex hangs if not all cells around it exist; bodies live at vertices that do not hang.
/// Cells whose kind splits everywhere are not stored, and of the others only those that are split.
class Spacetree {
 public:
  struct Level {
    double cell_size, inverse_size; // m, 1/m
    int cells;                      // per side
    std::uint64_t first;            // key of the level's first vertex
  };

  /// Levels down to the finest that the kind allows for bodies of that diameter (m).
  Spacetree(const GridKind& kind, int subdivision, const Domain& domain, double smallest_diameter);

  int levels() const { return static_cast<int>(level_.size()); }
  const Level& level(int l) const { return level_[l]; }
  const GridKind& kind() const { return kind_; }
  /// The finest level whose cells are at least as wide as the diameter (m), whether there are such cells or not.
  int level_for(double diameter) const;

  /// The vertex of a level that is nearest to x (m); for points outside of the domain the one on its border.
  Index3 vertex_near(int level, const Eigen::Vector3d& x) const;
  /// Names a vertex among those of all levels: level by level, on a level x fastest, then y, then z. Keys of
  /// neighbours along an axis differ by 1, row(level) and row(level)^2, beyond the border too.
  std::uint64_t key(int level, const Index3& vertex) const {
    return level_[level].first + ((vertex.z() + 1) * row(level) + (vertex.y() + 1)) * row(level) + (vertex.x() + 1);
  }
  std::uint64_t row(int level) const { return static_cast<std::uint64_t>(level_[level].cells) + 3; }
  Index3 vertex_of(int level, std::uint64_t key) const;
  Eigen::Vector3d place_of(int level, const Index3& vertex) const {
    return min_ + vertex.cast<double>().matrix() * level_[level].cell_size;
  }
  bool on_border(int level, const Index3& vertex) const {
    return (vertex == 0).any() || (vertex == level_[level].cells).any();
  }

  /// Are all cells around the vertex split? Then no vertex of the next level within half a cell of it hangs.
  bool is_split_around(int level, const Index3& vertex) const;
  /// One body more, or one less, lives below the vertex; enter() splits the cells around that are not split.
  void enter(int level, const Index3& vertex);
  void leave(int level, const Index3& vertex);
  /// One sweep of annealing: cells that hold no body may go, children before parents.
  void sweep();

  /// Calls visit(level, cell) for every cell that is not split.
  void for_each_leaf(FunctionRef<void(int level, const Index3& cell)> visit) const;

  std::int64_t cells() const { return cells_; }             ///< on all levels
  std::int64_t refinements() const { return refinements_; } ///< cells split so far
  std::int64_t coarsenings() const { return coarsenings_; } ///< cells made whole again so far
  /// Is this cell split? Cells are numbered as the vertices at their lower corners.
  bool is_split(int level, const Index3& cell) const;

 private:
  struct Cell {
    int bodies = 0;         // that live below one of its vertices
    int split_children = 0; // it cannot go before them
    double mass = 0;        // at sweep `since`
    std::int64_t since = 0;
  };

  bool everywhere(int level) const { return level < everywhere_; }
  Cell& split(int level, const Index3& cell);
  void age(Cell& cell) const;
  void visit_leaves(int level, const Index3& cell, FunctionRef<void(int, const Index3&)> visit) const;
  template <class Visit> void for_cells_around(int level, const Index3& vertex, const Visit& visit) const;

  const GridKind& kind_;
  int k_;
  Eigen::Vector3d min_;
  std::vector<Level> level_;
  int everywhere_ = 0;                                        // levels above this are split everywhere
  std::vector<std::unordered_map<std::uint64_t, Cell>> cell_; // split cells per level
  std::vector<std::vector<std::uint64_t>> empty_;             // per level: split cells that may be about to go
  std::int64_t cells_ = 0, refinements_ = 0, coarsenings_ = 0, sweeps_ = 0;
};

} // namespace trigrain
