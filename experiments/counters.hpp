#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace trigrain {

/// One event of the kernel's perf interface, counted for this thread and every thread it starts later, in user mode.
/// Construct before the first thread starts.
class PerfCounter {
 public:
  PerfCounter(std::uint32_t type, std::uint64_t config);
  ~PerfCounter();
  PerfCounter(PerfCounter&& other) noexcept;
  PerfCounter(const PerfCounter&) = delete;
  PerfCounter& operator=(const PerfCounter&) = delete;
  PerfCounter& operator=(PerfCounter&&) = delete;

  bool available() const { return descriptor_ >= 0; }
  const std::string& reason() const { return reason_; } ///< why it is not available
  /// Events so far, scaled up if the kernel shared the counter out; none if not available or never scheduled.
  std::optional<double> read() const;

 private:
  int descriptor_ = -1;
  std::string reason_;
};

/// Hardware events of the timed parts of a run. Where the machine has no counters it says so and why, and never 0.
class HardwareCounters {
 public:
  HardwareCounters();
  void start();
  void stop(); ///< adds what happened since start()
  /// Per logical metric: value per sample, source, status, and reason if there is no value.
  nlohmann::ordered_json report(int samples) const;

 private:
  struct Metric {
    const char* name;
    PerfCounter counter;
    std::optional<double> begin;
    double sum = 0;
  };
  Metric metrics_[2];
};

} // namespace trigrain
