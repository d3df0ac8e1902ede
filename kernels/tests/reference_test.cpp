#include "kernels/name_table.hpp"
#include "pairs.hpp"
#include <cmath>
#include <gtest/gtest.h>

namespace trigrain {

class EveryKernel : public testing::TestWithParam<Kernel> {
 protected:
  bool finds() const { return finds_distance(GetParam()); }
  double tolerance() const { return tolerance_of(GetParam()); }
};

TEST_P(EveryKernel, MeetsTheReferenceDistancesInBothOrders) {
  const std::vector<ReferencePair> pairs = reference_pairs();
  ASSERT_EQ(pairs.size(), 2040u);
  double worst = 0;
  for (const auto& [pair, distance] : pairs) {
    const Closest ab = solve(GetParam(), pair.a, pair.b), ba = solve(GetParam(), pair.b, pair.a);
    EXPECT_EQ(judged(ab, pair, distance, tolerance(), finds()).fault, "") << pair;
    EXPECT_EQ(judged(ba, {pair.family, pair.b, pair.a}, distance, tolerance(), finds()).fault, "")
        << "swapped " << pair;
    if (finds()) {
      EXPECT_LE(std::fabs(ab.distance - ba.distance), .2 * tolerance() * scale(pair)) << pair;
    }
    worst = std::max(worst, std::fabs(ab.distance - distance) / scale(pair));
  }
  RecordProperty("worst_error_over_S", std::to_string(worst));
}

// The family of the reference file that lies apart by a good part of an edge: the certificate must see it.
TEST(ExactKernels, ProveAUsefulLowerBoundForSeparatedPairs) {
  for (const auto& [pair, distance] : reference_pairs()) {
    if (pair.family != "random_sep") continue;
    for (const char* name : {"brute", "hybrid-pair"}) {
      const Closest c = solve(kernel_named(name), pair.a, pair.b);
      EXPECT_GE(c.lower, distance * (1 - 1e-12)) << name << ' ' << pair;
    }
  }
}

// Penalty Newton with four steps: how good the published baseline is here is part of its description (newton.hpp).
TEST(Iterative, IsWithinATenthOfAnEdgeOfTheReference) {
  for (const auto& [pair, distance] : reference_pairs())
    EXPECT_LE(solve(kernel_named("iterative"), pair.a, pair.b).distance - distance, 0.1 * scale(pair)) << pair;
}

TEST_P(EveryKernel, ScalesBitForBitWithPowersOfTwo) {
  const bool is_float = GetParam().precision == "float"; // products of four lengths must stay in its range
  for (const auto& [pair, distance] : reference_pairs())
    for (const int power : {is_float ? -4 : -60, -3, 1, is_float ? 7 : 50}) {
      const double f = std::ldexp(1, power);
      const auto scaled = [&](const Triangle& t) { return Triangle{f * t.a0, f * t.a1, f * t.a2}; };
      const Closest one = solve(GetParam(), pair.a, pair.b), other = solve(GetParam(), scaled(pair.a), scaled(pair.b));
      ASSERT_EQ(f * one.upper, other.upper) << power << ' ' << pair;
      ASSERT_EQ(f * one.lower, other.lower) << power << ' ' << pair;
      ASSERT_EQ(f * one.p.x, other.p.x) << power << ' ' << pair;
      ASSERT_EQ(f * one.q.z, other.q.z) << power << ' ' << pair;
    }
}

INSTANTIATE_TEST_SUITE_P(Kernels, EveryKernel, testing::ValuesIn(kernels().begin(), kernels().end()),
                         [](const auto& info) {
                           std::string name = std::string(info.param.name) + "_" + std::string(info.param.precision) +
                                              "_" + std::to_string(info.param.lanes);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(KernelTable, AnUnknownNameListsTheKnownOnes) {
  try {
    kernel_named("brutal");
    FAIL() << "accepted";
  } catch (const InputError& e) {
    const std::string text = e.what();
    EXPECT_NE(text.find("unknown kernel 'brutal'"), text.npos) << text;
    for (const Kernel& k : kernels()) EXPECT_NE(text.find(k.name), text.npos) << text;
  }
}

} // namespace trigrain
