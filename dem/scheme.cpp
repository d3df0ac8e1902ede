#include "dem/scheme.hpp"
#include <deque>

namespace trigrain {
namespace {

/// Candidate pairs of one entry that survive the body pre-check, in buffer.pairs.
void surviving_pairs(const Detection& d, int entry, WorkerBuffer& buffer) {
  buffer.pairs.clear();
  d.grid.pairs_of(entry, d.particles, buffer.pairs);
  buffer.candidate_pairs += static_cast<std::int64_t>(buffer.pairs.size());
  std::erase_if(buffer.pairs, [&](BodyPair pair) { return !may_touch(d.particles, pair, *d.narrow.precheck); });
  buffer.body_pairs += static_cast<std::int64_t>(buffer.pairs.size());
}

/// Serial and plain: the workers of the team share the entries out.
void share_entries(const Detection& d, Team& team) {
  constexpr int grain = 16; // entries: small beside any scene, large beside the cost of handing out
  team.parallel_for(d.grid.entries(), grain, [&](int begin, int end, int worker) {
    WorkerBuffer& buffer = d.buffers[worker];
    for (int entry = begin; entry < end; ++entry) {
      surviving_pairs(d, entry, buffer);
      for (const BodyPair pair : buffer.pairs) collide(d.particles, pair, d.narrow, buffer);
    }
  });
}

/// A task: body pairs to compare.
using Batch = std::vector<BodyPair>;

/// Triangles that a pair may have to look at: decides how many pairs make a task worth its spawning.
int cost_of(const Particles& p, BodyPair pair) {
  const auto triangles = [&](int body) { return p.is_sphere(body) ? 1 : p.mesh[body]->triangles.size(); };
  return triangles(pair.a) + triangles(pair.b);
}

/// Producer-consumer: one thread traverses and spawns the comparisons, the others steal them; one join at the end.
void spawn_comparisons(const Detection& d, Team& team) {
  constexpr int task_cost = 1024; // triangles: some 20 us with the sphere pre-check
  std::deque<Batch> batches;      // a deque: tasks keep pointers into it
  WorkerBuffer traversal;         // the producer's own: it may help with tasks only once it has ended
  const auto producer = [&](Spawn spawn) {
    int cost = 0;
    batches.emplace_back();
    for (int entry = 0; entry < d.grid.entries(); ++entry) {
      surviving_pairs(d, entry, traversal);
      for (const BodyPair pair : traversal.pairs) {
        batches.back().push_back(pair);
        cost += cost_of(d.particles, pair);
        if (cost < task_cost) continue;
        spawn(&batches.back());
        batches.emplace_back();
        cost = 0;
      }
    }
    if (!batches.back().empty()) spawn(&batches.back());
  };
  team.produce(producer, [&](const void* task, int worker) {
    for (const BodyPair pair : *static_cast<const Batch*>(task))
      collide(d.particles, pair, d.narrow, d.buffers[worker]);
  });
  d.buffers[0].candidate_pairs += traversal.candidate_pairs;
  d.buffers[0].body_pairs += traversal.body_pairs;
}

constexpr Scheme table[] = {
    {"serial", "one thread, in order", "serial", share_entries},
    {"plain", "threads share out the grid's vertices (Krestenitis 2018, ch. 8)", "openmp", share_entries},
    {"task", "producer-consumer: one thread traverses and spawns comparisons (Krestenitis 2018, ch. 8)", "tbb",
     spawn_comparisons},
};

} // namespace

std::span<const Scheme> schemes() { return table; }

} // namespace trigrain
