#include "dem/verlet_list.hpp"
#include "dem/vectors.hpp"
#include "kernels/name_table.hpp"
#include "kernels/precheck.hpp"
#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <utility>

namespace trigrain {
namespace {

/// Whether the bounding sphere of a body that moves, wider by a skin (m), is apart from the triangles of one that is
/// fixed: the bounding spheres of walls hold all grains.
bool is_apart_from_wall(const Particles& p, BodyPair pair, double skin) {
  static const Precheck& octree = row_named(prechecks(), "pre-check", "octree");
  static thread_local std::vector<int> near;
  const auto [body, wall] = p.fixed(pair.b) ? std::pair(pair.a, pair.b) : std::pair(pair.b, pair.a);
  if (!p.fixed(wall) || p.is_sphere(wall)) return false;
  const Mesh& mesh = *p.mesh[wall];
  octree.triangles({mesh.triangles.view(), &mesh.octree}, vec3(p.to_body(wall, p.position[body])),
                   p.radius[body] + p.halo[body] + p.halo[wall] + skin, near);
  return near.empty();
}

} // namespace

/// Notes how far bodies have moved since the last search; has one gone too far?
bool VerletList::note_moves(const Particles& p, Team& team) {
  constexpr int grain = 1024; // bodies a worker takes at a time
  std::atomic<bool> too_far = then_.empty();
  if (too_far) then_ = p.position;
  moved_.resize(then_.size());
  team.parallel_for(p.size(), grain, [&](int begin, int end, int) {
    double most = 0;
    for (int i = begin; i < end; ++i) {
      moved_[i] = (p.position[i] - then_[i]).norm();
      most = std::max(most, moved_[i]);
    }
    if (!(most <= skin_)) too_far.store(true, std::memory_order_relaxed);
  });
  return too_far;
}

void VerletList::search(Block& block, int first, int count, const Particles& particles) const {
  block.pairs.clear();
  block.compared = 0;
  for (int e = 0; e < count; ++e) {
    block.begin[e] = static_cast<int>(block.pairs.size());
    block.compared += source_->pairs_of(first + e, particles, Sieve::spheres, block.pairs);
    const auto new_ones = block.pairs.begin() + block.begin[e];
    const auto apart = [&](BodyPair pair) { return is_apart_from_wall(particles, pair, skin_); };
    block.pairs.erase(std::remove_if(new_ones, block.pairs.end(), apart), block.pairs.end());
  }
  block.begin[count] = static_cast<int>(block.pairs.size());
}

void VerletList::update(const Particles& particles, Team& team) {
  searched_ = note_moves(particles, team);
  if (!searched_) return;
  then_ = particles.position;
  moved_.assign(then_.size(), 0);
  source_->update(particles, team);
  entries_ = source_->entries();
  blocks_.resize((entries_ + block_entries - 1) / block_entries);
  team.parallel_for(static_cast<int>(blocks_.size()), 1, [&](int begin, int end, int) {
    for (int b = begin; b < end; ++b)
      search(blocks_[b], b * block_entries, std::min(block_entries, entries_ - b * block_entries), particles);
  });
}

std::int64_t VerletList::pairs_of(int entry, const Particles& particles, Sieve sieve,
                                  std::vector<BodyPair>& pairs) const {
  const Block& block = blocks_[entry / block_entries];
  const int begin = block.begin[entry % block_entries], end = block.begin[entry % block_entries + 1];
  const std::size_t before = pairs.size();
  pairs.insert(pairs.end(), block.pairs.begin() + begin, block.pairs.begin() + end);
  if (sieve == Sieve::spheres) { // without a branch for each, which in a packing no machine foresees
    BodyPair* kept = pairs.data() + before;
    for (int i = begin; i < end; ++i) {
      *kept = block.pairs[i];
      kept += spheres_overlap(particles, block.pairs[i]);
    }
    pairs.resize(kept - pairs.data());
  }
  return end - begin;
}

void VerletList::count(StepStats& stats) const {
  StepStats of_source;
  source_->count(of_source);
  if (searched_)
    for (const Block& block : blocks_) of_source.candidate_pairs += block.compared;
  else
    of_source.searches = of_source.settled_bodies = of_source.refinements = of_source.coarsenings = 0;
  stats += of_source;
}

} // namespace trigrain
