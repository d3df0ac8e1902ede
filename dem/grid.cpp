#include "dem/grid.hpp"
#include "kernels/sphere.hpp"
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace trigrain {
namespace {

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

Grid::Grid(const GridKind& kind, int subdivision, const Domain& domain, const Particles& particles)
    : tree_(kind, subdivision, domain, smallest_diameter(particles)) {
  const int n = particles.size();
  for (int i = 0; i < n; ++i) {
    diameter_.push_back(diameter_of(particles, i));
    target_.push_back(tree_.level_for(diameter_[i]));
    box_.push_back(box_of(particles, i));
  }
  body_level_.assign(n, 0);
  body_key_.assign(n, std::numeric_limits<std::uint64_t>::max());
  anchor_ = particles.position;
  wish_.assign(n, 0);
}

void Grid::update(const Particles& particles) {
  changed_.clear();
  settle_all(particles);
  tree_.sweep();
  std::sort(changed_.begin(), changed_.end());
  changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
  if (!changed_.empty()) {
    move_changed();
    find_coarse(particles);
    rebuild_vertices();
    find_partners();
  }
  if (!coarse_.empty() && (coarse_moves_ || !changed_.empty())) project(particles);
}

/// Bodies that moved to another vertex or were asked to drop; then those that may drop because cells were split.
void Grid::settle_all(const Particles& particles) {
  const std::int64_t refinements = tree_.refinements();
  for (int i = 0; i < particles.size(); ++i) {
    const bool placed = body_key_[i] != std::numeric_limits<std::uint64_t>::max();
    if (placed && !wish_[i]) {
      if (particles.fixed(i)) continue;
      const int level = body_level_[i];
      if (tree_.key(level, tree_.vertex_near(level, particles.position[i])) == body_key_[i]) continue;
    }
    settle(i, particles.position[i]);
    wish_[i] = 0;
  }
  if (tree_.refinements() == refinements) return;
  for (int i = 0; i < particles.size(); ++i)
    if (above_target(i) &&
        tree_.is_split_around(body_level_[i], tree_.vertex_near(body_level_[i], particles.position[i])))
      settle(i, particles.position[i]);
}

/// Takes a body from where it was to the finest vertex it may live at: down through cells that are split, or that the
/// kind lets it split. A wish of the last traversal splits one level.
void Grid::settle(int body, const Eigen::Vector3d& x) {
  for (int level = 0; level < body_level_[body]; ++level) tree_.leave(level, tree_.vertex_near(level, anchor_[body]));
  const GridKind& kind = tree_.kind();
  bool wish = wish_[body] != 0;
  int level = 0;
  for (; level < target_[body]; ++level) {
    const Index3 vertex = tree_.vertex_near(level, x);
    if (!tree_.is_split_around(level, vertex)) {
      const bool alone =
          kind.may_refine({.child_size = tree_.level(level + 1).cell_size, .diameter = diameter_[body], .bodies = 1});
      if (!alone && !wish) break;
      wish = alone && wish;
    }
    tree_.enter(level, vertex);
  }
  anchor_[body] = x;
  const std::uint64_t key = tree_.key(level, tree_.vertex_near(level, x));
  if (key != body_key_[body]) changed_.push_back(body);
  body_level_[body] = level;
  body_key_[body] = key;
}

/// The kind's answer for the pairs of `body`: those of them who could drop are marked.
void Grid::note_wishes(int body, const Particles& p, std::span<const BodyPair> pairs) const {
  const auto ask = [&](int i, int bodies, bool approaching) {
    if (!above_target(i)) return;
    const double child_size = tree_.level(body_level_[i] + 1).cell_size;
    if (tree_.kind().may_refine({child_size, diameter_[i], bodies, approaching}))
      std::atomic_ref<char>(wish_[i]).store(1, std::memory_order_relaxed);
  };
  ask(body, static_cast<int>(pairs.size()) + 1, false);
  for (const auto& [a, b] : pairs) {
    if (!above_target(a) && !above_target(b)) continue;
    const Eigen::Vector3d ab = p.position[b] - p.position[a];
    const double reach = (diameter_[a] + diameter_[b]) / 2;
    if (ab.squaredNorm() > reach * reach || ab.dot(p.velocity[b] - p.velocity[a]) >= 0) continue;
    ask(a, 2, true);
    ask(b, 2, true);
  }
}

/// Bodies that have occupied levels below their own.
void Grid::find_coarse(const Particles& particles) {
  finest_ = *std::max_element(body_level_.begin(), body_level_.end());
  coarse_.clear();
  coarse_moves_ = false;
  above_target_ = 0;
  for (int i = 0; i < particles.size(); ++i) {
    above_target_ += above_target(i);
    if (body_level_[i] == finest_) continue;
    coarse_.push_back(i);
    coarse_moves_ = coarse_moves_ || !particles.fixed(i);
  }
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
    const auto side = static_cast<std::int64_t>(tree_.row(level));
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
  for (const int body : coarse_) {
    if (!particles.fixed(body)) box_[body] = box_of(particles, body);
    for (int level = body_level_[body] + 1; level <= finest_; ++level)
      if (level_vertices_[level] < level_vertices_[level + 1]) project_to(particles, body, level);
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
void Grid::project_to(const Particles& particles, int body, int level) {
  const Spacetree::Level& l = tree_.level(level);
  const Eigen::AlignedBox3d& box = box_[body];
  const auto nearest = [&](const Eigen::Vector3d& x) { return tree_.vertex_near(level, x); };
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(1.5 * l.cell_size); // h, and half a cell for the rounding
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
    const Eigen::Vector3d local = particles.orientation[body].conjugate() * (vertex - particles.position[body]);
    const double corner = std::sqrt(3.) * tree_.level(level).cell_size; // of the box of half-width h
    const double reach = 1.001 * (corner + particles.halo[body]);
    std::vector<int> near;
    triangles_near_point(particles.mesh[body]->triangles.view(), {local.x(), local.y(), local.z()}, reach, near);
    known->second = !near.empty();
  }
  return known->second;
}

void Grid::pairs_of(int entry, const Particles& particles, std::vector<BodyPair>& pairs) const {
  const int a = order_[entry];
  const std::size_t first = pairs.size();
  const bool a_fixed = particles.fixed(a);
  const auto add = [&](int b) {
    if (!(a_fixed && particles.fixed(b))) pairs.push_back(a < b ? BodyPair{a, b} : BodyPair{b, a});
  };
  const Vertex& vertex = vertex_[entry_vertex_[entry]];
  for (int e = entry + 1; e < vertex.partners[0].end; ++e) add(order_[e]);
  for (int r = 1; r < 5; ++r)
    for (int e = vertex.partners[r].begin; e < vertex.partners[r].end; ++e) add(order_[e]);
  for (int c = vertex.copies.begin; c < vertex.copies.end; ++c) add(copies_[c]);
  if (above_target_ > 0) note_wishes(a, particles, std::span(pairs).subspan(first));
}

} // namespace trigrain
