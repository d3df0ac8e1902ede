#pragma once
#include "dem/simulation.hpp"
#include <nlohmann/json_fwd.hpp>
#include <optional>

namespace trigrain {

/// What the machine is: CPU name, sockets, cores, caches (bytes; null where hwloc finds none), memory, kernel.
nlohmann::ordered_json describe_machine();

/// Cores that this process may use: the machine's, or fewer if its affinity mask holds fewer.
int usable_cores();

/// Which threads and CPUs really ran when `runtime` was asked for `threads` workers: asked_threads, observed_threads,
/// cpus, oversubscribed. Each block of the probe waits up to two seconds for the others, so that all workers show up.
nlohmann::ordered_json observe_placement(const std::string& runtime, int threads);

/// What ran between two moments.
struct Usage {
  double wall = 0;                     ///< s, monotonic clock
  double cpu = 0;                      ///< s, all threads of the process
  std::optional<double> steal = 0;     ///< s, CPU time taken by the hypervisor, all CPUs; none if not known
  std::int64_t voluntary_switches = 0; ///< context switches of the process
  std::int64_t involuntary_switches = 0;

  Usage& operator+=(const Usage& other);
};

/// Measures usage from its construction to stop(). The clocks are read innermost, so that they do not see the rest.
class UsageMeter {
 public:
  UsageMeter();
  Usage stop() const;

 private:
  Usage begin_;
};

/// Runnable processes, average of the last minute; none if the system does not say.
std::optional<double> load_average();

/// The time, as in 2018-01-15T12:00:00Z.
std::string utc_now();

} // namespace trigrain
