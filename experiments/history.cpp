#include "experiments/history.hpp"
#include <nlohmann/json.hpp>
#include <numeric>

namespace trigrain {

void History::add(const StepStats& step, const Simulation& simulation) {
  sum_ += step;
  if (sum_.steps < every_) return;
  rows_.push_back({simulation.time(), simulation.step_size(), sum_});
  sum_ = {};
}

nlohmann::ordered_json History::to_json() const {
  nlohmann::ordered_json columns = {{"every", every_}};
  const auto column = [&](const char* name, const auto& value_of) {
    auto& values = columns[name] = nlohmann::ordered_json::array();
    for (const Row& row : rows_) values.push_back(value_of(row));
  };
  column("time_s", [](const Row& r) { return r.time; });
  column("step_s", [](const Row& r) { return r.step; });
  column("wall_s", [](const Row& r) { return std::accumulate(r.sum.seconds.begin(), r.sum.seconds.end(), 0.); });
  column("candidate_pairs", [](const Row& r) { return r.sum.candidate_pairs; });
  column("body_pairs", [](const Row& r) { return r.sum.body_pairs; });
  column("contacts", [](const Row& r) { return r.sum.contacts; });
  column("visited_vertices", [](const Row& r) { return r.sum.visited_vertices; });
  column("cells", [](const Row& r) { return r.sum.cells; });
  column("refinements", [](const Row& r) { return r.sum.refinements; });
  column("coarsenings", [](const Row& r) { return r.sum.coarsenings; });
  column("settled_bodies", [](const Row& r) { return r.sum.settled_bodies; });
  return columns;
}

} // namespace trigrain
