#include "dem/step_stats.hpp"

namespace trigrain {

StepStats& StepStats::operator+=(const StepStats& other) {
  for (std::size_t i = 0; i < seconds.size(); ++i) seconds[i] += other.seconds[i];
  steps += other.steps;
  candidate_pairs += other.candidate_pairs;
  body_pairs += other.body_pairs;
  searched_pairs += other.searched_pairs;
  triangle_pairs += other.triangle_pairs;
  newton_steps += other.newton_steps;
  fall_backs += other.fall_backs;
  contacts += other.contacts;
  fast_contacts += other.fast_contacts;
  fast_bodies += other.fast_bodies;
  unstable_steps += other.unstable_steps;
  crossings += other.crossings;
  visited_vertices += other.visited_vertices;
  virtual_copies += other.virtual_copies;
  levels += other.levels;
  cells += other.cells;
  refinements += other.refinements;
  coarsenings += other.coarsenings;
  settled_bodies += other.settled_bodies;
  searches += other.searches;
  return *this;
}

} // namespace trigrain
