#include "experiments/run_point.hpp"
#include "experiments/counters.hpp"
#include "experiments/likwid_marker.hpp"
#include "experiments/machine.hpp"
#include "experiments/memory.hpp"
#include "experiments/trace.hpp"
#include "experiments/vtk.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <set>
#include <sstream>

namespace trigrain {
namespace {

using Json = nlohmann::ordered_json;

/// Length of one sample: whichever comes first of so many steps and so much simulated time.
struct Length {
  std::int64_t steps = std::numeric_limits<std::int64_t>::max();
  double duration = std::numeric_limits<double>::infinity(); ///< s, after the warm-up

  double share(std::int64_t steps_done, double time_done) const {
    return std::max(static_cast<double>(steps_done) / static_cast<double>(steps), time_done / duration);
  }
  /// Times are sums of steps: the tolerance keeps their rounding from adding a step.
  bool reached(std::int64_t steps_done, double time_done) const {
    return steps_done >= steps || time_done >= duration * (1 - 1e-9);
  }
};

Length length_of(const BenchRequest& request, const Scene& scene) {
  if (request.steps) return {.steps = *request.steps};
  return {.duration = request.end ? *request.end : scene.time.end};
}

/// What one thread takes (s) to ask for the pairs of the last step once more, with their pre-check by spheres, and to
/// do nothing with them. The step mixes that with the comparisons, where no clock can tell them apart. The simulation
/// should not go on: a grid takes note of who asks.
double search_seconds(const Simulation& simulation, Sieve sieve) {
  std::vector<BodyPair> pairs;
  const auto start = std::chrono::steady_clock::now();
  for (int entry = 0; entry < simulation.pair_source().entries(); ++entry) {
    pairs.clear();
    simulation.pair_source().pairs_of(entry, simulation.particles(), sieve, pairs);
  }
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Everything that takes part in one sample.
class Sampler {
 public:
  Sampler(const PointResult& point, const BenchRequest& request, HardwareCounters& counters, LikwidMarker& marker,
          Trace& trace, const std::function<void(const Progress&)>& report)
      : point_(point), request_(request), length_(length_of(request, point.scene)), counters_(counters),
        marker_(marker), trace_(trace), report_(report) {}

  /// A fresh simulation, warmed up and run; `frames` may be null.
  Sample run(int number, FrameWriter* frames, FinalState& last) {
    Options options = request_.options;
    options.observer = traced() ? trace_.observer() : marker_.observer();
    const std::optional<std::int64_t> heap_before = heap_in_use(); // the scene's meshes are among it
    Simulation simulation(point_.scene, options);
    simulation.run(request_.warmup);
    const double start = simulation.time();
    Sample sample;
    const Sieve sieve = row_named(prechecks(), "pre-check", options.precheck).spheres ? Sieve::spheres : Sieve::none;
    if (request_.history > 0) sample.history.emplace(request_.history);
    sample.initial = simulation.energy();
    double next_frame = start;
    while (!length_.reached(sample.stats.steps, simulation.time() - start)) {
      if (frames && simulation.time() >= next_frame) {
        frames->write(simulation.particles(), simulation.pair_source().tree(), point_.start_time + simulation.time());
        next_frame = request_.vtk_every > 0 ? next_frame + request_.vtk_every : std::numeric_limits<double>::infinity();
      }
      run_slice(simulation, start, next_frame, sample);
      if (report_)
        report_({number, request_.repeats, length_.share(sample.stats.steps, simulation.time() - start),
                 simulation.time()});
    }
    if (frames)
      frames->write(simulation.particles(), simulation.pair_source().tree(), point_.start_time + simulation.time());
    if (heap_before && !sample.history && !frames && !traced()) sample.heap_bytes = *heap_in_use() - *heap_before;
    sample.search = search_seconds(simulation, sieve);
    sample.final = simulation.energy();
    sample.momentum_error = simulation.momentum_error();
    sample.first_fast = simulation.first_fast_contact();
    sample.first_fast_body = simulation.first_fast_body();
    sample.state_hash = simulation.state_hash();
    sample.state = check_state(simulation.particles());
    sample.bodies_outside = bodies_outside(simulation.particles(), point_.scene.domain);
    sample.load_average = load_average();
    last = final_state(simulation, point_.start_time);
    return sample;
  }

 private:
  bool traced() const { return !request_.trace.empty(); }

  /// Steps on the clock until the sample, a frame, or, where somebody watches, .2 s are over. A function of its own, so
  /// that callgrind can count what happens inside.
  [[gnu::noinline]] void run_slice(Simulation& simulation, double start, double next_frame, Sample& sample) {
    const auto watched_until = std::chrono::steady_clock::now() + std::chrono::milliseconds(200);
    const UsageMeter meter;
    counters_.start();
    marker_.start();
    if (traced()) trace_.start();
    do {
      const StepStats step = simulation.step();
      sample.stats += step;
      if (sample.history) sample.history->add(step, simulation);
      if (traced()) trace_.mark_step();
    } while (!length_.reached(sample.stats.steps, simulation.time() - start) && simulation.time() < next_frame &&
             !(report_ && std::chrono::steady_clock::now() > watched_until));
    trace_.stop();
    marker_.stop();
    counters_.stop();
    sample.used += meter.stop();
  }

  const PointResult& point_;
  const BenchRequest& request_;
  const Length length_;
  HardwareCounters& counters_;
  LikwidMarker& marker_;
  Trace& trace_;
  const std::function<void(const Progress&)>& report_;
};

CheckItem check_placement(const Json& placement) {
  const int asked = placement["asked_threads"], observed = placement["observed_threads"];
  return {"placement", asked == observed,
          std::to_string(observed) + " threads observed, " + std::to_string(asked) + " asked for"};
}

CheckItem check_samples(const std::vector<Sample>& samples) {
  std::set<std::uint64_t> hashes;
  bool finite = true;
  for (const Sample& sample : samples) {
    hashes.insert(sample.state_hash);
    finite = finite && sample.state.passed;
  }
  return {"samples", hashes.size() == 1 && finite,
          std::to_string(samples.size()) + " samples, distinct last states: " + std::to_string(hashes.size()) +
              "; the last one: " + samples.back().state.detail};
}

/// Surfaces that crossed have no normal and got no force: what follows is not the scene's motion.
CheckItem check_crossings(const Sample& sample) {
  const std::int64_t crossings = sample.stats.crossings;
  if (crossings == 0) return {"crossings", true, "no surfaces crossed"};
  return {"crossings", false,
          "surfaces crossed (" + std::to_string(crossings) +
              " pairs, summed over the steps): bodies overlap from the start, or are faster than their contacts can "
              "stop. Keep (halo_m of both) sqrt(stiffness_N_m / mass) above their speed"};
}

/// Springs between several bodies are stiffer than any one contact, which the engine looks at before it starts.
CheckItem check_step(const Sample& sample, bool forced) {
  const std::int64_t unstable = sample.stats.unstable_steps;
  if (unstable == 0) return {"step", true, "no step was found longer than its contacts allow"};
  return {"step", forced,
          std::to_string(unstable) +
              " of the steps looked at (one in 256) were longer than their contacts together "
              "allow" +
              (forced ? "; time.force was set" : ". Take a smaller step")};
}

std::string warning_of(const FastContact& fast, std::int64_t count, double start_time) {
  std::ostringstream text;
  text.precision(3);
  text << "bodies " << fast.a << " and " << fast.b << " met at t = " << start_time + fast.time << " s with "
       << fast.speed << " m/s, more than the " << fast.limit << " m/s that undamped springs within their halos stop; "
       << count << " such contacts in all steps";
  return text.str();
}

std::string warning_of_body(const FastContact& fast, std::int64_t count, double start_time) {
  std::ostringstream text;
  text.precision(3);
  text << "body " << fast.a << " moved with " << fast.speed << " m/s at t = " << start_time + fast.time
       << " s, more than the " << fast.limit << " m/s at which no contact can be missed between two steps; " << count
       << " times in all steps. Take a smaller step or a larger halo";
  return text.str();
}

/// The scene as it is when the clock starts.
Scene warmed_up(const Scene& scene, const BenchRequest& request) {
  if (request.warmup == 0) return scene;
  Simulation simulation(scene, request.options);
  simulation.run(request.warmup);
  return snapshot(simulation);
}

} // namespace

PointResult run_point(const BenchRequest& request, const std::function<void(const Progress&)>& report) {
  HardwareCounters counters; // before the first thread, so that it counts all of them
  LikwidMarker marker;
  Trace trace;
  if (marker.active() && !request.trace.empty())
    throw InputError("LIKWID and --trace both watch the pieces of work. Use one of them.");
  PointResult point;
  point.started_utc = utc_now();
  point.params = params_of(request);
  StartingPoint start = starting_point(request);
  point.scene = std::move(start.scene);
  point.start_time = start.time;
  Simulation(point.scene, request.options); // refuses bad names and values before anything is run or written

  const Scheme& scheme = row_named(schemes(), "scheme", request.options.scheme);
  const bool default_runtime = request.options.runtime == Options{}.runtime;
  const std::string runtime = default_runtime ? std::string(scheme.runtime) : request.options.runtime;
  point.placement = observe_placement(runtime, request.options.threads);
  if (point.placement["oversubscribed"]) point.warnings.push_back("more threads than cores: not a measurement");

  const std::int64_t steps = request.steps.value_or(20);
  point.check = verify(warmed_up(point.scene, request), request.options,
                       request.check_steps.value_or(std::min<std::int64_t>(steps, 20)));
  point.check.how.push_back(check_placement(point.placement));
  if (point.check.passed()) {
    std::optional<FrameWriter> frames;
    if (!request.vtk.empty()) frames.emplace(request.vtk);
    if (frames) point.warnings.push_back("frames were written during the first sample: not a clean timing");
    Sampler sampler(point, request, counters, marker, trace, report);
    for (int number = 0; number < request.repeats; ++number)
      point.samples.push_back(sampler.run(number, number == 0 && frames ? &*frames : nullptr, point.final_state));
    if (frames && frames->grids_left_out() > 0)
      point.warnings.push_back("the grid of " + std::to_string(frames->grids_left_out()) + " frames has more than " +
                               std::to_string(most_cells_written) + " cells and was not written");
    point.check.how.push_back(check_samples(point.samples));
    point.check.how.push_back(check_crossings(point.samples.back()));
    if (marker.active()) {
      point.warnings.push_back("LIKWID counted: not a clean timing");
      point.check.how.push_back(
          {"regions", marker.trouble().empty(),
           "LIKWID, per phase and thread: " + (marker.trouble().empty() ? std::string("as asked") : marker.trouble())});
    }
    if (!request.trace.empty()) {
      std::int64_t moving = 0;
      for (const Body& body : point.scene.bodies) moving += !body.fixed;
      point.trace = trace.chrome_json(
          {{"params", point.params}, {"runtime", runtime}, {"moving_bodies", moving}, {"steps", trace.steps()}});
      point.warnings.push_back("work was traced: up to 2 % slower");
    }
    const Sample& last = point.samples.back();
    point.check.how.push_back(check_step(last, point.scene.time.force));
    if (last.stats.fast_bodies > 0)
      point.warnings.push_back(warning_of_body(last.first_fast_body, last.stats.fast_bodies, point.start_time));
    if (last.stats.fast_contacts > 0)
      point.warnings.push_back(warning_of(last.first_fast, last.stats.fast_contacts, point.start_time));
    if (const int outside = point.samples.back().bodies_outside)
      point.warnings.push_back(std::to_string(outside) + " bodies ended outside of the domain");
  }
  point.warnings.insert(point.warnings.end(), point.check.warnings.begin(), point.check.warnings.end());
  point.counters = counters.report(static_cast<int>(point.samples.size()));
  return point;
}

} // namespace trigrain
