#pragma once
#include "dem/simulation.hpp"
#include <nlohmann/json_fwd.hpp>
#include <vector>

namespace trigrain {

/// What happened in the course of a run: one row for every so many steps.
class History {
 public:
  explicit History(std::int64_t every) : every_(every) {}
  /// A step has been done.
  void add(const StepStats& step, const Simulation& simulation);
  /// Columns of equal length (experiments/schema/record.json); rows whose steps are not complete are left out.
  nlohmann::ordered_json to_json() const;

 private:
  struct Row {
    double time, step; // s, at the row's end
    StepStats sum;     // over the row's steps
  };
  std::int64_t every_;
  StepStats sum_;
  std::vector<Row> rows_;
};

} // namespace trigrain
