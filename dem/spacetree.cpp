#include "dem/spacetree.hpp"
#include "kernels/name_table.hpp"
#include <cmath>

namespace trigrain {
namespace {

constexpr int most_cells = 1 << 19; // per side; keeps every key within 64 bits
constexpr double born_with = 4;     // mass of a new cell (Krestenitis 2018: 4 to 8)
constexpr double wider = 1 + 1e-9;  // cells against diameters: rounding must not lose a pair

/// Nearest of 0 ... cells; NaN becomes 0.
int nearest(double r, int cells) {
  const double index = std::floor(r + .5);
  return index > 0 ? static_cast<int>(std::min(index, static_cast<double>(cells))) : 0;
}

} // namespace

Spacetree::Spacetree(const GridKind& kind, int subdivision, const Domain& domain, double smallest_diameter)
    : kind_(kind), k_(subdivision), min_(domain.min) {
  if (subdivision < 2)
    throw InputError("subdivision must be at least 2 (is " + std::to_string(subdivision) + "). Use 2 or 3.");
  const CellQuestion pressed{.bodies = 1 << 20, .approaching = true};
  CellQuestion q = pressed;
  level_.push_back({domain.size, 1 / domain.size, 1, 0});
  cells_ = 1;
  while (true) {
    const Level last = level_.back();
    q.child_size = last.cell_size / k_;
    q.diameter = smallest_diameter * wider;
    if (last.cells > most_cells / k_ || !kind.may_refine(q)) break;
    const std::uint64_t side = last.cells + 3;
    level_.push_back({q.child_size, 1 / q.child_size, last.cells * k_, last.first + side * side * side});
    // A kind that splits even where there is no body splits everywhere.
    if (everywhere_ == levels() - 2 && kind.may_refine({.child_size = q.child_size, .diameter = q.diameter})) {
      ++everywhere_;
      cells_ += static_cast<std::int64_t>(std::pow(level_.back().cells, 3));
    }
  }
  cell_.resize(level_.size());
  empty_.resize(level_.size());
}

int Spacetree::level_for(double diameter) const {
  int level = 0;
  while (level + 1 < levels() && level_[level + 1].cell_size >= diameter * wider) ++level;
  return level;
}

Index3 Spacetree::vertex_near(int level, const Eigen::Vector3d& x) const {
  const Level& l = level_[level];
  const Eigen::Vector3d r = (x - min_) * l.inverse_size;
  return {nearest(r.x(), l.cells), nearest(r.y(), l.cells), nearest(r.z(), l.cells)};
}

Index3 Spacetree::vertex_of(int level, std::uint64_t key) const {
  const std::uint64_t k = key - level_[level].first, side = row(level);
  return {static_cast<int>(k % side) - 1, static_cast<int>(k / side % side) - 1,
          static_cast<int>(k / (side * side)) - 1};
}

/// The up to eight cells of the domain that have the vertex as a corner, until `visit` says false.
template <class Visit> void Spacetree::for_cells_around(int level, const Index3& vertex, const Visit& visit) const {
  const Index3 low = (vertex - 1).max(0), high = vertex.min(level_[level].cells - 1);
  for (int z = low.z(); z <= high.z(); ++z)
    for (int y = low.y(); y <= high.y(); ++y)
      for (int x = low.x(); x <= high.x(); ++x)
        if (!visit(Index3(x, y, z))) return;
}

bool Spacetree::is_split(int level, const Index3& cell) const {
  return everywhere(level) || cell_[level].contains(key(level, cell));
}

void Spacetree::visit_leaves(int level, const Index3& cell, FunctionRef<void(int, const Index3&)> visit) const {
  if (level + 1 == levels() || !is_split(level, cell)) return visit(level, cell);
  for (int z = 0; z < k_; ++z)
    for (int y = 0; y < k_; ++y)
      for (int x = 0; x < k_; ++x) visit_leaves(level + 1, cell * k_ + Index3(x, y, z), visit);
}

void Spacetree::for_each_leaf(FunctionRef<void(int level, const Index3& cell)> visit) const {
  visit_leaves(0, {0, 0, 0}, visit);
}

bool Spacetree::is_split_around(int level, const Index3& vertex) const {
  if (everywhere(level)) return true;
  bool all = true;
  for_cells_around(level, vertex, [&](const Index3& cell) { return all = cell_[level].contains(key(level, cell)); });
  return all;
}

/// Mass m of a cell with p bodies becomes m / 2 + p in each sweep; after n of them 2 p + (m - 2 p) / 2^n.
void Spacetree::age(Cell& cell) const {
  const auto sweeps = static_cast<int>(std::min<std::int64_t>(sweeps_ - cell.since, 2000));
  cell.mass = 2 * cell.bodies + std::ldexp(cell.mass - 2 * cell.bodies, -sweeps);
  cell.since = sweeps_;
}

void Spacetree::enter(int level, const Index3& vertex) {
  if (everywhere(level)) return;
  for_cells_around(level, vertex, [&](const Index3& index) {
    const auto [at, is_new] = cell_[level].try_emplace(key(level, index), Cell{.mass = born_with, .since = sweeps_});
    if (is_new) {
      cells_ += k_ * k_ * k_;
      ++refinements_;
      if (level > 0 && !everywhere(level - 1)) ++cell_[level - 1].at(key(level - 1, index / k_)).split_children;
    }
    age(at->second);
    ++at->second.bodies;
    return true;
  });
}

void Spacetree::leave(int level, const Index3& vertex) {
  if (everywhere(level)) return;
  for_cells_around(level, vertex, [&](const Index3& index) {
    Cell& cell = cell_[level].at(key(level, index));
    age(cell);
    if (--cell.bodies == 0) empty_[level].push_back(key(level, index));
    return true;
  });
}

void Spacetree::sweep() {
  ++sweeps_;
  for (int level = levels() - 1; level >= 0; --level) {
    std::vector<std::uint64_t> keys; // that wait for another sweep
    for (const std::uint64_t k : empty_[level]) {
      const auto at = cell_[level].find(k);
      if (at == cell_[level].end() || at->second.bodies > 0 || at->second.split_children > 0) continue;
      age(at->second);
      if (!kind_.may_go({.child_size = level_[level + 1].cell_size, .diameter = 0, .mass = at->second.mass})) {
        keys.push_back(k);
        continue;
      }
      cell_[level].erase(at);
      cells_ -= k_ * k_ * k_;
      ++coarsenings_;
      if (level == 0 || everywhere(level - 1)) continue;
      const std::uint64_t parent = key(level - 1, vertex_of(level, k) / k_);
      if (--cell_[level - 1].at(parent).split_children == 0) empty_[level - 1].push_back(parent);
    }
    empty_[level].swap(keys);
  }
}

} // namespace trigrain
