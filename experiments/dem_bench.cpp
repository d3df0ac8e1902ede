// One point of an experiment: reads the command line, checks, times, and writes the record.
#include "experiments/atomic_file.hpp"
#include "experiments/command_line.hpp"
#include "experiments/hand_over.hpp"
#include "experiments/record.hpp"
#include "experiments/run_point.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace trigrain {
namespace {

/// DESIGN: exit codes of all programs.
enum ExitCode { fine = 0, check_failed = 1, bad_input = 3, bad_environment = 4 };

/// Everything that would make the run's results unwritable, before it is run.
void require_outputs(const BenchRequest& request) {
  for (const auto& file : {request.record, request.final_state, request.hand_over, request.trace})
    if (!file.empty()) require_writable(file);
  if (!request.vtk.empty() && !std::filesystem::is_directory(request.vtk))
    require_writable(request.vtk); // its parent must take a new folder
}

/// One line on the terminal, rewritten as the run goes on.
class ProgressLine {
 public:
  void operator()(const Progress& progress) {
    if (sample_ != progress.sample) {
      sample_ = progress.sample;
      begin_ = Clock::now();
    }
    const double elapsed = std::chrono::duration<double>(Clock::now() - begin_).count();
    const double left = progress.share > 0 ? elapsed * (1 / progress.share - 1) : 0;
    std::fprintf(stderr, "\rsample %d/%d  %5.1f %%  t = %.4g s  %.0f s left   ", progress.sample + 1, progress.samples,
                 100 * progress.share, progress.time, left);
    if (progress.share >= 1) std::fprintf(stderr, "\r\033[K");
  }

 private:
  using Clock = std::chrono::steady_clock;
  int sample_ = -1;
  Clock::time_point begin_;
};

/// The sample of median wall time (the lower of two).
const Sample& median_sample(const std::vector<Sample>& samples) {
  std::vector<const Sample*> order;
  for (const Sample& sample : samples) order.push_back(&sample);
  const auto middle = order.begin() + static_cast<std::ptrdiff_t>((order.size() - 1) / 2);
  std::nth_element(order.begin(), middle, order.end(),
                   [](const Sample* l, const Sample* r) { return l->used.wall < r->used.wall; });
  return **middle;
}

void print_timing(const PointResult& point) {
  const Sample& sample = median_sample(point.samples);
  const auto steps = static_cast<double>(sample.stats.steps);
  double moving = 0;
  for (const Body& body : point.scene.bodies) moving += !body.fixed;
  std::printf("%s: %zu bodies, %.0f steps, %zu sample%s (median)\n", point.scene.name.c_str(),
              point.scene.bodies.size(), steps, point.samples.size(), point.samples.size() == 1 ? "" : "s");
  std::printf("  %-10s %12s %7s\n", "phase", "s per step", "share");
  for (std::size_t i = 0; i < phase_names.size(); ++i)
    std::printf("  %-10s %12.3e %5.1f %%\n", phase_names[i].data(), sample.stats.seconds[i] / steps,
                100 * sample.stats.seconds[i] / sample.used.wall);
  std::printf("  %-10s %12.3e\n", "all", sample.used.wall / steps);
  if (moving > 0)
    std::printf("%.3g us per particle and step, %.3g contacts per particle\n", 1e6 * sample.used.wall / steps / moving,
                static_cast<double>(sample.stats.contacts) / steps / moving);
  if (moving > 0 && sample.heap_bytes)
    std::printf("%.3g bytes per particle beside the meshes\n", static_cast<double>(*sample.heap_bytes) / moving);
}

void print_summary(const BenchRequest& request, const PointResult& point) {
  for (const CheckItem& item : point.check.how)
    std::printf("check %-10s %s: %s\n", item.what.c_str(), item.passed ? "passed" : "FAILED", item.detail.c_str());
  if (!point.samples.empty()) print_timing(point);
  for (const std::string& warning : point.warnings) std::printf("warning: %s\n", warning.c_str());
  if (!request.record.empty()) std::printf("wrote %s\n", request.record.c_str());
  if (point.samples.empty()) return;
  if (!request.final_state.empty()) std::printf("wrote %s\n", request.final_state.c_str());
  if (!request.hand_over.empty()) std::printf("wrote %s\n", request.hand_over.c_str());
  if (!request.trace.empty()) std::printf("wrote %s\n", request.trace.c_str());
  if (!request.vtk.empty()) std::printf("wrote %s\n", (request.vtk / "frames.pvd").c_str());
}

int run(int argc, char** argv) {
  const auto request = parse_command_line(argc, argv, std::cout);
  if (!request) return fine;
  require_outputs(*request);
  std::function<void(const Progress&)> report;
  if (isatty(STDERR_FILENO)) report = ProgressLine();
  const PointResult point = run_point(*request, report);
  if (!request->record.empty()) write_atomically(request->record, make_record(point, request->point_id).dump(1) + "\n");
  if (!request->final_state.empty() && !point.samples.empty())
    write_atomically(request->final_state, to_json(point.final_state).dump() + "\n");
  if (!request->hand_over.empty() && !point.samples.empty())
    write_atomically(request->hand_over, hand_over(point.scene, point.final_state).dump() + "\n");
  if (!request->trace.empty() && !point.samples.empty()) write_atomically(request->trace, point.trace.dump() + "\n");
  print_summary(*request, point);
  if (point.check.passed()) return fine;
  std::fflush(stdout);
  std::cerr << "dem_bench: the check failed; these times must not be used.\n";
  return check_failed;
}

} // namespace
} // namespace trigrain

int main(int argc, char** argv) {
  try {
    return trigrain::run(argc, argv);
  } catch (const trigrain::InputError& error) {
    std::cerr << "dem_bench: " << error.what() << '\n';
    return trigrain::bad_input;
  } catch (const std::bad_alloc&) {
    std::cerr << "dem_bench: out of memory (std::bad_alloc). Take fewer particles, or raise the limit of memory.\n";
    return trigrain::bad_environment;
  } catch (const std::exception& error) {
    std::cerr << "dem_bench: " << error.what() << '\n';
    return trigrain::bad_environment;
  }
}
