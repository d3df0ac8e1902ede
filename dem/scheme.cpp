#include "dem/scheme.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>

namespace trigrain {
namespace {

constexpr int entries_at_once = 16; // small beside any scene, large beside handing out

/// Candidate pairs of entries [begin, end) that survive the body pre-check.
std::span<const BodyPair> surviving_pairs(const Detection& d, int begin, int end, WorkerBuffer& buffer) {
  buffer.pairs.clear();
  const Sieve sieve = d.narrow.precheck->spheres ? Sieve::spheres : Sieve::none;
  for (int entry = begin; entry < end; ++entry)
    buffer.candidate_pairs += d.source.pairs_of(entry, d.particles, sieve, buffer.pairs);
  buffer.body_pairs += static_cast<std::int64_t>(buffer.pairs.size());
  return buffer.pairs;
}

/// Compares pairs; those that are split stay in the worker's pool.
void compare(
    const Detection& d, std::span<const BodyPair> pairs, int worker,
    FunctionRef<void(SplitPair&)> on_split = [](SplitPair&) {}) {
  collide(d.particles, pairs, d.narrow, d.buffers[worker], d.layers.triangle ? &d.pools[worker].splits : nullptr,
          on_split);
}

// --- loops: one layer after the other

/// A loop that the team shares, or the caller runs alone.
void loop(Team& team, bool shared, int count, int grain, RangeBody body) {
  if (shared)
    team.parallel_for(count, grain, body);
  else if (count > 0)
    body(0, count, 0);
}

/// Calls visit(pool, begin, end) for the pools that hold items [begin, end), numbered through; count_of(pool) says how
/// many one has.
template <class Count, class Visit>
void for_items(std::vector<TaskPool>& pools, int begin, int end, const Count& count_of, const Visit& visit) {
  int first = 0;
  for (TaskPool& pool : pools) {
    const int count = count_of(pool), from = std::max(begin, first), to = std::min(end, first + count);
    if (from < to) visit(pool, from - first, to - first);
    first += count;
  }
}

template <class Count> int total(const std::vector<TaskPool>& pools, const Count& count_of) {
  int sum = 0;
  for (const TaskPool& pool : pools) sum += count_of(pool);
  return sum;
}

/// Parts of the split pairs of a pool, numbered through.
int parts_of(const TaskPool& pool) {
  int parts = 0;
  for (int i = 0; i < pool.splits.used; ++i) parts += pool.splits.all[i].parts;
  return parts;
}

void solve_numbered_part(const Detection& d, TaskPool& pool, int part, int worker) {
  int i = 0;
  for (; part >= pool.splits.all[i].parts; ++i) part -= pool.splits.all[i].parts;
  solve_part(d.particles, pool.splits.all[i], part, d.narrow, d.buffers[worker]);
}

/// Serial and plain: vertices, then the pairs of all vertices if they are a layer, then the parts of all split pairs.
void share_loops(const Detection& d, Team& team) {
  constexpr int pairs_at_once = 16;
  for (TaskPool& pool : d.pools) pool.clear();
  loop(team, d.layers.grid, d.source.entries(), entries_at_once, [&](int begin, int end, int worker) {
    for (int first = begin; first < end; first += entries_at_once) {
      const std::span pairs = surviving_pairs(d, first, std::min(end, first + entries_at_once), d.buffers[worker]);
      if (d.layers.particle)
        d.pools[worker].pairs.insert(d.pools[worker].pairs.end(), pairs.begin(), pairs.end());
      else
        compare(d, pairs, worker);
    }
  });
  const auto pairs_of = [](const TaskPool& pool) { return static_cast<int>(pool.pairs.size()); };
  if (d.layers.particle)
    team.parallel_for(total(d.pools, pairs_of), pairs_at_once, [&](int begin, int end, int worker) {
      for_items(d.pools, begin, end, pairs_of, [&](TaskPool& pool, int from, int to) {
        compare(d, std::span(pool.pairs).subspan(from, to - from), worker);
      });
    });
  if (d.layers.triangle)
    team.parallel_for(total(d.pools, parts_of), 1, [&](int begin, int end, int worker) {
      for_items(d.pools, begin, end, parts_of, [&](TaskPool& pool, int from, int to) {
        for (int part = from; part < to; ++part) solve_numbered_part(d, pool, part, worker);
      });
    });
}

// --- tasks: whoever meets work hands it over

/// Triangles that a pair may have to look at: decides how many pairs make a task worth its spawning.
int cost_of(const Particles& p, BodyPair pair) {
  const auto triangles = [&](int body) { return p.is_sphere(body) ? 1 : p.mesh[body]->triangles.size(); };
  return 8 + std::min(triangles(pair.a), 128) + std::min(triangles(pair.b), 128);
}

void compare_and_spawn(const Detection& d, std::span<const BodyPair> pairs, int worker, Spawn spawn) {
  compare(d, pairs, worker, [&](SplitPair& split) {
    for (int part = 0; part < split.parts; ++part) {
      DetectTask& task = d.pools[worker].next(Piece::part);
      task.split = &split;
      task.part = part;
      spawn(task);
    }
  });
}

/// Traverses entries; their comparisons become tasks of about equal cost if pairs are a layer.
void traverse(const Detection& d, int begin, int end, int worker, Spawn spawn) {
  constexpr int task_cost = 5000; // triangles: 20 to 200 us, by kernel and by how many pairs touch
  DetectTask* task = nullptr;
  int cost = 0;
  for (int first = begin; first < end; first += entries_at_once) {
    const std::span pairs = surviving_pairs(d, first, std::min(end, first + entries_at_once), d.buffers[worker]);
    if (!d.layers.particle) {
      compare_and_spawn(d, pairs, worker, spawn);
      continue;
    }
    for (const BodyPair pair : pairs) {
      if (!task) task = &d.pools[worker].next(Piece::compare);
      task->pairs.push_back(pair);
      cost += cost_of(d.particles, pair);
      if (cost < task_cost) continue;
      spawn(*task);
      task = nullptr;
      cost = 0;
    }
  }
  if (task) spawn(*task);
}

/// Producer-consumer: traversals spawn comparisons, and these the parts of split pairs; who is idle takes them. Without
/// the grid as a layer one thread traverses, as published. One join at the end.
void spawn_tasks(const Detection& d, Team& team) {
  const int entries = d.source.entries(), entries_of_task = (d.layers.particle ? 32 : 1) * entries_at_once;
  for (TaskPool& pool : d.pools) pool.clear();
  TaskPool& first = d.pools.back();
  if (!d.layers.grid)
    first.next(Piece::traverse).end = entries;
  else
    for (int begin = 0; begin < entries; begin += entries_of_task) {
      DetectTask& task = first.next(Piece::traverse);
      task.begin = begin;
      task.end = std::min(entries, begin + entries_of_task);
    }
  const int traversals = first.used;
  const auto producer = [&](Spawn spawn) {
    for (int i = 0; i < traversals; ++i) spawn(first.tasks[i]);
  };
  team.produce(producer, [&](const Task& task, int worker, Spawn spawn) {
    const auto& t = static_cast<const DetectTask&>(task);
    if (t.piece == Piece::traverse)
      traverse(d, t.begin, t.end, worker, spawn);
    else if (t.piece == Piece::compare)
      compare_and_spawn(d, t.pairs, worker, spawn);
    else
      solve_part(d.particles, *t.split, t.part, d.narrow, d.buffers[worker]);
  });
}

constexpr Scheme table[] = {
    {"serial", "one thread, in order", "serial", "none", share_loops},
    {"plain", "threads share out loops: vertices as published (Krestenitis 2018, ch. 8)", "openmp", "grid",
     share_loops},
    {"task", "producer-consumer: traversals spawn comparisons, idle threads take them (Krestenitis 2018, ch. 8)", "tbb",
     "grid+particle", spawn_tasks},
};

} // namespace

std::span<const Scheme> schemes() { return table; }

Layers layers_named(std::string_view names) {
  Layers layers;
  if (names == "none") return layers;
  for (std::string_view rest = names;;) {
    const std::size_t plus = rest.find('+');
    const std::string_view name = rest.substr(0, plus);
    if (name == "grid")
      layers.grid = true;
    else if (name == "particle")
      layers.particle = true;
    else if (name == "triangle")
      layers.triangle = true;
    else
      throw InputError("unknown layers '" + std::string(names) +
                       "'. Known: none, and grid, particle, triangle joined by +.");
    if (plus == std::string_view::npos) return layers;
    rest.remove_prefix(plus + 1);
  }
}

DetectTask& TaskPool::next(Piece piece) {
  if (used == static_cast<int>(tasks.size())) tasks.emplace_back();
  DetectTask& task = tasks[used++];
  task.piece = piece;
  task.pairs.clear();
  return task;
}

void TaskPool::clear() {
  used = splits.used = 0;
  pairs.clear();
}

} // namespace trigrain
