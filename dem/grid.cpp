#include "dem/grid.hpp"
#include "kernels/name_table.hpp"
#include "kernels/sphere.hpp"
#include <algorithm>
#include <cmath>
#include <limits>

namespace trigrain {
namespace {

constexpr int most_cells = 1 << 19; // per side; keeps every key within 64 bits

constexpr GridKind table[] = {
    {"none", "one cell: every body meets every other", [](const CellQuestion&) { return false; }},
    {"regular", "cells everywhere as fine as the smallest body allows (Krestenitis 2018)",
     [](const CellQuestion& q) { return q.child_size >= q.smallest_diameter; }},
};

double diameter_of(const Particles& p, int i) { return 2 * (p.radius[i] + p.halo[i]); }

double smallest_diameter(const Particles& p) {
  double smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < p.size(); ++i)
    if (!p.fixed(i)) smallest = std::min(smallest, diameter_of(p, i));
  return smallest;
}

/// World box of a body with its halo; exact for fixed meshes, of the bounding sphere for bodies that move.
Eigen::AlignedBox3d box_of(const Particles& p, int i) {
  Eigen::AlignedBox3d box;
  if (p.fixed(i) && p.mesh[i]) {
    for (const auto& v : p.mesh[i]->vertices) box.extend(p.position[i] + p.orientation[i] * v);
  } else {
    box.extend(p.position[i] - Eigen::Vector3d::Constant(p.radius[i]));
    box.extend(p.position[i] + Eigen::Vector3d::Constant(p.radius[i]));
  }
  box.min().array() -= p.halo[i];
  box.max().array() += p.halo[i];
  return box;
}

} // namespace

std::span<const GridKind> grid_kinds() { return table; }

Grid::Grid(const GridKind& kind, int subdivision, const Domain& domain, const Particles& particles) : domain_(domain) {
  if (subdivision < 2)
    throw InputError("subdivision must be at least 2 (is " + std::to_string(subdivision) + "). Use 2 or 3.");
  const double smallest = smallest_diameter(particles);
  level_.push_back({domain.size, 1, 0});
  while (true) {
    const Level& last = level_.back();
    const double child_size = last.cell_size / subdivision;
    if (last.cells > most_cells / subdivision || !kind.may_refine({child_size, smallest})) break;
    const std::uint64_t side = last.cells + 3;
    level_.push_back({child_size, last.cells * subdivision, last.first + side * side * side});
  }
  const int n = particles.size();
  body_level_.resize(n);
  body_key_.assign(n, std::numeric_limits<std::uint64_t>::max());
  for (int i = 0; i < n; ++i) body_level_[i] = level_for(diameter_of(particles, i));
  const int finest = n == 0 ? 0 : *std::max_element(body_level_.begin(), body_level_.end());
  for (int i = 0; i < n; ++i) {
    if (body_level_[i] == finest) continue;
    coarse_.push_back(i);
    coarse_moves_ = coarse_moves_ || !particles.fixed(i);
  }
  coarse_box_.resize(coarse_.size());
  fixed_reach_.resize(coarse_.size());
  for (std::size_t c = 0; c < coarse_.size(); ++c) coarse_box_[c] = box_of(particles, coarse_[c]);
}

int Grid::level_for(double diameter) const {
  int level = 0;
  while (level + 1 < levels() && level_[level + 1].cell_size >= diameter) ++level;
  return level;
}

std::uint64_t Grid::key_at(int level, const Eigen::Array3i& index) const {
  const std::uint64_t side = level_[level].cells + 3;
  return level_[level].first + ((index.z() + 1) * side + (index.y() + 1)) * side + (index.x() + 1);
}

Eigen::Array3i Grid::index_near(int level, const Eigen::Vector3d& x) const {
  const Level& l = level_[level];
  const Eigen::Array3d r = ((x - domain_.min).array() / l.cell_size).round().max(0.).min(double(l.cells));
  return r.cast<int>();
}

