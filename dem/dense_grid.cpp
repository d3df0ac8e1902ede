#include "dem/dense_grid.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>
#include <limits>

namespace trigrain {

DenseGrid::DenseGrid(const GridKind& kind, int subdivision, const Domain& domain, const Particles& p, double skin)
    : skin_(skin), tree_(kind, subdivision, domain, smallest_diameter(p) + 2 * skin), next_(p.size()) {
  constexpr std::uint64_t most = 1 << 24;
  const int finest = tree_.levels() - 1;
  const std::uint64_t side = tree_.row(finest), vertices = tree_.level(finest).first + side * side * side;
  if (vertices > most)
    throw InputError("grid '" + std::string(kind.name) + "' would store " + std::to_string(vertices) +
                     " vertices (the smallest body asks for them). Take grid 'regular', which stores those in use.");
  first_.assign(vertices, -1);
  for (int i = 0; i < p.size(); ++i) {
    const int level = tree_.level_for(diameter(p, i));
    level_.push_back(level);
    room_.push_back(level == 0 ? std::numeric_limits<double>::infinity()
                               : (tree_.level(level).cell_size - diameter(p, i)) / 2 + skin_);
    finest_ = std::max(finest_, level);
  }
}

void DenseGrid::update(const Particles& p, Team&) {
  std::fill(first_.begin(), first_.end(), -1);
  for (int i = p.size() - 1; i >= 0; --i) { // backwards: the lists ascend
    int& first = first_[tree_.key(level_[i], tree_.vertex_near(level_[i], p.position[i]))];
    next_[i] = first;
    first = i;
  }
}

/// Bodies of coarser levels that one at this vertex may touch: two that touch are no farther apart along an axis than
/// half of both cells, and their vertices than both cells.
template <class Visit> void DenseGrid::for_coarser_bodies(int level, std::uint64_t key, const Visit& visit) const {
  const Eigen::Vector3d here = tree_.place_of(level, tree_.vertex_of(level, key));
  for (int coarser = 0; coarser < level; ++coarser) {
    const Eigen::Vector3d reach =
        Eigen::Vector3d::Constant(tree_.level(coarser).cell_size + tree_.level(level).cell_size);
    const Index3 low = tree_.vertex_near(coarser, here - reach), high = tree_.vertex_near(coarser, here + reach);
    for (int z = low.z(); z <= high.z(); ++z)
      for (int y = low.y(); y <= high.y(); ++y)
        for (int x = low.x(); x <= high.x(); ++x)
          for (int b = first_[tree_.key(coarser, {x, y, z})]; b >= 0; b = next_[b]) visit(b);
  }
}

std::int64_t DenseGrid::pairs_of(int entry, const Particles& p, Sieve sieve, std::vector<BodyPair>& pairs) const {
  if (first_[entry] < 0) return 0;
  std::int64_t compared = 0;
  const auto compare = [&](int a, int b) {
    ++compared;
    if (p.fixed(a) && p.fixed(b)) return;
    const double reach = (diameter(p, a) + diameter(p, b)) / 2;
    if (sieve == Sieve::none || (p.position[a] - p.position[b]).squaredNorm() <= reach * reach * (1 + 1e-12))
      pairs.push_back(a < b ? BodyPair{a, b} : BodyPair{b, a});
  };
  const int level = level_[first_[entry]];
  const std::uint64_t side = tree_.row(level);
  const std::uint64_t row[] = {side - 1, side * side - side - 1, side * side - 1, side * side + side - 1};
  for (int a = first_[entry]; a >= 0; a = next_[a]) {
    for (int b = next_[a]; b >= 0; b = next_[b]) compare(a, b);
    const auto compare_vertex = [&](std::uint64_t key) {
      for (int b = first_[key]; b >= 0; b = next_[b]) compare(a, b);
    };
    compare_vertex(entry + 1);
    for (const std::uint64_t begin : row)
      for (int x = 0; x < 3; ++x) compare_vertex(entry + begin + x);
    for_coarser_bodies(level, entry, [&](int b) { compare(a, b); });
  }
  return compared;
}

double DenseGrid::room(int body) const { return room_[body]; }

void DenseGrid::count(StepStats& stats) const {
  ++stats.searches;
  stats.settled_bodies += static_cast<std::int64_t>(level_.size());
  stats.levels += finest_ + 1;
  stats.cells += tree_.cells();
  stats.visited_vertices += entries();
}

} // namespace trigrain
