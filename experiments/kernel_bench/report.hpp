#pragma once
#include "experiments/kernel_bench/options.hpp"
#include <nlohmann/json_fwd.hpp>

namespace trigrain {

/// One repetition: all pairs, `passes` times.
struct BenchSample {
  double wall, cpu; ///< s
  std::int64_t passes;
};

/// The record of one entry (experiments/schema/kernel_record.json); no samples if its check failed.
nlohmann::ordered_json bench_record(const BenchOptions& options, const Entry& entry,
                                    const std::vector<BenchSample>& samples);

} // namespace trigrain
