#pragma once
#include "dem/narrow_phase.hpp"
#include "dem/grid.hpp"
#include "dem/runtime.hpp"
#include <span>
#include <string_view>
#include <vector>

namespace trigrain {

/// All that detection reads, and the buffers it writes: one per worker of the team, cleared by the caller.
struct Detection {
  const Grid& grid;
  const Particles& particles;
  const NarrowPhase& narrow;
  std::vector<WorkerBuffer>& buffers;
};

/// Who runs which part of the traversal. Every scheme finds the same contacts, in any order of body pairs.
struct Scheme {
  std::string_view name;
  std::string_view about;
  std::string_view runtime; ///< used when none is asked for
  void (*detect)(const Detection& detection, Team& team);
};

std::span<const Scheme> schemes();

} // namespace trigrain
