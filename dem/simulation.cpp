#include "dem/simulation.hpp"
#include "dem/block_sum.hpp"
#include "dem/contact_law.hpp"
#include "dem/contact_list.hpp"
#include "dem/contact_step_limit.hpp"
#include "dem/critical_step.hpp"
#include "dem/forces.hpp"
#include "dem/motion.hpp"
#include "dem/step_size.hpp"
#include "dem/watch.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

namespace trigrain {
namespace {

// What a worker takes at a time:
constexpr int pair_grain = 128, turn_grain = 256, cheap_grain = 512; // some 100, 50 and 5 ns each

/// A phase of a step: adds the wall time of the scope, and tells who observes.
class PhaseScope {
 public:
  PhaseScope(StepStats& stats, Phase phase, Team& team, const PhaseObserver* observer)
      : seconds_(stats.seconds[static_cast<std::size_t>(phase)]), piece_(observer, phase, Piece::serial) {
    team.observe(observer, phase);
  }
  ~PhaseScope() { seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  double& seconds_;
  ObservedPiece piece_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

const Runtime& runtime_for(const Options& options, const Scheme& scheme) {
  if (options.runtime == "default" || scheme.runtime == "serial")
    return row_named(runtimes(), "runtime", scheme.runtime);
  return row_named(runtimes(), "runtime", options.runtime);
}

void set_to_zero(Loads& loads, int bodies) {
  loads.force.assign(bodies, Eigen::Vector3d::Zero());
  loads.torque.assign(bodies, Eigen::Vector3d::Zero());
}

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", x);
  return text;
}

} // namespace

struct Simulation::State {
  Scene scene;
  Options options;
  const Scheme& scheme;
  const StepControl& control;
  const ContactLaw& law;
  Particles particles;
  std::unique_ptr<KeptPairs> kept_pairs;
  NarrowPhase narrow;
  std::unique_ptr<PairSource> source;
  Team team;
  std::vector<WorkerBuffer> buffers;
  Layers layers;
  std::vector<TaskPool> pools;
  ContactList contacts;
  Loads loads, next_loads, outside; // next_loads: what add_load() gathered for the next step, empty before its first
                                    // call; outside: of this step
  MiddleMotion motion;              // of the last kick
  std::vector<KickSums> sums;       // scratch
  Budget budget;
  double tangential_energy = 0, pending = 0; // J, of the last step's tangential springs; of the second half of its kick
  Momentum start_momentum;
  Watch watch;
  bool has_next_loads = false, pushed = false; // pushed: there was something from outside in the last step
  double time = 0;
  StepLength step; // s

  /// Without a source it makes the one that the options ask for.
  State(Scene s, Options o, std::unique_ptr<PairSource> from)
      : scene(std::move(s)), options(std::move(o)), scheme(row_named(schemes(), "scheme", options.scheme)),
        control(row_named(step_controls(), "time.control", scene.time.control)), law(law_of(scene.contact)),
        particles(particles_of(scene)),
        kept_pairs(kept_pairs_for(options.triangle_search, kernel_named(options.kernel), particles)),
        narrow{&kernel_named(options.kernel), &row_named(prechecks(), "pre-check", options.precheck),
               &row_named(contact_rules(), "contact rule", options.contact_rule), kept_pairs.get()},
        source(from ? std::move(from)
                    : make_pair_source({options.grid, options.subdivision, options.skin}, scene.domain, particles)),
        team(runtime_for(options, scheme), threads_of(options)), watch(particles) {
    const int n = particles.size();
    require_law_fits(scene);
    const double largest_step = scene.time.force ? std::numeric_limits<double>::infinity() : critical_step(scene);
    if (!(scene.time.step > 0) || scene.time.step > largest_step)
      throw InputError("the time step of " + number(scene.time.step) + " s is not between 0 and the critical step of " +
                       number(largest_step) + " s of its contacts (" + scene.name +
                       ": time.step_s). Take a smaller step or a softer contact, or set time.force.");
    step = scene.time.step;
    start_momentum = momentum_of(particles);
    buffers.resize(team.threads());
    pools = std::vector<TaskPool>(team.threads() + 1);
    layers = layers_named(options.layers == "default" ? scheme.layers : options.layers);
    set_to_zero(loads, n);
    scene.bodies = std::vector<Body>(); // in `particles` from now on
  }

  static Particles particles_of(const Scene& scene) {
    Particles particles;
    particles.reserve(static_cast<int>(scene.bodies.size()));
    for (const Body& body : scene.bodies) particles.add(body);
    return particles;
  }

