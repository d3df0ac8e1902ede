#include "experiments/counters.hpp"
#include <cerrno>
#include <cstring>
#include <linux/perf_event.h>
#include <nlohmann/json.hpp>
#include <sys/syscall.h>
#include <unistd.h>
#include <utility>

namespace trigrain {

using Json = nlohmann::ordered_json;

PerfCounter::PerfCounter(std::uint32_t type, std::uint64_t config) {
  perf_event_attr event{};
  event.size = sizeof event;
  event.type = type;
  event.config = config;
  event.inherit = 1;
  event.exclude_kernel = 1; // all that perf_event_paranoid = 2 allows
  event.exclude_hv = 1;
  event.read_format = PERF_FORMAT_TOTAL_TIME_ENABLED | PERF_FORMAT_TOTAL_TIME_RUNNING;
  descriptor_ = static_cast<int>(::syscall(SYS_perf_event_open, &event, 0, -1, -1, PERF_FLAG_FD_CLOEXEC));
  if (descriptor_ < 0) reason_ = std::string("perf_event_open: ") + std::strerror(errno);
}

PerfCounter::~PerfCounter() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

PerfCounter::PerfCounter(PerfCounter&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), reason_(std::move(other.reason_)) {}

std::optional<double> PerfCounter::read() const {
  std::uint64_t answer[3]{}; // count, ns enabled, ns running
  if (descriptor_ < 0 || ::read(descriptor_, answer, sizeof answer) != sizeof answer || answer[2] == 0)
    return std::nullopt;
  return static_cast<double>(answer[0]) * (static_cast<double>(answer[1]) / static_cast<double>(answer[2]));
}

HardwareCounters::HardwareCounters()
    : metrics_{{"instructions", {PERF_TYPE_HARDWARE, PERF_COUNT_HW_INSTRUCTIONS}, {}},
               {"cycles", {PERF_TYPE_HARDWARE, PERF_COUNT_HW_CPU_CYCLES}, {}}} {}

void HardwareCounters::start() {
  for (Metric& metric : metrics_) metric.begin = metric.counter.read();
}

void HardwareCounters::stop() {
  for (Metric& metric : metrics_)
    if (const auto end = metric.counter.read(); end && metric.begin) metric.sum += *end - *metric.begin;
}

Json HardwareCounters::report(int samples) const {
  const auto unavailable = [](const std::string& reason) -> Json {
    return {{"value", nullptr}, {"source", nullptr}, {"status", "unavailable"}, {"reason", reason}};
  };
  Json report;
  for (const Metric& metric : metrics_) {
    if (!metric.counter.available())
      report[metric.name] = unavailable(metric.counter.reason());
    else if (samples == 0)
      report[metric.name] = unavailable("nothing was timed");
    else if (metric.sum <= 0) // virtual machines that accept the event and never count
      report[metric.name] = unavailable("perf_event counted nothing");
    else
      report[metric.name] = {
          {"value", metric.sum / samples}, {"source", "perf_event"}, {"status", "measured"}, {"reason", nullptr}};
  }
  // These need events that differ per architecture: likwid-perfctr knows them.
  for (const char* name : {"flops_dp", "dram_bytes"}) report[name] = unavailable("no portable perf_event; use likwid");
  return report;
}

} // namespace trigrain
