#pragma once
#include "dem/phase_observer.hpp"
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace trigrain {

/// Every piece of work that the threads do, with its times: per thread a ring that holds the latest. One per process;
/// no thread may be at work when its functions are called.
class Trace {
 public:
  Trace();
  ~Trace();
  Trace(const Trace&) = delete;
  Trace& operator=(const Trace&) = delete;

  /// What a Simulation is to tell.
  const PhaseObserver* observer() const;
  /// Only what happens between these two is recorded.
  void start();
  void stop();
  /// A step ends here.
  void mark_step();
  /// Steps that are recorded as a whole: where a ring has run over, fewer than were run.
  int steps() const;

  /// Chrome's trace format: one complete event ("X") per piece, named after what it is, in us; args hold step, phase
  /// and, of tasks, their number and the pieces that spawned it.
  nlohmann::ordered_json chrome_json(const nlohmann::ordered_json& about) const;
};

} // namespace trigrain
