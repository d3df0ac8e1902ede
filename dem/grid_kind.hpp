#pragma once
#include <span>
#include <string_view>

namespace trigrain {

/// What a grid kind is asked about cells around one vertex. Bodies are those that would live on the finer level:
/// whose 2 (radius + halo) fits into the children.
struct CellQuestion {
  double child_size;        ///< edge of the cells it would split into (m)
  double diameter;          ///< 2 (radius + halo) of the smallest body that asks (m)
  int bodies = 0;           ///< bodies at the cells' vertices
  bool approaching = false; ///< two of them come closer and their bounding spheres with halo overlap
  double mass = 0;          ///< what annealing has left of the bodies that were here
};

/// A rule over the one Grid: may this cell be split? may its children go?
struct GridKind {
  std::string_view name;
  std::string_view about;
  bool (*may_refine)(const CellQuestion&);
  bool (*may_go)(const CellQuestion&);
  bool one_level = false;  ///< cells are as wide as the widest body that moves, for all bodies
  bool visits_all = false; ///< every vertex is stored and visited in every step, whether there are bodies or not
};

std::span<const GridKind> grid_kinds();

} // namespace trigrain
