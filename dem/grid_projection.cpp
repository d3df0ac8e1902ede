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

/// Virtual copies: every occupied vertex of a finer level that a coarse body may reach.
void Grid::project(const Particles& particles) {
  projected_.clear();
  for (const int body : coarse_) {
    const Eigen::AlignedBox3d box = particles.fixed(body) ? fixed_box_.at(body) : box_of(particles, body);
    for (int level = body_level_[body] + 1; level <= finest_; ++level)
      if (level_vertices_[level] < level_vertices_[level + 1]) project_to(particles, body, box, level);
  }
  copies_.resize(projected_.size());
  for (Vertex& v : vertex_) v.copies = {0, 0};
  for (const auto& [v, body] : projected_) ++vertex_[v].copies.end;
  int begin = 0;
  for (Vertex& v : vertex_) {
    const int count = v.copies.end;
    v.copies = {begin, begin};
    begin += count;
  }
  for (const auto& [v, body] : projected_) copies_[vertex_[v].copies.end++] = body;
}

/// A body at vertex V has its centre within h/2 of V along each axis and is no larger than h, so it lies within h of V;
/// at the domain's border, where bodies outside count too, the box is open outwards.
void Grid::project_to(const Particles& particles, int body, const Eigen::AlignedBox3d& box, int level) {
  const Spacetree::Level& l = tree_.level(level);
  const auto nearest = [&](const Eigen::Vector3d& x) { return tree_.vertex_near(level, x); };
  // Vertices up to h away: rounding to the nearest adds half a cell, and none that it should add is lost.
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant((.5 + 1e-9) * l.cell_size);
  const Index3 low = nearest(box.min() - margin), high = nearest(box.max() + margin);
  const auto first = vertex_.begin() + level_vertices_[level], last = vertex_.begin() + level_vertices_[level + 1];
  const auto visit = [&](int v, const Index3& index) {
    if (reaches(particles, body, level, index)) projected_.push_back({v, body});
  };
  const Eigen::Array3<std::int64_t> extent = (high - low + 1).cast<std::int64_t>();
  if (extent.y() * extent.z() * 8 > last - first) { // fewer vertices than searches
    for (auto v = first; v != last; ++v) {
      const Index3 index = tree_.vertex_of(level, v->key);
      if ((index >= low).all() && (index <= high).all()) visit(static_cast<int>(v - vertex_.begin()), index);
    }
    return;
  }
  for (int z = low.z(); z <= high.z(); ++z)
    for (int y = low.y(); y <= high.y(); ++y) {
      const std::uint64_t row = tree_.key(level, {0, y, z});
      auto v = std::lower_bound(first, last, row + low.x(), [](const Vertex& a, std::uint64_t k) { return a.key < k; });
      for (; v != last && v->key <= row + high.x(); ++v)
        visit(static_cast<int>(v - vertex_.begin()), {int(v->key - row), y, z});
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
