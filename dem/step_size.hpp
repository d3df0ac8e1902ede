#pragma once
#include "dem/loads.hpp"
#include "dem/pair_source.hpp"
#include <span>
#include <string_view>

namespace trigrain {

/// What the step size may depend on. The source of pairs has just been updated; loads are those of the last step.
struct StepView {
  const Particles& particles;
  const PairSource& source;
  const Loads& loads;
  Eigen::Vector3d gravity; ///< m/s2
  double contact_step;     ///< the step that a contact needs (s)
  double last_step;        ///< s
};

/// How the time step follows the contacts.
struct StepControl {
  std::string_view name;
  std::string_view about;
  double (*next)(const StepView&); ///< s, at least contact_step
  bool guards_gaps;                ///< no contact can begin within a step that is longer than contact_step
};

std::span<const StepControl> step_controls();

} // namespace trigrain
