#include "kernels/kernels.hpp"
#include "kernels/brute.hpp"
#include "kernels/brute_mixed.hpp"
#include "kernels/brute_simd.hpp"
#include "kernels/hybrid.hpp"
#include "kernels/iterative.hpp"
#include "kernels/lanes.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>
#include <array>
#include <iterator>

namespace trigrain {

namespace {

constexpr double lambda2 = 0.0125; // Krestenitis (2018), in tr H

constexpr std::array schedule_table{
    PenaltySchedule{"constant", "penalty 1e6 lambda^2, damping 1e-2 tr H in every step", 1e6 * lambda2, 1e-2, 1},
    PenaltySchedule{"stiff", "penalty 1e8 lambda^2, damping 1e-16 tr H: plain Newton on the active set", 1e8 * lambda2,
                    1e-16, 1},
    PenaltySchedule{"growing", "damping that grows 1e4 from step to step, as the published code does", 1e6 * lambda2,
                    1e-8, 1e4},
};

// Flops: + - * / and square roots of one separated pair whose distance is wanted, counted by running the text with a
// counting number; minima, selects and comparisons are not in it. For `brute` the mean over random pairs, for `mixed`
// of a pair that float drops.
// Bytes: two triangles of nine doubles in, one Hit out.
constexpr double bytes_per_pair = 2 * 9 * sizeof(double) + Hits::columns * sizeof(double) + 3 * sizeof(int);

template <class T> constexpr std::string_view precision_of = sizeof(ScalarOf<T>) == sizeof(double) ? "double" : "float";

template <class T> constexpr Kernel brute_simd_row() {
  return {"brute-simd",
          precision_of<T>,
          lanes_of<T>,
          "15 features without branches, crossing in lanes or exactly",
          sizeof(ScalarOf<T>) == sizeof(double),
          brute_simd<T>,
          680,
          bytes_per_pair};
}

template <class T> constexpr Kernel iterative_row() {
  return {"iterative", precision_of<T>,
          lanes_of<T>, "Newton steps of the penalty method; Krestenitis, Weinzierl, Koziara (2017)",
          false,       iterative<T>,
          715,         bytes_per_pair};
}

template <class Float, class Double> constexpr Kernel mixed_row() {
  return {"brute-simd",
          "mixed",
          lanes_of<Float>,
          "far pairs dropped in float with a proven bound, the rest as in double",
          true,
          brute_mixed<Float, Double>,
          680,
          bytes_per_pair};
}

template <class T> constexpr Kernel hybrid_row(std::string_view name, std::string_view about, KernelFunction closest) {
  return {name, precision_of<T>, lanes_of<T>, about, true, closest, 1590, bytes_per_pair};
}
template <class T> constexpr Kernel hybrid_pair_row() {
  return hybrid_row<T>("hybrid-pair",
                       "Newton, proven per pair by a separating plane or redone by brute force; Krestenitis (2018)",
                       hybrid_pair<T>);
}
template <class T> constexpr Kernel hybrid_batch_row() {
  return hybrid_row<T>("hybrid-batch", "the same, a batch proven or redone as a whole; Krestenitis (2018)",
                       hybrid_batch<T>);
}

constexpr std::array all_rows{
    Kernel{"brute", "double", 1,
           "15 features with branches, crossing decided exactly; Krestenitis (2018), Ericson (2005) 5.1.5, 5.1.9", true,
           brute, 1400, bytes_per_pair},
    brute_simd_row<double>(),
    brute_simd_row<Pack<double, 4>>(),
    brute_simd_row<Pack<double, 8>>(),
    brute_simd_row<float>(),
    brute_simd_row<Pack<float, 4>>(),
    brute_simd_row<Pack<float, 8>>(),
    brute_simd_row<Pack<float, 16>>(),
    mixed_row<float, double>(),
    mixed_row<Pack<float, 8>, Pack<double, 4>>(),
    mixed_row<Pack<float, 16>, Pack<double, 8>>(),
    iterative_row<double>(),
    iterative_row<Pack<double, 4>>(),
    iterative_row<Pack<double, 8>>(),
    hybrid_pair_row<double>(),
    hybrid_pair_row<Pack<double, 4>>(),
    hybrid_pair_row<Pack<double, 8>>(),
    hybrid_batch_row<double>(),
    hybrid_batch_row<Pack<double, 4>>(),
    hybrid_batch_row<Pack<double, 8>>(),
};

/// As many lanes as fill a register.
int native_lanes(std::string_view precision) { return precision == "double" ? lane_count : float_lane_count; }

/// The rows of this build. Packs wider than a register gain nothing, and GCC 12 miscompiles some functions over them.
std::vector<Kernel> rows_that_fit() {
  std::vector<Kernel> rows;
  std::copy_if(all_rows.begin(), all_rows.end(), std::back_inserter(rows),
               [](const Kernel& row) { return row.lanes <= native_lanes(row.precision); });
  return rows;
}

const std::vector<Kernel>& table() {
  static const std::vector<Kernel> rows = rows_that_fit();
  return rows;
}

} // namespace

std::span<const PenaltySchedule> penalty_schedules() { return schedule_table; }
std::span<const Kernel> kernels() { return table(); }

void closest_of_all(const Kernel& kernel, TrianglesView a, TrianglesView b, const Query& query, Hits& hits,
                    KernelCounts& counts) {
  std::array<PairIndex, 512> list; // a multiple of every batch and pack
  std::size_t n = 0;
  const auto solve = [&] {
    kernel.closest({a, b, std::span(list).first(n)}, query, hits, counts);
    n = 0;
  };
  for (int i = 0; i < a.size; ++i)
    for (int j = 0; j < b.size; ++j) {
      list[n++] = {i, j};
      if (n == list.size()) solve();
    }
  if (n > 0) solve();
}

const Kernel& kernel_named(std::string_view name, std::string_view precision, int lanes) {
  row_named(table(), "kernel", name);
  std::string known;
  const Kernel* widest = nullptr;
  for (const Kernel& row : table()) {
    if (row.name != name) continue;
    known += (known.empty() ? "" : ", ") + std::string(row.precision) + " with " + std::to_string(row.lanes) + " lanes";
    if (row.precision != precision) continue;
    if (row.lanes == lanes) return row;
    if (!widest || row.lanes > widest->lanes) widest = &row;
  }
  if (lanes == 0 && widest) return *widest;
  throw InputError("kernel '" + std::string(name) + "' does not come in precision '" + std::string(precision) + "'" +
                   (lanes == 0 ? "" : " with " + std::to_string(lanes) + " lanes") + ". Known: " + known + ".");
}

} // namespace trigrain