  static int threads_of(const Options& options) {
    if (options.threads < 1)
      throw InputError("threads must be at least 1 (is " + std::to_string(options.threads) + ").");
    if (options.scheme == "serial" && options.threads > 1)
      throw InputError("scheme 'serial' runs on one thread (threads is " + std::to_string(options.threads) +
                       "). Ask for 1 thread or another scheme.");
    return options.threads;
  }

  void update_grid(StepStats& stats);
  void detect(StepStats& stats);
  void merge(StepStats& stats);
  void forces(StepStats& stats);
  void add_to_both(const Reaction& reaction);
  void add_reactions_to(int body);
  void settle_budget(const KickSums& kick);
  /// The part of a step (s) in which a contact may begin.
  double blind_step() const { return control.guards_gaps ? std::min(step.now, scene.time.step) : step.now; }
  void integrate();
};

void Simulation::State::update_grid(StepStats& stats) {
  source->update(particles, team);
  source->count(stats);
}

void Simulation::State::detect(StepStats& stats) {
  for (WorkerBuffer& buffer : buffers) buffer.clear();
  if (kept_pairs) kept_pairs->begin_step();
  scheme.detect({*source, particles, narrow, layers, buffers, pools}, team);
  for (const WorkerBuffer& buffer : buffers) {
    stats.candidate_pairs += buffer.candidate_pairs;
    stats.body_pairs += buffer.body_pairs;
    stats.searched_pairs += buffer.searched_pairs;
    stats.crossings += buffer.crossings;
    stats.triangle_pairs += buffer.kernel.triangle_pairs;
    stats.newton_steps += buffer.kernel.newton_steps;
    stats.fall_backs += buffer.kernel.fall_backs;
  }
}

void Simulation::State::merge(StepStats& stats) {
  contacts.gather(buffers, particles, team);
  stats.contacts += static_cast<std::int64_t>(contacts.contacts().size());
}

void Simulation::State::forces(StepStats& stats) {
  motion.resize(particles.size());
  std::vector<Eigen::Vector3d>& spin = motion.angular_velocity; // until the loads are known
  pushed = has_next_loads;
  if (has_next_loads) {
    std::swap(loads, next_loads);
    outside = loads;
  }
  Loads& old = has_next_loads ? next_loads : loads; // what was added from outside stays
  has_next_loads = false;
  team.parallel_for(particles.size(), cheap_grain, [&](int begin, int end, int) {
    for (int body = begin; body < end; ++body) {
      spin[body] = particles.angular_velocity(body);
      old.force[body] = old.torque[body] = Eigen::Vector3d::Zero();
    }
  });
  const bool alone = team.threads() == 1; // then what a pair does to both of its bodies is added at once
  if (!alone) contacts.list_others(particles, team);
  team.parallel_for(contacts.pairs(), pair_grain, [&](int begin, int end, int) {
    contacts.lay_out(begin, end, buffers, particles);
    contact_forces(particles, spin, law, scene.contact, step.now, contacts.contacts_of(begin, end),
                   contacts.springs_of(begin, end));
    for (int pair = begin; pair < end; ++pair) {
      const Reaction reaction = reaction_of(particles, contacts.contacts_of(pair, pair + 1));
      if (alone)
        add_to_both(reaction);
      else
        contacts.set_reaction(pair, reaction);
    }
  });
  KickSums kick = block_sum(team, particles.size(), sums, [&](int begin, int end, KickSums& sum) {
    for (int body = begin; body < end; ++body) {
      if (!alone) add_reactions_to(body);
      sum.fast_bodies += watch.flies_blind(particles, body, blind_step());
    }
    motion.update(particles, loads, scene.gravity, step.kick(), begin, end);
    add_weight(particles, scene.gravity, step.kick(), begin, end, sum.budget);
    if (pushed) add_outside(particles, outside, motion, step.kick(), begin, end, sum.budget);
  });
  const std::span<const Contact> all = contacts.contacts();
  kick += block_sum(team, static_cast<int>(all.size()), sums, [&](int begin, int end, KickSums& sum) {
    add_contacts(all.subspan(begin, end - begin), particles, motion, step.kick(), sum);
  });
  settle_budget(kick);
  watch.look(particles, scene.contact, contacts, kick, time, step.now, blind_step(), team, stats);
}

void Simulation::State::add_to_both(const Reaction& reaction) {
  if (!particles.fixed(reaction.a)) add_reaction(particles, reaction, true, loads);
  if (!particles.fixed(reaction.b)) add_reaction(particles, reaction, false, loads);
}

void Simulation::State::add_reactions_to(int body) {
  if (!particles.fixed(body))
    contacts.for_reactions(body, [&](const Reaction& r) { add_reaction(particles, r, r.a == body, loads); });
}

/// Books what the kick to come dissipates, and its impulse.
void Simulation::State::settle_budget(const KickSums& kick) {
  budget += kick.budget;
  budget.friction += tangential_energy - kick.held - kick.released; // springs whose contacts ended
  tangential_energy = kick.held;
  pending = kick.pending;
}

void Simulation::State::integrate() {
  team.parallel_for(particles.size(), turn_grain, [&](int begin, int end, int) {
    trigrain::integrate(particles, loads, scene.gravity, step, begin, end);
  });
  time += step.now;
}

Simulation::Simulation(Scene scene, Options options) : Simulation(std::move(scene), std::move(options), nullptr) {}
Simulation::Simulation(Scene scene, Options options, std::unique_ptr<PairSource> source)
    : state_(std::make_unique<State>(std::move(scene), std::move(options), std::move(source))) {}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

StepStats Simulation::step() {
  State& s = *state_;
  StepStats stats{.steps = 1};
  {
    const PhaseScope scope(stats, Phase::grid, s.team, s.options.observer);
    s.update_grid(stats);
    s.step.last = s.step.now;
    s.step.now = s.control.next({s.particles, *s.source, s.loads, s.scene.gravity, s.scene.time.step, s.step.last});
  }
  {
    const PhaseScope scope(stats, Phase::detect, s.team, s.options.observer);
    s.detect(stats);
  }
  {
    const PhaseScope scope(stats, Phase::merge, s.team, s.options.observer);
    s.merge(stats);
  }
  {
    const PhaseScope scope(stats, Phase::forces, s.team, s.options.observer);
    s.forces(stats);
  }
  {
    const PhaseScope scope(stats, Phase::integrate, s.team, s.options.observer);
    s.integrate();
  }
  return stats;
}

StepStats Simulation::run(std::int64_t steps) {
  StepStats sum;
  for (std::int64_t i = 0; i < steps; ++i) sum += step();
  return sum;
}

const Scene& Simulation::scene() const { return state_->scene; }
const Options& Simulation::options() const { return state_->options; }
const PairSource& Simulation::pair_source() const { return *state_->source; }
const Particles& Simulation::particles() const { return state_->particles; }
const std::vector<Contact>& Simulation::contacts() const { return state_->contacts.contacts(); }
double Simulation::time() const { return state_->time; }
double Simulation::step_size() const { return state_->step.now; }

Energy Simulation::energy() const {
  const State& s = *state_;
  const Particles p = s.time > 0 ? centred(s.particles, s.loads, s.scene.gravity, s.step.now) : s.particles;
  return {.kinetic = kinetic_energy(p),
          .potential = potential_energy(p, s.scene.gravity),
          .elastic = elastic_energy(s.contacts.contacts()),
          .damping = s.budget.damping - s.pending,
          .friction = s.budget.friction,
          .outside = s.budget.outside -
                     (s.pushed ? work_of(s.outside, s.motion, s.step.kick(), 0, s.particles.size()) / 2 : 0)};
}

Momentum Simulation::momentum() const { return momentum_of(state_->particles); }

Momentum Simulation::momentum_error() const {
  const State& s = *state_;
  const Momentum now = momentum();
  return {now.linear - s.start_momentum.linear - s.budget.impulse,
          now.angular - s.start_momentum.angular - s.budget.angular_impulse};
}

const FastContact& Simulation::first_fast_contact() const { return state_->watch.first_fast_contact(); }
const FastContact& Simulation::first_fast_body() const { return state_->watch.first_fast_body(); }
double Simulation::contact_step_limit() const {
  State& s = *state_;
  return ContactStepLimit().of(s.particles, s.scene.contact, s.contacts, s.team);
}

std::uint64_t Simulation::state_hash() const { return particles().hash(); }

void Simulation::add_load(int body, const Eigen::Vector3d& force, const Eigen::Vector3d& torque) {
  Loads& loads = state_->next_loads;
  if (loads.force.empty()) set_to_zero(loads, particles().size());
  loads.force.at(body) += force;
  loads.torque.at(body) += torque;
  state_->has_next_loads = true;
}

void Simulation::put(int body, const Eigen::Vector3d& position, const Eigen::Vector3d& velocity) {
  State& s = *state_;
  const double energy_before = energy().total();
  const Momentum before = momentum();
  s.particles.position[body] = position;
  s.particles.velocity[body] = velocity;
  s.particles.angular_momentum[body] = Eigen::Vector3d::Zero();
  const Momentum after = momentum();
  s.budget.outside += energy().total() - energy_before;
  s.budget.impulse += after.linear - before.linear;
  s.budget.angular_impulse += after.angular - before.angular;
}

} // namespace trigrain
