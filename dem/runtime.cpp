#include "dem/runtime.hpp"
#include <algorithm>
#include <omp.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

namespace trigrain {

/// TBB gives no more threads than the machine has cores unless a global_control allows them.
struct Team::Arena {
  explicit Arena(int threads)
      : allow(tbb::global_control::max_allowed_parallelism,
              std::max<std::size_t>(threads,
                                    tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism))),
        arena(threads) {}
  tbb::global_control allow;
  tbb::task_arena arena;
};

namespace {

// --- serial: the caller does all, in order

void serial_for(Team&, int count, int, RangeBody body) {
  if (count > 0) body(0, count, 0);
}

struct SerialSpawn {
  const Consumer& consumer;
  void operator()(const Task& task) const { consumer(task, 0, *this); }
};

void serial_produce(Team&, Producer producer, Consumer consumer) { producer(SerialSpawn{consumer}); }

// --- OpenMP

void openmp_for(Team& team, int count, int grain, RangeBody body) {
  const int blocks = (count + grain - 1) / grain;
#pragma omp parallel for schedule(static, 1) num_threads(team.threads())
  for (int block = 0; block < blocks; ++block)
    body(block * grain, std::min(count, (block + 1) * grain), omp_get_thread_num());
}

struct OpenmpSpawn { // outlives the tasks, which the frame that spawns them does not
  const Consumer& consumer;
  void operator()(const Task& task) const {
    const OpenmpSpawn* self = this;
    const Task* what = &task;
#pragma omp task firstprivate(self, what)
    self->consumer(*what, omp_get_thread_num(), *self);
  }
};

void openmp_produce(Team& team, Producer producer, Consumer consumer) {
  const OpenmpSpawn spawn{consumer};
#pragma omp parallel num_threads(team.threads())
#pragma omp single
  producer(spawn);
  // The barrier at the end of `single` joins all tasks.
}

// --- TBB

void tbb_for(Team& team, int count, int grain, RangeBody body) {
  team.arena()->arena.execute([&] {
    // The same blocks for every number of threads: what is traced on one holds for more.
    tbb::parallel_for(
        tbb::blocked_range<int>(0, count, grain),
        [&](const tbb::blocked_range<int>& r) {
          body(r.begin(), r.end(), tbb::this_task_arena::current_thread_index());
        },
        tbb::simple_partitioner());
  });
}

struct TbbSpawn {
  tbb::task_group& tasks;
  const Consumer& consumer;
  void operator()(const Task& task) const {
    tasks.run([this, &task] { consumer(task, tbb::this_task_arena::current_thread_index(), *this); });
  }
};

void tbb_produce(Team& team, Producer producer, Consumer consumer) {
  team.arena()->arena.execute([&] {
    tbb::task_group tasks;
    const TbbSpawn spawn{tasks, consumer};
    producer(spawn);
    tasks.wait();
  });
}

constexpr Runtime table[] = {
    {"serial", "the calling thread alone", serial_for, serial_produce},
    {"openmp", "OpenMP: blocks dealt out in turn, tasks by omp task", openmp_for, openmp_produce},
    {"tbb", "oneTBB: blocks and tasks by work stealing", tbb_for, tbb_produce},
};

} // namespace

std::span<const Runtime> runtimes() { return table; }

Team::Team(const Runtime& runtime, int threads) : runtime_(runtime), threads_(threads) {
  if (runtime.parallel_for == tbb_for) arena_ = std::make_unique<Arena>(threads);
}

Team::~Team() = default;

void Team::parallel_for(int count, int grain, RangeBody body) {
  if (!observer_) return runtime_.parallel_for(*this, count, grain, body);
  observer_->end(phase_);
  runtime_.parallel_for(*this, count, grain, [&](int begin, int end, int worker) {
    const ObservedPiece piece(observer_, phase_, Piece::loop);
    body(begin, end, worker);
  });
  observer_->begin(phase_, Piece::serial, nullptr);
}

void Team::produce(Producer producer, Consumer consumer) {
  if (!observer_) return runtime_.produce(*this, producer, consumer);
  observer_->end(phase_);
  // A runtime may run the task at once, on this thread.
  const auto spawn_between = [this](Piece piece, const Task* spawner, Spawn spawn, const Task& task) {
    observer_->end(phase_);
    if (observer_->spawn) observer_->spawn(&task);
    spawn(task);
    observer_->begin(phase_, piece, spawner);
  };
  const auto observed_producer = [&](Spawn spawn) {
    const ObservedPiece piece(observer_, phase_, Piece::traverse);
    producer([&](const Task& task) { spawn_between(Piece::traverse, nullptr, spawn, task); });
  };
  runtime_.produce(*this, observed_producer, [&](const Task& task, int worker, Spawn spawn) {
    const ObservedPiece piece(observer_, phase_, task.piece, &task);
    consumer(task, worker, [&](const Task& next) { spawn_between(task.piece, &task, spawn, next); });
  });
  observer_->begin(phase_, Piece::serial, nullptr);
}

} // namespace trigrain
