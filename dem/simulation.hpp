#pragma once
#include "dem/budget.hpp"
#include "dem/contact.hpp"
#include "dem/forces.hpp"
#include "dem/pair_source.hpp"
#include "dem/particles.hpp"
#include "dem/scene.hpp"
#include "dem/scheme.hpp"
#include "dem/step_stats.hpp"
#include <memory>
#include <string>

namespace trigrain {

/// Which variant does each job; every name is a row of a table.
struct Options {
  std::string kernel = "brute-simd";
  std::string precheck = "box";
  std::string grid = "regular";
  std::string contact_rule = "features";
  std::string scheme = "serial";
  std::string runtime = "default"; ///< "tbb", "openmp", or the one the scheme was published with
  std::string layers = "default";  ///< what is shared out: "grid", "particle", "triangle", joined by +
  int threads = 1;
  int subdivision = 3; ///< k: a grid cell splits into k^3
  double skin = 0;     ///< diameters of the smallest body it may move before the grid is asked again
  std::string triangle_search = "when-needed"; ///< of meshes; "every-step": nothing is kept from the step before
  const PhaseObserver* observer = nullptr;     ///< told of every piece of work; outlives the simulation
};

/// Mechanical energy (J); elastic is what the contact springs hold. The last three are sums since the start.
struct Energy {
  double kinetic = 0, potential = 0, elastic = 0;
  double damping = 0, friction = 0; ///< dissipated by dashpots, and by sliding and springs that were lost
  double outside = 0;               ///< work of loads from outside
  double total() const { return kinetic + potential + elastic; }
  /// total() and what has left it, less what has entered: constant, were the step infinitely short.
  double balance() const { return total() + damping + friction - outside; }
};

/// The engine: bodies, grid, contacts and time. Valid once constructed; nothing global.
class Simulation {
 public:
  /// InputError for unknown names and senseless values.
  Simulation(Scene scene, Options options);
  /// Candidate pairs come from that source instead of the grid that the options name.
  Simulation(Scene scene, Options options, std::unique_ptr<PairSource> source);
  ~Simulation();
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;

  StepStats step();
  /// `steps` steps; seconds and counts summed.
  StepStats run(std::int64_t steps);

  const Scene& scene() const; ///< without its bodies: those are particles()
  const Options& options() const;
  const Particles& particles() const;
  const PairSource& pair_source() const;
  const std::vector<Contact>& contacts() const;  ///< of the last step, in the order of ContactList
  double time() const;                           ///< s
  double step_size() const;                      ///< of the last step (s)
  Energy energy() const;                         ///< at the middle of the last step (see centred())
  Momentum momentum() const;                     ///< of all bodies
  Momentum momentum_error() const;               ///< momentum less what it was at the start and all impulses since
  const FastContact& first_fast_contact() const; ///< time 0, a -1 if there was none; StepStats counts them
  const FastContact& first_fast_body() const;    ///< the same of bodies that may have missed one; b is -1
  double contact_step_limit() const;             ///< largest stable step with the last step's contacts (s)
  /// 64 bits that differ when any bit of any position, orientation, velocity or angular momentum does.
  std::uint64_t state_hash() const;
  /// Force (N) and torque (N m) on a body during the next step only, beside gravity and contacts.
  void add_load(int body, const Eigen::Vector3d& force, const Eigen::Vector3d& torque);
  /// Takes a body that touches nothing elsewhere (m), turned as it is and without spin, from where it moves on at
  /// `velocity` (m/s). The books count what that changes as work and impulse from outside.
  void put(int body, const Eigen::Vector3d& position, const Eigen::Vector3d& velocity);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

} // namespace trigrain
