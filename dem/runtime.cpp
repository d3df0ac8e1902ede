#include "dem/runtime.hpp"
#include <algorithm>
#include <omp.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>
#include <vector>

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

void serial_produce(Team&, Producer producer, Consumer consumer) {
  producer([&](const void* task) { consumer(task, 0); });
}

// --- OpenMP

void openmp_for(Team& team, int count, int grain, RangeBody body) {
  const int blocks = (count + grain - 1) / grain;
#pragma omp parallel for schedule(static, 1) num_threads(team.threads())
  for (int block = 0; block < blocks; ++block)
    body(block * grain, std::min(count, (block + 1) * grain), omp_get_thread_num());
}

void openmp_produce(Team& team, Producer producer, Consumer consumer) {
  const Consumer* run = &consumer; // outlives the tasks, which the frame that spawns them does not
#pragma omp parallel num_threads(team.threads())
#pragma omp single
  producer([run](const void* task) {
    const Consumer* consume = run;
#pragma omp task firstprivate(task, consume)
    (*consume)(task, omp_get_thread_num());
  });
  // The barrier at the end of `single` joins all tasks.
}

// --- TBB

void tbb_for(Team& team, int count, int grain, RangeBody body) {
  team.arena()->arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<int>(0, count, grain), [&](const tbb::blocked_range<int>& r) {
      body(r.begin(), r.end(), tbb::this_task_arena::current_thread_index());
    });
  });
}

void tbb_produce(Team& team, Producer producer, Consumer consumer) {
  team.arena()->arena.execute([&] {
    tbb::task_group tasks;
    producer([&](const void* task) {
      tasks.run([task, &consumer] { consumer(task, tbb::this_task_arena::current_thread_index()); });
    });
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
    const ObservedPiece piece(observer_, phase_);
    body(begin, end, worker);
  });
  observer_->begin(phase_);
}

void Team::produce(Producer producer, Consumer consumer) {
  if (!observer_) return runtime_.produce(*this, producer, consumer);
  observer_->end(phase_);
  const auto observed_producer = [&](Spawn spawn) {
    const ObservedPiece piece(observer_, phase_);
    producer([&](const void* task) { // a runtime may run the task at once, on this thread
      observer_->end(phase_);
      spawn(task);
      observer_->begin(phase_);
    });
  };
  runtime_.produce(*this, observed_producer, [&](const void* task, int worker) {
    const ObservedPiece piece(observer_, phase_);
    consumer(task, worker);
  });
  observer_->begin(phase_);
}

} // namespace trigrain
