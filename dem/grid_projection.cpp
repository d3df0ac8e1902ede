#include "dem/grid.hpp"
#include "dem/vectors.hpp"
#include "kernels/sphere.hpp"
#include <algorithm>
#include <cmath>

namespace trigrain {
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

/// Virtual copies: every occupied vertex of a finer level that a coarse body may reach. One worker has a body for
/// itself: what it remembers of a fixed one is not shared.
void Grid::project(const Particles& particles, Team& team) {
  constexpr int bodies_at_once = 16;
  const int bodies = static_cast<int>(coarse_.size()), blocks = (bodies + bodies_at_once - 1) / bodies_at_once;
  projected_.resize(std::max<std::size_t>(projected_.size(), blocks));
  for (std::vector<Copy>& block : projected_) block.clear();
  team.parallel_for(blocks, 1, [&](int begin, int end, int) {
    for (int i = begin * bodies_at_once; i < std::min(bodies, end * bodies_at_once); ++i)
      project_to_vertices(particles, coarse_[i], projected_[i / bodies_at_once]);
  });
  for (Vertex& v : vertex_) v.copies = {0, 0};
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
}

/// A body at vertex V has its centre within h/2 of V along each axis and is no larger than h, so it lies within h of V;
/// at the domain's border, where bodies outside count too, the box is open outwards.
void Grid::project_to_vertices(const Particles& particles, int body, std::vector<Copy>& into) {
  const bool fixed = particles.fixed(body);
  const Eigen::AlignedBox3d box = fixed ? fixed_.at(body).box : box_of(particles, body);
  for (int level = body_level_[body] + 1; level <= finest_; ++level) {
    if (vertices_of(level) == 0) continue;
    // Vertices up to h away: rounding to the nearest adds half a cell, and none that it should add is lost.
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant((.5 + 1e-9) * tree_.level(level).cell_size);
    const Index3 low = tree_.vertex_near(level, box.min() - margin),
                 high = tree_.vertex_near(level, box.max() + margin);
    const auto first = vertex_.begin() + level_vertices_[level], last = vertex_.begin() + level_vertices_[level + 1];
    const auto visit = [&](const auto v, const Index3& index) {
      if (!fixed || reaches(particles, body, level, index))
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

/// May a body at this vertex touch the fixed body? Meshes are asked for their triangles, and the answer is remembered:
/// neither moves.
bool Grid::reaches(const Particles& particles, int body, int level, const Index3& index) {
  if (tree_.on_border(level, index) || !particles.mesh[body]) return true;
  const auto [known, is_new] = fixed_.at(body).reaches.try_emplace(tree_.key(level, index), false);
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
