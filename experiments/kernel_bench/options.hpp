#pragma once
#include "experiments/kernel_bench/accuracy.hpp"
#include "experiments/kernel_bench/problems.hpp"
#include <filesystem>
#include <iosfwd>
#include <memory>
#include <optional>

namespace trigrain {

/// What one call of kernel_bench is asked to do.
struct BenchOptions {
  std::string kernel = "all", precision = "double", family = "every", precheck = "octree", cuts = "adaptive",
              schedule = "constant";
  int lanes = 0; ///< 0: as many as fill a register
  Query query;
  int pairs = 0; ///< 0: 10000 of triangles: branches cannot be learnt by heart, 100 of meshes
  std::uint64_t seed = 1;
  int repeats = 3;
  double seconds = .05; ///< of a sample, at least
  std::filesystem::path record;
  std::string point_id;
  std::vector<std::string> benchmark_arguments; ///< --benchmark_...
};

/// Reads the command line; none if it asked for --help or --list, which are printed to `out`. InputError otherwise.
std::optional<BenchOptions> parse_bench_options(int argc, char** argv, std::ostream& out);

using BenchPass = std::function<void(Hits&, KernelCounts&)>;
struct Entry;

/// What was seen before the timing.
struct Findings {
  Accuracy accuracy;
  std::optional<Convergence> convergence; ///< of the iterative kernel

  bool right() const { return accuracy.faults == 0; }
  /// By name with unit, for the table and the record.
  std::vector<std::pair<std::string, double>> numbers(const Entry& entry) const;
};

/// One contestant on one family.
struct Entry {
  const Contestant* contestant;
  BenchFamily family;
  const BenchOptions* options;
  const Precheck* precheck;
  std::shared_ptr<const Problem> triangles; ///< or
  std::shared_ptr<const MeshProblem> meshes;

  std::string name() const;
  std::int64_t pairs() const { return triangles ? triangles->size() : meshes->size(); }
  /// Answers all pairs, block by block, each in place of the one before.
  BenchPass pass() const;
  const Findings& findings() const; ///< looked at once

  mutable std::shared_ptr<const Findings> found = nullptr; ///< for findings()
};

/// Those the options name. InputError if there is none, or, with a record, more than one.
std::vector<Entry> chosen_entries(const BenchOptions& options, const std::vector<Contestant>& contestants);

} // namespace trigrain
