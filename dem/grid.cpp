#include "dem/grid.hpp"
#include <algorithm>
#include <limits>

namespace trigrain {
namespace {

constexpr int grain = 1024; // bodies a worker takes at a time
constexpr std::uint64_t nowhere = std::numeric_limits<std::uint64_t>::max();

double diameter_of(const Particles& p, int i) { return 2 * (p.radius[i] + p.halo[i]); }

} // namespace

Grid::Grid(const GridKind& kind, int subdivision, const Domain& domain, const Particles& particles, double skin)
    : skin_(skin), tree_(kind, subdivision, domain,
                         (kind.one_level ? widest_diameter(particles) : smallest_diameter(particles)) + 2 * skin) {
  const int n = particles.size();
  diameter_.reserve(n);
  target_.reserve(n);
  for (int i = 0; i < n; ++i) {
    diameter_.push_back(diameter_of(particles, i) + 2 * skin);
    target_.push_back(tree_.level_for(diameter_[i]));
    if (particles.fixed(i)) fixed_.try_emplace(i, Fixed{box_of(particles, i), {}});
  }
  for (int l = 0; l < levels(); ++l) {
    double widest = 0;
    for (int i = 0; i < n; ++i)
      if (target_[i] >= l && diameter_[i] <= tree_.level(l).cell_size) widest = std::max(widest, diameter_[i]);
    level_room_.push_back((tree_.level(l).cell_size - widest) / 2);
  }
  body_level_.assign(n, 0);
  body_key_.assign(n, nowhere);
  anchor_ = particles.position;
  wish_.assign(n, 0);
}

void Grid::update(const Particles& particles, Team& team) {
  const std::int64_t refinements = tree_.refinements(), coarsenings = tree_.coarsenings();
  changed_.clear();
  settled_ = 0;
  settle_all(particles, team);
  tree_.sweep();
  refinements_ = tree_.refinements() - refinements;
  coarsenings_ = tree_.coarsenings() - coarsenings;
  std::sort(changed_.begin(), changed_.end());
  changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
  if (!changed_.empty()) {
    move_changed();
    find_coarse(particles);
    rebuild_vertices();
    const int rows = 5 * levels(), few = occupied_vertices() < 4096 ? rows : 1; // small grids are not worth handing out
    team.parallel_for(rows, few, [&](int begin, int end, int) {
      for (int i = begin; i < end; ++i) find_partners(i / 5, i % 5);
    });
  }
  sphere_.resize(entries());
  team.parallel_for(entries(), grain, [&](int begin, int end, int) {
    for (int e = begin; e < end; ++e) sphere_.set(e, particles.position[order_[e]], diameter_[order_[e]] / 2);
  });
  if (!coarse_.empty() && (coarse_moves_ || !changed_.empty())) project(particles, team);
}

/// Has a body been placed, and is it still nearest to its vertex?
bool Grid::is_at_home(int body, const Particles& particles) const {
  if (body_key_[body] == nowhere) return false;
  const int level = body_level_[body];
  return particles.fixed(body) ||
         tree_.key(level, tree_.vertex_near(level, particles.position[body])) == body_key_[body];
}

/// Bodies that moved to another vertex or were asked to drop; then those that may drop because cells were split.
void Grid::settle_all(const Particles& particles, Team& team) {
  const std::int64_t refinements = tree_.refinements();
  leaves_.resize(particles.size());
  team.parallel_for(particles.size(), grain, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) leaves_[i] = wish_[i] || !is_at_home(i, particles);
  });
  for (auto at = leaves_.begin(); (at = std::find(at, leaves_.end(), 1)) != leaves_.end(); ++at) {
    const auto i = static_cast<int>(at - leaves_.begin());
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
  ++settled_;
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
      if (vertex_.size() == vertex_.capacity()) vertex_.reserve(vertex_.size() + vertex_.size() / 8 + 64);
      vertex_.push_back({.key = body_key_[body], .bodies = {e, e}});
      level_vertices_[body_level_[body] + 1] = static_cast<int>(vertex_.size());
    }
    vertex_.back().bodies.end = e + 1;
    entry_vertex_[e] = static_cast<int>(vertex_.size()) - 1;
  }
  for (int l = 1; l <= levels(); ++l) level_vertices_[l] = std::max(level_vertices_[l], level_vertices_[l - 1]);
}

/// Keys ascend, so each row of partners is found by pointers that only move forward.
void Grid::find_partners(int level, int row) {
  const int begin = level_vertices_[level], end = level_vertices_[level + 1];
  if (row == 0) {
    for (int v = begin; v < end; ++v) {
      const int own = vertex_[v].bodies.end;
      const bool right = v + 1 < end && vertex_[v + 1].key == vertex_[v].key + 1;
      vertex_[v].partners[0] = {own, right ? vertex_[v + 1].bodies.end : own};
    }
    return;
  }
  const std::uint64_t side = tree_.row(level);
  const std::uint64_t offset[] = {0, side, side * side - side, side * side, side * side + side};
  int from = begin, to = begin;
  for (int v = begin; v < end; ++v) {
    const std::uint64_t middle = vertex_[v].key + offset[row];
    while (from < end && vertex_[from].key < middle - 1) ++from;
    to = std::max(to, from);
    while (to < end && vertex_[to].key <= middle + 1) ++to;
    vertex_[v].partners[row] = from < to ? Range{vertex_[from].bodies.begin, vertex_[to - 1].bodies.end} : Range{};
  }
}

} // namespace trigrain
