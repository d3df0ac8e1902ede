#include "experiments/machine.hpp"
#include "dem/runtime.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <hwloc.h>
#include <mutex>
#include <nlohmann/json.hpp>
#include <sched.h>
#include <set>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace trigrain {
namespace {

using Json = nlohmann::ordered_json;

/// hwloc's picture of the machine; HWLOC_SYNTHETIC puts another in its place.
struct Topology {
  hwloc_topology_t handle = nullptr;
  Topology() {
    hwloc_topology_init(&handle);
    hwloc_topology_load(handle);
  }
  ~Topology() { hwloc_topology_destroy(handle); }
  Topology(const Topology&) = delete;
  Topology& operator=(const Topology&) = delete;

  int count(hwloc_obj_type_t type) const { return std::max(0, hwloc_get_nbobjs_by_type(handle, type)); }
  Json cache_bytes(hwloc_obj_type_t type) const {
    const hwloc_obj_t cache = hwloc_get_obj_by_type(handle, type, 0);
    return cache ? Json(cache->attr->cache.size) : Json(nullptr);
  }
  /// The first hardware thread of every core, socket after socket, as the operating system numbers them.
  std::vector<unsigned> core_cpus() const {
    std::vector<unsigned> cpus;
    for (int core = 0; core < count(HWLOC_OBJ_CORE); ++core)
      cpus.push_back(hwloc_bitmap_first(hwloc_get_obj_by_type(handle, HWLOC_OBJ_CORE, core)->cpuset));
    return cpus;
  }
  std::string cpu_name() const {
    for (const hwloc_obj_t object : {hwloc_get_obj_by_type(handle, HWLOC_OBJ_PACKAGE, 0), hwloc_get_root_obj(handle)})
      if (const char* name = object ? hwloc_obj_get_info_by_name(object, "CPUModel") : nullptr) return name;
    return "unknown";
  }
};

int allowed_cpus() {
  cpu_set_t set;
  return sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set)
                                                     : static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN));
}

/// s, from the first line of /proc/stat: user nice system idle iowait irq softirq steal (ticks).
std::optional<double> steal_seconds() {
  std::ifstream stat("/proc/stat");
  std::string label;
  double ticks = 0;
  stat >> label;
  for (int column = 0; column < 8; ++column) stat >> ticks;
  if (!stat || label != "cpu") return std::nullopt;
  return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

double seconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void read_switches(Usage& usage) {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  usage.voluntary_switches = used.ru_nvcsw;
  usage.involuntary_switches = used.ru_nivcsw;
}

} // namespace

Json describe_machine() {
  const Topology topology;
  utsname os{};
  uname(&os);
  return {{"cpu", topology.cpu_name()},
          {"sockets", topology.count(HWLOC_OBJ_PACKAGE)},
          {"cores", topology.count(HWLOC_OBJ_CORE)},
          {"logical_cores", topology.count(HWLOC_OBJ_PU)},
          {"core_cpus", topology.core_cpus()},
          {"caches_bytes",
           {{"l1d", topology.cache_bytes(HWLOC_OBJ_L1CACHE)},
            {"l2", topology.cache_bytes(HWLOC_OBJ_L2CACHE)},
            {"l3", topology.cache_bytes(HWLOC_OBJ_L3CACHE)}}},
          {"memory_bytes", hwloc_get_root_obj(topology.handle)->total_memory},
          {"os_kernel", std::string(os.sysname) + " " + os.release + " " + os.machine}};
}

int usable_cores() {
  const int cores = Topology().count(HWLOC_OBJ_CORE);
  return cores > 0 ? std::min(cores, allowed_cpus()) : allowed_cpus();
}

Json observe_placement(const std::string& runtime, int threads) {
  Team team(row_named(runtimes(), "runtime", runtime), threads);
  std::mutex guard;
  std::set<std::thread::id> ids;
  std::set<int> cpus;
  std::atomic<int> arrived = 0;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  const auto block = [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      {
        const std::lock_guard lock(guard);
        if (ids.insert(std::this_thread::get_id()).second) ++arrived;
        cpus.insert(sched_getcpu());
      }
      while (arrived < threads && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
      const std::lock_guard lock(guard); // where it went while it waited
      cpus.insert(sched_getcpu());
    }
  };
  team.parallel_for(threads, 1, block);
  return {{"asked_threads", threads},
          {"observed_threads", ids.size()},
          {"cpus", cpus},
          {"oversubscribed", threads > usable_cores()}};
}

Usage& Usage::operator+=(const Usage& other) {
  wall += other.wall;
  cpu += other.cpu;
  steal = steal && other.steal ? std::optional(*steal + *other.steal) : std::nullopt;
  voluntary_switches += other.voluntary_switches;
  involuntary_switches += other.involuntary_switches;
  return *this;
}

UsageMeter::UsageMeter() {
  begin_.steal = steal_seconds();
  read_switches(begin_);
  begin_.cpu = seconds(CLOCK_PROCESS_CPUTIME_ID);
  begin_.wall = seconds(CLOCK_MONOTONIC);
}

Usage UsageMeter::stop() const {
  Usage used;
  used.wall = seconds(CLOCK_MONOTONIC) - begin_.wall;
  used.cpu = seconds(CLOCK_PROCESS_CPUTIME_ID) - begin_.cpu;
  read_switches(used);
  used.voluntary_switches -= begin_.voluntary_switches;
  used.involuntary_switches -= begin_.involuntary_switches;
  const auto steal = steal_seconds();
  used.steal = steal && begin_.steal ? std::optional(*steal - *begin_.steal) : std::nullopt;
  return used;
}

std::optional<double> load_average() {
  double load = 0;
  if (getloadavg(&load, 1) != 1) return std::nullopt;
  return load;
}

std::string utc_now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

} // namespace trigrain
