#pragma once
#include "dem/step_stats.hpp"

namespace trigrain {

/// What a piece of work is: of the caller alone while the others idle, a block of a loop that the team shares, or of
/// tasks the traversal of the grid, comparisons of body pairs, and parts of one body pair.
enum class Piece { serial, loop, traverse, compare, part };
inline constexpr std::array<std::string_view, 5> piece_names{"serial", "loop", "traverse", "compare", "part"};

/// Told, on the thread itself, where a piece of a phase's work begins and ends. The pieces of a thread do not nest, and
/// none waits for another thread: what is counted in them is work. `task` names the task that a piece is of, and null
/// all others; one that spawns consists of several pieces.
struct PhaseObserver {
  void (*begin)(Phase phase, Piece piece, const void* task);
  void (*end)(Phase phase);
  void (*spawn)(const void* task) = nullptr; ///< handed over between two pieces of the thread; may be null
};

/// One piece of work: its scope. `observer` may be null.
class ObservedPiece {
 public:
  ObservedPiece(const PhaseObserver* observer, Phase phase, Piece piece, const void* task = nullptr)
      : observer_(observer), phase_(phase) {
    if (observer_) observer_->begin(phase_, piece, task);
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