void Grid::update(const Particles& particles) {
  changed_.clear();
  for (int i = 0; i < particles.size(); ++i) {
    if (particles.fixed(i) && body_key_[i] != std::numeric_limits<std::uint64_t>::max()) continue;
    const std::uint64_t key = key_at(body_level_[i], index_near(body_level_[i], particles.position[i]));
    if (key == body_key_[i]) continue;
    body_key_[i] = key;
    changed_.push_back(i);
  }
  if (!changed_.empty()) {
    move_changed();
    rebuild_vertices();
    find_partners();
  }
  if (!coarse_.empty() && (coarse_moves_ || !changed_.empty())) project(particles);
}

/// Takes the changed bodies out of the order and merges them in at their new places.
void Grid::move_changed() {
  const auto before = [this](int a, int b) {
    return body_key_[a] != body_key_[b] ? body_key_[a] < body_key_[b] : a < b;
  };
  has_changed_.assign(body_key_.size(), 0);
  for (int i : changed_) has_changed_[i] = 1;
  std::erase_if(order_, [this](int i) { return has_changed_[i] != 0; });
  std::sort(changed_.begin(), changed_.end(), before);
  merged_.resize(order_.size() + changed_.size());
  std::merge(order_.begin(), order_.end(), changed_.begin(), changed_.end(), merged_.begin(), before);
  order_.swap(merged_);
}

void Grid::rebuild_vertices() {
  vertex_.clear();
  entry_vertex_.resize(order_.size());
  level_vertices_.assign(levels() + 1, 0);
  for (int e = 0; e < entries(); ++e) {
    const int body = order_[e];
    if (vertex_.empty() || vertex_.back().key != body_key_[body]) {
      vertex_.push_back({.key = body_key_[body], .bodies = {e, e}});
      level_vertices_[body_level_[body] + 1] = static_cast<int>(vertex_.size());
    }
    vertex_.back().bodies.end = e + 1;
    entry_vertex_[e] = static_cast<int>(vertex_.size()) - 1;
  }
  for (int l = 1; l <= levels(); ++l) level_vertices_[l] = std::max(level_vertices_[l], level_vertices_[l - 1]);
}

/// Keys ascend, so each of the four rows of partners is found by a pointer that only moves forward.
void Grid::find_partners() {
  const int count = occupied_vertices();
  for (int level = 0; level < levels(); ++level) {
    const std::int64_t side = level_[level].cells + 3;
    const std::int64_t row[4] = {side, side * side - side, side * side, side * side + side};
    const int end = level_vertices_[level + 1];
    for (int v = level_vertices_[level]; v < end; ++v) {
      Vertex& vertex = vertex_[v];
      const bool right = v + 1 < count && vertex_[v + 1].key == vertex.key + 1;
      vertex.partners[0] = {vertex.bodies.end, right ? vertex_[v + 1].bodies.end : vertex.bodies.end};
    }
    for (int r = 0; r < 4; ++r) {
      int from = level_vertices_[level], to = from;
      for (int v = level_vertices_[level]; v < end; ++v) {
        const std::uint64_t middle = vertex_[v].key + row[r];
        while (from < end && vertex_[from].key < middle - 1) ++from;
        to = std::max(to, from);
        while (to < end && vertex_[to].key <= middle + 1) ++to;
        vertex_[v].partners[r + 1] =
            from < to ? Range{vertex_[from].bodies.begin, vertex_[to - 1].bodies.end} : Range{};
      }
    }
  }
}

