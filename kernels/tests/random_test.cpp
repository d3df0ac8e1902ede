#include "oracle.hpp"
#include "pairs.hpp"
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <gtest/gtest.h>

namespace trigrain {

using boost::multiprecision::cpp_bin_float_quad;
using boost::multiprecision::cpp_rational;

constexpr int pairs_per_family = 4000;

double rounded(const cpp_rational& d2) { return std::sqrt(static_cast<double>(d2)); }

class RandomPairs : public testing::TestWithParam<RandomFamily> {};

TEST_P(RandomPairs, EveryKernelMeetsQuadruplePrecision) {
  int exact_decisions = 0;
  for (int k = 0; k < pairs_per_family; ++k) {
    const Pair pair = random_pair(GetParam(), k);
    double distance = static_cast<double>(sqrt(oracle::distance2<cpp_bin_float_quad>(pair.a, pair.b)));
    // Quadruple precision cannot tell touching from almost touching: ask rational numbers.
    if (distance < 1e-14 * scale(pair) && ++exact_decisions <= 100)
      distance = rounded(oracle::distance2<cpp_rational>(pair.a, pair.b));
    else if (distance < 1e-14 * scale(pair))
      continue;
    for (const Kernel& kernel : kernels()) {
      ASSERT_EQ(fault(solve(kernel, pair.a, pair.b), pair, distance, tolerance_of(kernel), finds_distance(kernel)), "")
          << testing::PrintToString(kernel) << ", case " << k << ": " << pair;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Families, RandomPairs, testing::ValuesIn(random_families()),
                         [](const auto& info) { return info.param.name; });

// Small integers touch, cross, coincide and degenerate all the time, and rational numbers know the truth.
TEST(LatticePairs, EveryKernelMeetsRationalNumbers) {
  int touching = 0;
  for (int k = 0; k < 4000; ++k) {
    const Pair pair = lattice_pair(k);
    const double distance = rounded(oracle::distance2<cpp_rational>(pair.a, pair.b));
    touching += distance == 0;
    for (const Kernel& kernel : kernels()) {
      ASSERT_EQ(fault(solve(kernel, pair.a, pair.b), pair, distance, tolerance_of(kernel), finds_distance(kernel)), "")
          << testing::PrintToString(kernel) << ", case " << k << ": " << pair;
    }
  }
  EXPECT_GT(touching, 800);
}

// A hybrid that decides about contact differently from brute force would make physics depend on the kernel.
TEST(HybridPair, FindsTheContactsOfBruteForceForEveryReach) {
  const Kernel &brute = kernel_named("brute"), &hybrid = kernel_named("hybrid-pair");
  for (const RandomFamily& family : random_families())
    for (int k = 0; k < 4000; ++k) {
      const Pair pair = random_pair(family, k);
      const Triangles a = only(pair.a), b = only(pair.b);
      const double d = solve(brute, pair.a, pair.b).distance;
      for (const double reach :
           {0., d, std::nextafter(d, 0), std::nextafter(d, everywhere), 0.9 * d, 1.1 * d, 1e-2 * scale(pair)}) {
        Hits hits;
        KernelCounts counts;
        closest_of_all(hybrid, a.view(), b.view(), {.reach = reach}, hits, counts);
        ASSERT_EQ(hits.size(), d <= reach ? 1 : 0) << "reach " << reach << ", case " << k << ": " << pair;
      }
    }
}

} // namespace trigrain
