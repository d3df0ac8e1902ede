// Kernels and other people's libraries on pairs of triangles or meshes. Every contestant's answers are checked before
// it is timed by Google Benchmark; what is timed goes through many different pairs.
#include "experiments/atomic_file.hpp"
#include "experiments/kernel_bench/options.hpp"
#include "experiments/kernel_bench/report.hpp"
#include "kernels/name_table.hpp"
#include <benchmark/benchmark.h>
#include <iostream>
#include <nlohmann/json.hpp>
#include <set>

namespace {

using namespace trigrain;

/// Console table, and every repetition for the record.
class Collector : public benchmark::ConsoleReporter {
 public:
  std::vector<BenchSample> samples;

  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs)
      if (run.run_type == Run::RT_Iteration && !run.error_occurred)
        samples.push_back({run.real_accumulated_time, run.cpu_accumulated_time, run.iterations});
    ConsoleReporter::ReportRuns(runs);
  }
};

void time(benchmark::State& state, const Entry& entry) {
  const Findings& findings = entry.findings();
  if (!findings.right()) return state.SkipWithError(findings.accuracy.first_fault.c_str());
  Hits hits;
  KernelCounts counts;
  const BenchPass pass = entry.pass();
  for (auto _ : state) {
    pass(hits, counts);
    benchmark::DoNotOptimize(hits.next_i());
  }
  using benchmark::Counter;
  // A rate inverted: seconds per 1e-9 pairs, that is, nanoseconds per pair.
  state.counters["ns_per_pair"] =
      Counter(1e-9 * static_cast<double>(state.iterations() * entry.pairs()), Counter::kIsRate | Counter::kInvert);
  state.counters["lanes"] = entry.contestant->lanes;
  // What the record has beside that is too much for a table.
  const std::set<std::string> hidden{"error_p50_S",   "error_p90_S",        "flagged_share",       "believed_share",
                                     "bandwidth_B_s", "triangles_per_mesh", "believed_wrong_share"};
  for (const auto& [name, value] : findings.numbers(entry)) {
    if (!hidden.contains(name)) state.counters[name] = value;
    if (name == "flops_per_pair")
      state.counters["flop_s"] =
          Counter(value * static_cast<double>(entry.pairs()), Counter::kIsIterationInvariantRate);
  }
}

int run(const BenchOptions& options, char* program) {
  const std::vector<Contestant> list = contestants();
  const std::vector<Entry> entries = chosen_entries(options, list);
  std::vector<char*> arguments{program};
  for (const std::string& argument : options.benchmark_arguments)
    arguments.push_back(const_cast<char*>(argument.c_str()));
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 3;
  for (const Entry& entry : entries)
    benchmark::RegisterBenchmark(entry.name().c_str(), [&entry](benchmark::State& state) { time(state, entry); })
        ->Repetitions(options.repeats)
        ->MinTime(options.seconds);
  Collector collector;
  if (options.record.empty())
    benchmark::RunSpecifiedBenchmarks();
  else
    benchmark::RunSpecifiedBenchmarks(&collector);
  benchmark::Shutdown();
  bool right = true;
  for (const Entry& entry : entries) right = entry.findings().right() && right;
  if (!options.record.empty())
    write_atomically(options.record, bench_record(options, entries.at(0), collector.samples).dump(1) + "\n");
  return right ? 0 : 1;
}

} // namespace

int main(int argc, char** argv) {
  try {
    const auto options = parse_bench_options(argc, argv, std::cout);
    return options ? run(*options, argv[0]) : 0;
  } catch (const InputError& error) {
    std::cerr << "kernel_bench: " << error.what() << '\n';
    return 3;
  } catch (const std::exception& error) {
    std::cerr << "kernel_bench: " << error.what() << '\n';
    return 4;
  }
}
