#pragma once
#include "dem/phase_observer.hpp"
#include <string>

namespace trigrain {

/// Regions for likwid-perfctr -m, one per phase of a step and thread. LIKWID (GPL) is loaded at run time, and only
/// where likwid-perfctr started this program. It counts per CPU: every thread that works is tied to one of the CPUs
/// that LIKWID watches, in the order in which they first work. One per process, constructed before the first thread.
class LikwidMarker {
 public:
  /// std::runtime_error if likwid-perfctr waits for regions and its library cannot be loaded.
  LikwidMarker();
  ~LikwidMarker(); ///< hands the counts over
  LikwidMarker(const LikwidMarker&) = delete;
  LikwidMarker& operator=(const LikwidMarker&) = delete;

  bool active() const;
  /// What a Simulation is to tell; null if not active.
  const PhaseObserver* observer() const;
  /// Only what happens between these two is counted. No thread may be at work when they are called.
  void start();
  void stop();
  /// What would make the counts wrong: more threads than watched CPUs, or a refused region; empty if nothing.
  std::string trouble() const;
};

} // namespace trigrain
