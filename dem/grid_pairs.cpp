#include "dem/grid.hpp"
#include <algorithm>
#include <atomic>
#include <limits>

namespace trigrain {

std::int64_t Grid::pairs_of(int entry, const Particles& particles, Sieve sieve, std::vector<BodyPair>& pairs) const {
  const int a = order_[entry];
  const std::size_t first = pairs.size();
  const bool a_fixed = particles.fixed(a);
  const auto add = [&](int b) {
    if (!(a_fixed && particles.fixed(b))) pairs.push_back(a < b ? BodyPair{a, b} : BodyPair{b, a});
  };
  const Vertex& vertex = vertex_[entry_vertex_[entry]];
  const Range own{entry + 1, vertex.partners[0].end};
  std::int64_t compared = vertex.copies.end - vertex.copies.begin;
  for (const Range range : {own, vertex.partners[1], vertex.partners[2], vertex.partners[3], vertex.partners[4]}) {
    compared += range.end - range.begin;
    if (sieve == Sieve::spheres)
      sphere_.for_overlapping(entry, range.begin, range.end, [&](int e) { add(order_[e]); });
    else
      for (int e = range.begin; e < range.end; ++e) add(order_[e]);
  }
  for (int c = vertex.copies.begin; c < vertex.copies.end; ++c) {
    const int b = copies_[c];
    if (sieve == Sieve::none || sphere_.overlap(entry, particles.position[b], diameter_[b] / 2)) add(b);
  }
  if (above_target_ > 0) note_wishes(a, compared, particles, std::span(pairs).subspan(first));
  return compared;
}

/// The kind's answer for a body that was compared with others, and for its `pairs`, which hold all that overlap: those
/// who could drop are marked.
void Grid::note_wishes(int body, std::int64_t compared, const Particles& p, std::span<const BodyPair> pairs) const {
  const auto ask = [&](int i, int bodies, bool approaching) {
    if (!above_target(i)) return;
    const double child_size = tree_.level(body_level_[i] + 1).cell_size;
    if (tree_.kind().may_refine({child_size, diameter_[i], bodies, approaching}))
      std::atomic_ref<char>(wish_[i]).store(1, std::memory_order_relaxed);
  };
  ask(body, static_cast<int>(compared) + 1, false);
  for (const auto& [a, b] : pairs) {
    if (!above_target(a) && !above_target(b)) continue;
    const Eigen::Vector3d ab = p.position[b] - p.position[a];
    const double reach = (diameter_[a] + diameter_[b]) / 2;
    if (ab.squaredNorm() > reach * reach || ab.dot(p.velocity[b] - p.velocity[a]) >= 0) continue;
    ask(a, 2, true);
    ask(b, 2, true);
  }
}

double Grid::room(int body) const {
  const int level = body_level_[body];
  double room = std::numeric_limits<double>::infinity();
  if (level > 0) room = (tree_.level(level).cell_size - diameter_[body]) / 2;
  if (!coarse_moves_) return room + skin_;
  // A virtual copy ends where the room of a body there does: it and the coarse body share that.
  for (int finer = level + 1; finer <= finest_; ++finer) room = std::min(room, level_room_[finer]);
  return room / 2 + skin_;
}

void Grid::count(StepStats& stats) const {
  ++stats.searches;
  stats.refinements += refinements_;
  stats.coarsenings += coarsenings_;
  stats.settled_bodies += settled_;
  stats.levels += occupied_levels();
  stats.cells += tree_.cells();
  stats.visited_vertices += occupied_vertices();
  stats.virtual_copies += virtual_copies();
}

} // namespace trigrain
