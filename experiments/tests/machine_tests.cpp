#include "experiments/counters.hpp"
#include "experiments/machine.hpp"
#include "kernels/name_table.hpp"
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <gtest/gtest.h>
#include <linux/perf_event.h>
#include <nlohmann/json.hpp>
#include <thread>

namespace trigrain {
namespace {

/// Uses so much CPU time, whatever else runs on the machine.
void burn(std::chrono::nanoseconds duration) {
  const auto used = [] {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return std::chrono::seconds(t.tv_sec) + std::chrono::nanoseconds(t.tv_nsec);
  };
  const auto until = used() + duration;
  while (used() < until) {
  }
}

TEST(Machine, topology_is_what_hwloc_says) {
  setenv("HWLOC_SYNTHETIC", "package:2 l3:1(size=33554432) l2:8(size=1048576) l1d:1(size=32768) core:1 pu:2", 1);
  const auto machine = describe_machine();
  unsetenv("HWLOC_SYNTHETIC");
  EXPECT_EQ(machine["sockets"], 2);
  EXPECT_EQ(machine["cores"], 16);
  EXPECT_EQ(machine["logical_cores"], 32);
  EXPECT_EQ(machine["core_cpus"].size(), 16u);
  EXPECT_EQ(machine["core_cpus"][15], 30);
  EXPECT_EQ(machine["caches_bytes"]["l1d"], 32768);
  EXPECT_EQ(machine["caches_bytes"]["l2"], 1048576);
  EXPECT_EQ(machine["caches_bytes"]["l3"], 33554432);
}

TEST(Machine, a_cache_that_is_not_there_is_null) {
  setenv("HWLOC_SYNTHETIC", "package:1 core:4 pu:1", 1);
  const auto machine = describe_machine();
  unsetenv("HWLOC_SYNTHETIC");
  EXPECT_TRUE(machine["caches_bytes"]["l3"].is_null());
}

TEST(Machine, placement_sees_every_thread_of_a_team) {
  for (const char* runtime : {"openmp", "tbb"})
    for (const int threads : {1, 2, 3}) {
      const auto placement = observe_placement(runtime, threads);
      EXPECT_EQ(placement["asked_threads"], threads) << runtime;
      EXPECT_EQ(placement["observed_threads"], threads) << runtime;
      EXPECT_FALSE(placement["cpus"].empty()) << runtime;
      EXPECT_EQ(placement["oversubscribed"], threads > usable_cores()) << runtime;
    }
}

TEST(Machine, placement_says_when_threads_are_missing) {
  EXPECT_EQ(observe_placement("serial", 2)["observed_threads"], 1);
}

TEST(Machine, an_unknown_runtime_lists_the_known_ones) {
  try {
    observe_placement("pthreads", 1);
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("openmp"), std::string::npos) << error.what();
  }
}

TEST(Machine, usage_counts_cpu_of_all_threads_and_wall_of_sleep) {
  const UsageMeter meter;
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  std::thread(burn, std::chrono::milliseconds(50)).join();
  const Usage used = meter.stop();
  EXPECT_GE(used.wall, .1);
  EXPECT_GT(used.cpu, .045);
  EXPECT_LT(used.cpu, used.wall);
  EXPECT_GE(used.voluntary_switches, 1);
}

TEST(Machine, unknown_steal_stays_unknown) {
  Usage sum{.steal = 1.};
  sum += Usage{.steal = 2.};
  EXPECT_EQ(sum.steal, 3.);
  sum += Usage{.steal = std::nullopt};
  EXPECT_FALSE(sum.steal);
}

TEST(Counters, a_software_event_counts_threads_started_later) {
  const PerfCounter clock(PERF_TYPE_SOFTWARE, PERF_COUNT_SW_TASK_CLOCK); // ns
  if (!clock.available()) GTEST_SKIP() << clock.reason();
  const auto begin = clock.read();
  std::thread(burn, std::chrono::milliseconds(50)).join();
  const auto end = clock.read();
  ASSERT_TRUE(begin && end);
  EXPECT_GT(*end - *begin, 45e6);
}

TEST(Counters, an_event_that_is_not_there_gives_a_reason_and_no_number) {
  const PerfCounter none(0x7fffffff, 0);
  EXPECT_FALSE(none.available());
  EXPECT_FALSE(none.reason().empty());
  EXPECT_FALSE(none.read());
}

TEST(Counters, every_metric_has_a_value_or_a_reason) {
  HardwareCounters counters;
  counters.start();
  burn(std::chrono::milliseconds(20));
  counters.stop();
  const auto report = counters.report(1);
  for (const char* name : {"instructions", "cycles", "flops_dp", "dram_bytes"}) {
    ASSERT_TRUE(report.contains(name)) << name;
    const auto& metric = report[name];
    if (metric["status"] == "measured") {
      EXPECT_GT(metric["value"].get<double>(), 0) << name;
    } else {
      EXPECT_EQ(metric["status"], "unavailable");
      EXPECT_TRUE(metric["value"].is_null()) << name;
      EXPECT_FALSE(metric["reason"].get<std::string>().empty()) << name;
    }
  }
}

} // namespace
} // namespace trigrain
