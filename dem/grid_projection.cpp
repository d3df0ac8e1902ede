#include "dem/grid.hpp"
#include "dem/vectors.hpp"
#include "kernels/sphere.hpp"
#include <algorithm>
#include <bit>
#include <cmath>

namespace trigrain {
namespace {

constexpr int grain = 1024; // vertices a worker takes at a time

} // namespace

/// World box of a body with halo and skin; exact for fixed meshes, of the bounding sphere for bodies that move.
Eigen::AlignedBox3d Grid::box_of(const Particles& p, int i) const {
  Eigen::AlignedBox3d box;
  if (p.fixed(i) && p.mesh[i]) {
    for (const auto& v : p.mesh[i]->vertices) box.extend(p.position[i] + p.orientation[i] * v);
  } else {
    box.extend(p.position[i] - Eigen::Vector3d::Constant(p.radius[i]));
    box.extend(p.position[i] + Eigen::Vector3d::Constant(p.radius[i]));
  }
  box.min().array() -= p.halo[i] + skin_;
  box.max().array() += p.halo[i] + skin_;
  return box;
}

/// A vertex that held bodies in the last step knows its walls, if the same ones stand at the same vertices.
void Grid::find_walls(const Particles& particles, Team& team) {
  constexpr std::uint64_t unknown = std::uint64_t{1} << 63;
  if (walls_.empty()) return;
  if (walls_ != last_walls_ || std::any_of(walls_.begin(), walls_.end(), [&](int i) { return has_changed_[i] != 0; }))
    known_walls_.clear();
  team.parallel_for(occupied_vertices(), grain, [&](int begin, int end, int) {
    auto known =
        std::lower_bound(known_walls_.begin(), known_walls_.end(), std::pair(vertex_[begin].key, std::uint64_t{0}));
    for (Vertex& v : std::span(vertex_).subspan(begin, end - begin)) {
      while (known != known_walls_.end() && known->first < v.key) ++known;
      v.walls = known != known_walls_.end() && known->first == v.key ? known->second : unknown;
    }
  });
  for (int level = 0; level <= finest_; ++level)
    for (Vertex& v : std::span(vertex_).subspan(level_vertices_[level], vertices_of(level))) {
      if (v.walls != unknown) continue;
      v.walls = 0;
      const Index3 index = tree_.vertex_of(level, v.key);
      for (std::size_t i = 0; i < walls_.size(); ++i) {
        if (body_level_[walls_[i]] >= level) continue;
        const auto [low, high] = reach_of(fixed_box_.at(walls_[i]), level);
        if ((index >= low).all() && (index <= high).all() && reaches(particles, walls_[i], level, index))
          v.walls |= std::uint64_t{1} << i;
      }
    }
}

/// Virtual copies: every occupied vertex of a finer level that a coarse body may reach.
void Grid::project(const Particles& particles, Team& team) {
  constexpr int movers_at_once = 16;
  const int movers = static_cast<int>(movers_.size()), blocks = (movers + movers_at_once - 1) / movers_at_once;
  projected_.resize(std::max<std::size_t>(projected_.size(), blocks + 1)); // last: fixed bodies that are not in walls_
  for (std::vector<Copy>& block : projected_) block.clear();
  team.parallel_for(blocks, 1, [&](int begin, int end, int) {
    for (int i = begin * movers_at_once; i < std::min(movers, end * movers_at_once); ++i)
      project_to(particles, movers_[i], box_of(particles, movers_[i]), projected_[i / movers_at_once]);
  });
  if (coarse_.size() > walls_.size() + movers_.size())
    for (const int body : coarse_)
      if (particles.fixed(body) && body > walls_.back())
        project_to(particles, body, fixed_box_.at(body), projected_.back());
  for (Vertex& v : vertex_) v.copies = {0, std::popcount(v.walls)};
  for (const std::vector<Copy>& block : projected_)
    for (const Copy& copy : block) ++vertex_[copy.vertex].copies.end;
  int count = 0;
  for (Vertex& v : vertex_) {
    v.copies.begin = count;
    count += v.copies.end;
    v.copies.end = v.copies.begin;
  }
  copies_.resize(count);
  for (const std::vector<Copy>& block : projected_)
    for (const Copy& copy : block) copies_[vertex_[copy.vertex].copies.end++] = copy.body;
  team.parallel_for(occupied_vertices(), grain, [&](int begin, int end, int) {
    for (Vertex& v : std::span(vertex_).subspan(begin, end - begin))
      for (std::uint64_t bits = v.walls; bits != 0; bits &= bits - 1)
        copies_[v.copies.end++] = walls_[std::countr_zero(bits)];
  });
}

/// The vertices of a level that bodies may live at which touch something in the box.
std::pair<Index3, Index3> Grid::reach_of(const Eigen::AlignedBox3d& box, int level) const {
  // Vertices up to h away: rounding to the nearest adds half a cell, and none that it should add is lost.
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant((.5 + 1e-9) * tree_.level(level).cell_size);
  return {tree_.vertex_near(level, box.min() - margin), tree_.vertex_near(level, box.max() + margin)};
}

/// A body at vertex V has its centre within h/2 of V along each axis and is no larger than h, so it lies within h of V;
/// at the domain's border, where bodies outside count too, the box is open outwards.
void Grid::project_to(const Particles& particles, int body, const Eigen::AlignedBox3d& box, std::vector<Copy>& into) {
  for (int level = body_level_[body] + 1; level <= finest_; ++level) {
    if (vertices_of(level) == 0) continue;
    const auto [low, high] = reach_of(box, level);
    const auto first = vertex_.begin() + level_vertices_[level], last = vertex_.begin() + level_vertices_[level + 1];
    const bool stands = particles.fixed(body);
    const auto visit = [&](const auto v, const Index3& index) {
      if (!stands || reaches(particles, body, level, index))
        into.push_back({static_cast<int>(v - vertex_.begin()), body});
    };
    const Eigen::Array3<std::int64_t> extent = (high - low + 1).cast<std::int64_t>();
    if (extent.y() * extent.z() * 8 > last - first) { // fewer vertices than searches
      for (auto v = first; v != last; ++v) {
        const Index3 index = tree_.vertex_of(level, v->key);
        if ((index >= low).all() && (index <= high).all()) visit(v, index);
      }
      continue;
    }
    const auto before = [](const Vertex& a, std::uint64_t k) { return a.key < k; };
    auto v = first;
    for (int z = low.z(); z <= high.z(); ++z)
      for (int y = low.y(); y <= high.y(); ++y) {
        const std::uint64_t row = tree_.key(level, {0, y, z}), begin = row + low.x();
        auto end = v; // rows lie near each other: it is found in steps that double
        for (std::ptrdiff_t step = 8; end != last && end->key < begin; step *= 2) {
          v = end;
          end += std::min(step, last - end);
        }
        v = std::lower_bound(v, end, begin, before);
        for (; v != last && v->key <= row + high.x(); ++v) visit(v, {int(v->key - row), y, z});
      }
  }
}

/// May a body at this vertex touch the coarse body? For fixed meshes by their triangles, remembered: neither moves.
bool Grid::reaches(const Particles& particles, int body, int level, const Index3& index) {
  if (tree_.on_border(level, index) || !particles.fixed(body) || !particles.mesh[body]) return true;
  const auto [known, is_new] = fixed_reach_[body].try_emplace(tree_.key(level, index), false);
  if (is_new) {
    const Eigen::Vector3d vertex = tree_.place_of(level, index);
    const double corner = std::sqrt(3.) * tree_.level(level).cell_size; // of the box of half-width h
    const double reach = 1.001 * (corner + particles.halo[body] + skin_);
    std::vector<int> near;
    triangles_near_point(particles.mesh[body]->triangles.view(), vec3(particles.to_body(body, vertex)), reach, near);
    known->second = !near.empty();
  }
  return known->second;
}

} // namespace trigrain
