#pragma once
#include "dem/narrow_phase.hpp"
#include "dem/pair_source.hpp"
#include "dem/runtime.hpp"
#include <deque>
#include <span>
#include <string_view>
#include <vector>

namespace trigrain {

/// What detection is cut into, each layer on or off: the traversal of the grid's vertices, their body pairs, and the
/// triangle pairs of one body pair (Krestenitis 2018, ch. 6).
struct Layers {
  bool grid = false, particle = false, triangle = false;
};

/// "grid+triangle" and the like, "none". InputError for other names.
Layers layers_named(std::string_view names);

/// Entries of the grid to traverse, body pairs to compare, or a part of a split pair to solve.
struct DetectTask : Task {
  int begin = 0, end = 0;      ///< traverse: entries
  std::vector<BodyPair> pairs; ///< compare
  SplitPair* split = nullptr;  ///< part
  int part = 0;
};

/// What one worker hands over during a step. Refilling does not allocate, and references stay valid; two of them share
/// no cache line.
struct alignas(128) TaskPool {
  std::deque<DetectTask> tasks;
  int used = 0;
  SplitPairs splits;
  std::vector<BodyPair> pairs; ///< gathered for a loop

  DetectTask& next(Piece piece);
  void clear();
};

/// All that detection reads, and what it writes: one buffer and pool per worker of the team, and a pool for who starts.
struct Detection {
  const PairSource& source;
  const Particles& particles;
  const NarrowPhase& narrow;
  Layers layers;
  std::vector<WorkerBuffer>& buffers; ///< cleared by the caller
  std::vector<TaskPool>& pools;
};

/// Who runs which part of the traversal. Every scheme finds the same contacts, in any order of body pairs.
struct Scheme {
  std::string_view name;
  std::string_view about;
  std::string_view runtime; ///< used when none is asked for
  std::string_view layers;  ///< used when none are asked for
  void (*detect)(const Detection& detection, Team& team);
};

std::span<const Scheme> schemes();

} // namespace trigrain