/// Virtual copies: every occupied vertex of a finer level that a coarse body may reach.
void Grid::project(const Particles& particles) {
  projected_.clear();
  for (std::size_t c = 0; c < coarse_.size(); ++c) {
    const int body = coarse_[c];
    if (!particles.fixed(body)) coarse_box_[c] = box_of(particles, body);
    for (int level = body_level_[body] + 1; level < levels(); ++level)
      if (level_vertices_[level] < level_vertices_[level + 1]) project_to(particles, static_cast<int>(c), level);
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
void Grid::project_to(const Particles& particles, int coarse, int level) {
  const Level& l = level_[level];
  const Eigen::AlignedBox3d& box = coarse_box_[coarse];
  const auto nearest = [&](const Eigen::Vector3d& x) { return index_near(level, x); };
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(1.5 * l.cell_size); // h, and half a cell for the rounding
  const Eigen::Array3i low = nearest(box.min() - margin), high = nearest(box.max() + margin);
  const auto first = vertex_.begin() + level_vertices_[level], last = vertex_.begin() + level_vertices_[level + 1];
  const auto visit = [&](int v, const Eigen::Array3i& index) {
    if (reaches(particles, coarse, level, index)) projected_.push_back({v, coarse_[coarse]});
  };
  const Eigen::Array3<std::int64_t> extent = (high - low + 1).cast<std::int64_t>();
  if (extent.y() * extent.z() * 8 > last - first) { // fewer vertices than searches
    const std::uint64_t side = l.cells + 3;
    for (auto v = first; v != last; ++v) {
      const std::uint64_t k = v->key - l.first;
      const Eigen::Array3i index(int(k % side) - 1, int(k / side % side) - 1, int(k / (side * side)) - 1);
      if ((index >= low).all() && (index <= high).all()) visit(static_cast<int>(v - vertex_.begin()), index);
    }
    return;
  }
  for (int z = low.z(); z <= high.z(); ++z)
    for (int y = low.y(); y <= high.y(); ++y) {
      const std::uint64_t row = key_at(level, {0, y, z});
      auto v = std::lower_bound(first, last, row + low.x(), [](const Vertex& a, std::uint64_t k) { return a.key < k; });
      for (; v != last && v->key <= row + high.x(); ++v)
        visit(static_cast<int>(v - vertex_.begin()), {int(v->key - row), y, z});
    }
}

/// May a body at this vertex touch the coarse body? For fixed meshes by their triangles, remembered: neither moves.
bool Grid::reaches(const Particles& particles, int coarse, int level, const Eigen::Array3i& index) {
  const int body = coarse_[coarse];
  const bool border = (index == 0).any() || (index == level_[level].cells).any();
  if (border || !particles.fixed(body) || !particles.mesh[body]) return true;
  const auto [known, is_new] = fixed_reach_[coarse].try_emplace(key_at(level, index), false);
  if (is_new) {
    const double h = level_[level].cell_size;
    const Eigen::Vector3d vertex = domain_.min + index.cast<double>().matrix() * h;
    const Eigen::Vector3d local = particles.orientation[body].conjugate() * (vertex - particles.position[body]);
    const double reach = 1.001 * (std::sqrt(3.) * h + particles.halo[body]); // corner of the box of half-width h
    std::vector<int> near;
    triangles_near_point(particles.mesh[body]->triangles.view(), {local.x(), local.y(), local.z()}, reach, near);
    known->second = !near.empty();
  }
  return known->second;
}

void Grid::pairs_of(int entry, const Particles& particles, std::vector<BodyPair>& pairs) const {
  const int a = order_[entry];
  const bool a_fixed = particles.fixed(a);
  const auto add = [&](int b) {
    if (!(a_fixed && particles.fixed(b))) pairs.push_back(a < b ? BodyPair{a, b} : BodyPair{b, a});
  };
  const Vertex& vertex = vertex_[entry_vertex_[entry]];
  for (int e = entry + 1; e < vertex.partners[0].end; ++e) add(order_[e]);
  for (int r = 1; r < 5; ++r)
    for (int e = vertex.partners[r].begin; e < vertex.partners[r].end; ++e) add(order_[e]);
  for (int c = vertex.copies.begin; c < vertex.copies.end; ++c) add(copies_[c]);
}

} // namespace trigrain
