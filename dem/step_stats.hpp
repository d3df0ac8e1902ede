#pragma once
#include <array>
#include <cstdint>
#include <string_view>

namespace trigrain {

/// The phases of a step, in order; the names are those of records, traces and counter regions.
enum class Phase { grid, detect, merge, forces, integrate };
inline constexpr std::array<std::string_view, 5> phase_names{"grid", "detect", "merge", "forces", "integrate"};

/// What one step, or several summed, took and did.
struct StepStats {
  std::array<double, phase_names.size()> seconds{}; ///< wall time per Phase
  std::int64_t steps = 0;
  std::int64_t candidate_pairs = 0; ///< body pairs from the grid
  std::int64_t body_pairs = 0;      ///< body pairs that passed the body pre-check
  std::int64_t searched_pairs = 0;  ///< of these, pairs whose triangles were searched for what is near
  std::int64_t triangle_pairs = 0;  ///< triangle pairs the kernel looked at
  std::int64_t newton_steps = 0;
  std::int64_t fall_backs = 0;       ///< triangle pairs a hybrid kernel redid by brute force
  std::int64_t contacts = 0;         ///< contact points that carried force
  std::int64_t fast_contacts = 0;    ///< that undamped springs could not stop before surfaces cross, over steps
  std::int64_t fast_bodies = 0;      ///< that moved further than they can be seen, over steps: contacts may be missed
  std::int64_t unstable_steps = 0;   ///< of every 256th step with contacts: longer than contact_step_limit()
  std::int64_t crossings = 0;        ///< pairs found at distance 0: they have no normal and got no force
  std::int64_t visited_vertices = 0; ///< of the grid: those that hold bodies, or all of a dense one; over steps
  std::int64_t virtual_copies = 0;   ///< of coarse bodies at finer vertices, summed over steps
  std::int64_t levels = 0;           ///< of the grid down to the finest that holds a body, summed over steps
  std::int64_t cells = 0;            ///< of the grid, on all levels, summed over steps
  std::int64_t refinements = 0;      ///< cells that were split
  std::int64_t coarsenings = 0;      ///< split cells that were made whole again
  std::int64_t settled_bodies = 0;   ///< that the grid took to another vertex or asked to: its structural work
  std::int64_t searches = 0;         ///< steps in which the grid was updated and asked for pairs

  StepStats& operator+=(const StepStats& other);
};

} // namespace trigrain
