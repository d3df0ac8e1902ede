#pragma once
#include "dem/phase_observer.hpp"
#include <memory>
#include <span>
#include <string_view>
#include <utility>

namespace trigrain {

/// A borrowed callable: valid only while what it was made from lives.
template <class Signature> class FunctionRef;
template <class Result, class... Arguments> class FunctionRef<Result(Arguments...)> {
 public:
  template <class F> FunctionRef(F&& f) // NOLINT: implicit on purpose, so that a lambda can be passed
      : object_(const_cast<void*>(static_cast<const void*>(&f))), call_([](void* o, Arguments... a) -> Result {
          return (*static_cast<std::remove_reference_t<F>*>(o))(std::forward<Arguments>(a)...);
        }) {}
  Result operator()(Arguments... a) const { return call_(object_, std::forward<Arguments>(a)...); }

 private:
  void* object_;
  Result (*call_)(void*, Arguments...);
};

/// body(begin, end, worker): handle [begin, end); `worker` in [0, threads) is not used by two threads at once.
using RangeBody = FunctionRef<void(int begin, int end, int worker)>;
/// What is handed over; runtimes know no more of it than what to call it.
struct Task {
  Piece piece = Piece::compare;
};
/// Hands a task over; it may start at once, on another thread or on this one.
using Spawn = FunctionRef<void(const Task& task)>;
/// Runs on one thread and spawns tasks.
using Producer = FunctionRef<void(Spawn spawn)>;
/// Runs one task, which may spawn more.
using Consumer = FunctionRef<void(const Task& task, int worker, Spawn spawn)>;

class Team;

/// A library that runs our loops and tasks.
struct Runtime {
  std::string_view name;
  std::string_view about;
  void (*parallel_for)(Team&, int count, int grain, RangeBody body);
  void (*produce)(Team&, Producer producer, Consumer consumer);
};

std::span<const Runtime> runtimes();

/// `threads` workers of one runtime, the caller among them.
class Team {
 public:
  Team(const Runtime& runtime, int threads);
  ~Team();
  int threads() const { return threads_; }

  /// Shares [0, count) out in blocks of about `grain`; returns when all are done.
  void parallel_for(int count, int grain, RangeBody body);
  /// Producer-consumer: one thread runs `producer`, the others take what is spawned, and it helps once it has ended;
  /// returns when every task is done. Tasks outlive the call.
  void produce(Producer producer, Consumer consumer);

  /// From now on `observer` (may be null) is told of every piece of the phase that the workers run. The caller's own
  /// piece, which it has begun, is closed while it hands work out and waits.
  void observe(const PhaseObserver* observer, Phase phase) {
    observer_ = observer;
    phase_ = phase;
  }

  struct Arena; ///< what TBB needs to keep between calls
  Arena* arena() { return arena_.get(); }

 private:
  const Runtime& runtime_;
  int threads_;
  const PhaseObserver* observer_ = nullptr;
  Phase phase_{};
  std::unique_ptr<Arena> arena_;
};

} // namespace trigrain
