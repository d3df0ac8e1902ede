#pragma once
#include "dem/step_stats.hpp"

namespace trigrain {

/// Told, on the thread itself, where a piece of a phase's work begins and ends. The pieces of a thread do not nest, and
/// none waits for another thread: what is counted in them is work.
struct PhaseObserver {
  void (*begin)(Phase phase);
  void (*end)(Phase phase);
};

/// One piece of work: its scope. `observer` may be null.
class ObservedPiece {
 public:
  ObservedPiece(const PhaseObserver* observer, Phase phase) : observer_(observer), phase_(phase) {
    if (observer_) observer_->begin(phase_);
  }
  ~ObservedPiece() {
    if (observer_) observer_->end(phase_);
  }
  ObservedPiece(const ObservedPiece&) = delete;
  ObservedPiece& operator=(const ObservedPiece&) = delete;

 private:
  const PhaseObserver* observer_;
  Phase phase_;
};

} // namespace trigrain
