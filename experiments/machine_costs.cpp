// Measures what this machine charges for sharing work out, and its memory bandwidth: what a projection needs to know.
#include "dem/runtime.hpp"
#include "experiments/atomic_file.hpp"
#include "experiments/machine.hpp"
#include "experiments/record.hpp"
#include "kernels/name_table.hpp"
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <vector>

namespace {

using namespace trigrain;
using Json = nlohmann::ordered_json;

constexpr int repeats = 15;

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Median seconds of several runs; the first is not counted.
double median_time(const std::function<void()>& work) {
  std::vector<double> times;
  for (int i = 0; i <= repeats; ++i) {
    const double begin = now();
    work();
    if (i > 0) times.push_back(now() - begin);
  }
  std::nth_element(times.begin(), times.begin() + repeats / 2, times.end());
  return times[repeats / 2];
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
  return 1e6 / loops * median_time([&] {
           for (int i = 0; i < loops; ++i) team.parallel_for(team.threads(), 1, [](int, int, int) { spin(1); });
         });
}

/// Microseconds of a thread that a task costs beside its work: of one that its own thread runs on a team of one, and of
/// one that may be stolen on a larger team.
double task_cost(Team& team) {
  constexpr int tasks = 5000, rounds = 1000; // some microseconds each
  std::vector<Task> all(tasks);
  const double work = median_time([&] {
    for (int i = 0; i < tasks; ++i) spin(rounds);
  });
  const double taken = median_time([&] {
    team.produce(
        [&](Spawn spawn) {
          for (const Task& task : all) spawn(task);
        },
        [&](const Task&, int, Spawn) { spin(rounds); });
  });
  return 1e6 * (taken * team.threads() - work) / tasks;
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
  result["machine"] = describe_machine();
  result["build"] = describe_build();
  return result;
}

void print(const Json& costs) {
  for (const auto& [threads, rate] : costs["triad_GB_s"].items())
    std::printf("STREAM triad, %s threads: %.1f GB/s\n", threads.c_str(), rate.get<double>());
  const auto text = [](const Json& x) {
    return x.is_null() ? std::string("-") : CLI::detail::to_string(x.get<double>());
  };
  for (const auto& [name, c] : costs["runtimes"].items())
    std::printf("%s: us per task %s on one thread, %s with %d; us per loop %s on one thread, %s with %d\n",
                name.c_str(), text(c["spawn_us"]).c_str(), text(c["stolen_us"]).c_str(), costs["threads"].get<int>(),
                text(c["loop_us"]).c_str(), text(c["barrier_us"]).c_str(), costs["threads"].get<int>());
}

} // namespace

int main(int argc, char** argv) {
  std::string out;
  int threads = usable_cores();
  CLI::App app{"Measures memory bandwidth, and what tasks and shared loops cost on this machine; some seconds."};
  app.add_option("--threads", threads, "that share work")->check(CLI::Range(1, usable_cores()))->capture_default_str();
  app.add_option("--out", out, "JSON file to write; else only a summary is printed");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 3;
  }
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
