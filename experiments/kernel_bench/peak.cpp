#include "experiments/kernel_bench/peak.hpp"
#include "kernels/lanes.hpp"
#include <algorithm>
#include <chrono>
#include <ctime>
#include <vector>

namespace trigrain {
namespace {

/// CPU seconds of this thread.
double cpu_now() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Best rate of several runs of `work`, which returns how much it did.
template <class Work> double best_rate(Work work) {
  double best = 0;
  for (const double end = cpu_now() + .1; cpu_now() < end;) {
    const double begin = cpu_now(), done = work();
    best = std::max(best, done / (cpu_now() - begin));
  }
  return best;
}

template <class T> double peak_flops() {
  constexpr int chains = 12, rounds = 20000; // enough to hide the latency of a multiply-add
  volatile ScalarOf<T> source = static_cast<ScalarOf<T>>(.999);
  return best_rate([&] {
    const T factor(source), addend(static_cast<ScalarOf<T>>(1e-3));
    T x[chains];
    for (int c = 0; c < chains; ++c) x[c] = T(static_cast<ScalarOf<T>>(c));
    for (int r = 0; r < rounds; ++r)
#pragma GCC unroll 12
      for (int c = 0; c < chains; ++c) x[c] = x[c] * factor + addend;
    T sum = x[0];
    for (int c = 1; c < chains; ++c) sum += x[c];
    source = source + 0 * lane_of(sum, 0);
    return 2. * chains * rounds * lanes_of<T>;
  });
}

} // namespace

double measured_peak_flops(std::string_view precision) {
  return precision == "double" ? peak_flops<Lanes>() : peak_flops<FloatLanes>();
}

double measured_bandwidth(double bytes) {
  constexpr int unroll = 8;
  const std::size_t block = unroll * lane_count, blocks = std::max<std::size_t>(1, bytes / sizeof(double) / block);
  const std::vector<double> data(blocks * block, 1);
  volatile double sink = 0;
  return best_rate([&] {
    Lanes sum[unroll];
    for (Lanes& s : sum) s = 0;
    for (std::size_t b = 0; b < blocks; ++b)
#pragma GCC unroll 8
      for (int u = 0; u < unroll; ++u) sum[u] += load<Lanes>(data.data() + b * block + u * lane_count);
    for (const Lanes& s : sum) sink = sink + lane_of(s, 0);
    return static_cast<double>(data.size() * sizeof(double));
  });
}

} // namespace trigrain
