// Holds the kernels to their bars on random triangle pairs of every kind, against exact arithmetic.
#include "experiments/option_checks.hpp"
#include "kernels/name_table.hpp"
#include "kernels/proof/proof.hpp"
#include <cstdio>
#include <iostream>

namespace {

using namespace trigrain;

struct Options {
  std::string family = "all", kernel = "all", precision = "all";
  int lanes = 0;
  int pairs = 10000;
  std::uint64_t seed = 1;
};

bool wanted(const std::string& choice, std::string_view name) { return choice == "all" || choice == name; }

std::vector<const Kernel*> chosen_kernels(const Options& options) {
  if (options.kernel != "all") row_named(kernels(), "kernel", options.kernel);
  std::vector<const Kernel*> chosen;
  for (const Kernel& kernel : kernels())
    if (wanted(options.kernel, kernel.name) && wanted(options.precision, kernel.precision) &&
        (options.lanes == 0 || options.lanes == kernel.lanes))
      chosen.push_back(&kernel);
  if (chosen.empty())
    throw InputError("no kernel has that precision and width (--precision " + options.precision + " --lanes " +
                     std::to_string(options.lanes) + "). Leave one out.");
  return chosen;
}

std::string name_of(const Kernel& kernel) {
  return std::string(kernel.name) + ' ' + std::string(kernel.precision) + ' ' + std::to_string(kernel.lanes);
}

/// One line per family and kernel; true if there was no fault.
bool print(const RandomFamily& family, const Tally& t) {
  std::printf("%-15s %-22s %9lld %7.4f %7.4f %10.2e %10.2e %10.2e %8lld\n", family.name.data(),
              name_of(*t.kernel).c_str(), static_cast<long long>(t.pairs), static_cast<double>(t.zeros) / t.pairs,
              static_cast<double>(t.fell_back) / t.pairs, t.worst.distance, t.worst.points, t.worst.apart,
              static_cast<long long>(t.faults));
  for (const std::string& example : t.examples) std::printf("  %s: %s\n", name_of(*t.kernel).c_str(), example.c_str());
  std::fflush(stdout);
  return t.faults == 0;
}

bool run(const Options& options) {
  if (options.family != "all") row_named(random_families(), "family", options.family);
  const std::vector<const Kernel*> chosen = chosen_kernels(options);
  std::printf("%-15s %-22s %9s %7s %7s %10s %10s %10s %8s\n", "family", "kernel", "pairs", "zero", "redone",
              "distance/S", "off/S", "|p-q|-d/S", "faults");
  bool right = true;
  for (const RandomFamily& family : random_families())
    if (wanted(options.family, family.name))
      for (const Tally& tally : prove(family, chosen, options.seed << 32, options.pairs))
        right = print(family, tally) && right;
  std::puts(right ? "every answer is right" : "FAULTS: see above");
  return right;
}

} // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{
      "Proves kernels on random triangle pairs: |d - d*| <= 1e-14 S (float 5.4e-6 S, as many epsilon) against the "
      "exact distance d*, "
      "points in their\ntriangles, |p - q| = d, lower <= d* <= upper, zero if and only if d* is, finite, the same "
      "bits at every power of\ntwo, and the contacts of brute force for every reach. S = max(longest edge, largest "
      "coordinate). Exit code 1 if not."};
  app.add_option("--family", options.family, names_of(random_families()) + ", or all")->capture_default_str();
  app.add_option("--kernel", options.kernel, names_of(kernels()) + ", or all")->capture_default_str();
  app.add_option("--precision", options.precision, "double, float, mixed or all")->capture_default_str();
  app.add_option("--lanes", options.lanes, "pairs at once; 0 for every width")->capture_default_str();
  app.add_option("--pairs", options.pairs, "of each family")->check(above_zero)->capture_default_str();
  app.add_option("--seed", options.seed, "0 to 4294967295; each has pairs of its own")->capture_default_str();
  app.name("kernel_proof");
  if (const auto code = exit_code_of_parsing(app, argc, argv)) return *code;
  try {
    return run(options) ? 0 : 1;
  } catch (const InputError& e) {
    std::cerr << e.what() << '\n';
    return 3;
  }
}
