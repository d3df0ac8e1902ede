// Measures what this machine charges for sharing work out, and its memory bandwidth: what a projection needs to know.
#include "dem/runtime.hpp"
#include "experiments/atomic_file.hpp"
#include "experiments/machine.hpp"
#include "experiments/option_checks.hpp"
#include "experiments/record.hpp"
#include "experiments/trace.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

namespace {

using namespace trigrain;
using Json = nlohmann::ordered_json;

constexpr int repeats = 15;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

double time_of(const std::function<void()>& work) {
  const double begin = now();
  work();
  return now() - begin;
}

/// Median of several values; the first is not counted.
double median(const std::function<double()>& value) {
  std::vector<double> values;
  for (int i = 0; i <= repeats; ++i) values.push_back(value());
  values.erase(values.begin());
  std::nth_element(values.begin(), values.begin() + repeats / 2, values.end());
  return values[repeats / 2];
}

/// STREAM triad a = b + s c (McCalpin 1995): GB/s of all threads, 24 bytes per element, best of several runs over
/// arrays that no cache holds.
double triad(Team& team, std::size_t elements) {
  static constexpr int block = 1 << 14; // elements
  const int blocks = static_cast<int>(elements / block);
  std::vector<std::unique_ptr<double[]>> arrays; // first touched by who uses them
  for (int i = 0; i < 3; ++i) arrays.emplace_back(new double[elements]);
  double *a = arrays[0].get(), *b = arrays[1].get(), *c = arrays[2].get();
  const int share = (blocks + team.threads() - 1) / team.threads();
  const auto each = [&](auto&& body) {
    team.parallel_for(blocks, share, [&](int begin, int end, int) {
      body(static_cast<std::size_t>(begin) * block, static_cast<std::size_t>(end) * block);
    });
  };
  each([&](std::size_t i, std::size_t end) {
    for (; i < end; ++i) a[i] = 0, b[i] = 1, c[i] = static_cast<double>(i);
  });
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < repeats; ++i) {
    const double begin = now(), s = 1 + i;
    each([&](std::size_t k, std::size_t end) {
      for (std::size_t j = k; j < end; ++j) a[j] = b[j] + s * c[j];
    });
    best = std::min(best, now() - begin);
  }
  if (a[blocks] != 1 + repeats * c[blocks])
    throw InputError("the triad is wrong (memory). Test this machine's memory.");
  return 24e-9 * blocks * block / best;
}

/// Work of a fixed length that no memory is needed for.
void spin(int rounds) {
  volatile double x = 1;
  for (int i = 0; i < rounds; ++i) x = x * .999;
}

/// Microseconds that a loop of as many empty blocks as threads takes: it hands out and waits for all.
double barrier(Team& team) {
  constexpr int loops = 2000;
  return 1e6 / loops * median([&] {
           return time_of([&] {
             for (int i = 0; i < loops; ++i) team.parallel_for(team.threads(), 1, [](int, int, int) { spin(1); });
           });
         });
}

/// Microseconds of a thread that a task costs beside its work: of one that its own thread runs on a team of one, and of
/// one that may be stolen on a larger team. Work and tasks are timed in turn.
double task_cost(Team& team) {
  constexpr int tasks = 5000, rounds = 1000; // some microseconds each
  std::vector<Task> all(tasks);
  return 1e6 / tasks * median([&] {
           const double work = time_of([&] {
             for (int i = 0; i < tasks; ++i) spin(rounds);
           });
           const double taken = time_of([&] {
             team.produce(
                 [&](Spawn spawn) {
                   for (const Task& task : all) spawn(task);
                 },
                 [&](const Task&, int, Spawn) { spin(rounds); });
           });
           return taken * team.threads() - work;
         });
}

/// Microseconds that recording one piece of work takes.
double trace_cost() {
  constexpr int pieces = 20000;
  Trace trace;
  trace.start();
  const double cost = 1e6 / pieces * median([&] {
                        const double work = time_of([] {
                          for (int i = 0; i < pieces; ++i) spin(1);
                        });
                        const double recorded = time_of([&] {
                          for (int i = 0; i < pieces; ++i) {
                            const ObservedPiece piece(trace.observer(), Phase::detect, Piece::loop);
                            spin(1);
                          }
                        });
                        return recorded - work;
                      });
  trace.stop();
  return cost;
}

Json costs_of(const Runtime& runtime, int threads) {
  Team one(runtime, 1), all(runtime, threads);
  Json costs = {{"spawn_us", task_cost(one)}, {"loop_us", barrier(one)}};
  costs["stolen_us"] = threads > 1 ? Json(task_cost(all)) : Json(nullptr);
  costs["barrier_us"] = threads > 1 ? Json(barrier(all)) : Json(nullptr);
  return costs;
}

Json measure(int threads) {
  Json result = {{"schema", "trigrain-machine-costs-1"}, {"started_utc", utc_now()}, {"threads", threads}};
  const Runtime& openmp = row_named(runtimes(), "runtime", "openmp");
  constexpr std::size_t elements = std::size_t{1} << 24; // 128 MB per array
  for (int t = 1; t <= threads; ++t) {
    Team team(openmp, t);
    result["triad_GB_s"][std::to_string(t)] = triad(team, elements);
  }
  for (const Runtime& runtime : runtimes())
    if (runtime.name != "serial") result["runtimes"][std::string(runtime.name)] = costs_of(runtime, threads);
  result["trace_us"] = trace_cost();
  result["machine"] = describe_machine();
  result["build"] = describe_build();
  return result;
}

double number(const Json& x) { return x.is_null() ? std::numeric_limits<double>::quiet_NaN() : x.get<double>(); }

void print(const Json& costs) {
  for (const auto& [threads, rate] : costs["triad_GB_s"].items())
    std::printf("STREAM triad, %s threads: %.1f GB/s\n", threads.c_str(), rate.get<double>());
  for (const auto& [name, c] : costs["runtimes"].items())
    std::printf("%s: a task costs %.2f us on one thread and %.2f with %d, a loop %.2f and %.2f us\n", name.c_str(),
                number(c["spawn_us"]), number(c["stolen_us"]), costs["threads"].get<int>(), number(c["loop_us"]),
                number(c["barrier_us"]));
  std::printf("a piece of work in a trace: %.3f us\n", costs["trace_us"].get<double>());
}

} // namespace

int main(int argc, char** argv) {
  std::string out;
  int threads = usable_cores();
  CLI::App app{"Measures memory bandwidth, and what tasks and shared loops cost on this machine; some seconds."};
  app.add_option("--threads", threads, "that share work")->check(CLI::Range(1, usable_cores()))->capture_default_str();
  app.add_option("--out", out, "JSON file to write; else only a summary is printed");
  app.name("machine_costs");
  if (const auto code = exit_code_of_parsing(app, argc, argv)) return *code;
  try {
    if (!out.empty()) require_writable(out);
    const Json costs = measure(threads);
    print(costs);
    if (!out.empty()) write_atomically(out, costs.dump(1) + "\n");
    return 0;
  } catch (const InputError& e) {
    std::cerr << e.what() << '\n';
    return 3;
  }
}
