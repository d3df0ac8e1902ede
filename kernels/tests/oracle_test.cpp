#include "pairs.hpp"
#include <algorithm>
#include <gtest/gtest.h>

namespace trigrain {

// The file's distances were computed by two other methods in rational numbers (data/README.md).
TEST(Oracle, MeetsEveryReferenceDistanceToTheLastBit) {
  for (const auto& [pair, distance] : reference_pairs()) {
    EXPECT_EQ(static_cast<double>(oracle::distance(pair.a, pair.b)), distance) << pair;
    EXPECT_EQ(static_cast<double>(oracle::distance(pair.b, pair.a)), distance) << pair;
  }
}

TEST(Oracle, TheFilterChangesNoDistance) {
  for (const RandomFamily& family : random_families()) {
    oracle::Decisions decisions;
    for (int k = 0; k < 200; ++k) {
      const Pair pair = random_pair(family, k);
      ASSERT_EQ(oracle::distance(pair.a, pair.b, &decisions), oracle::distance_unfiltered(pair.a, pair.b)) << pair;
    }
    if (family.name == "random_sep") {
      EXPECT_GT(decisions.filtered, 190);
    }
    if (family.name == "identical") {
      EXPECT_EQ(decisions.exact, 200);
    }
  }
}

TEST(Oracle, TheLastBitDecidesBetweenTouchingAndNot) {
  const Triangle steep{{0, 0, 0}, {1, 0, 1}, {0, 1, 1}}; // in the plane z = x + y
  const auto with_corner_at = [](double z) { return Triangle{{.25, .25, z}, {.25, .25, 3}, {.5, .5, 3}}; };
  EXPECT_EQ(oracle::distance(steep, with_corner_at(.5)), 0);
  EXPECT_EQ(oracle::distance(steep, with_corner_at(.5 - 0x1p-54)), 0);
  EXPECT_GT(oracle::distance(steep, with_corner_at(.5 + 0x1p-53)), 0);
  EXPECT_LT(oracle::distance(steep, with_corner_at(.5 + 0x1p-53)), 0x1p-53);
}

TEST(RandomFamilies, ContainWhatTheirNamesSay) {
  for (const RandomFamily& family : random_families()) {
    const Problem p = problem(family, 0, 200);
    const auto zeros = std::count(p.distance.begin(), p.distance.end(), 0);
    const bool touches = family.name.starts_with("touch") && family.name != "touch_rounded";
    if (touches || family.name.starts_with("shared") || family.name == "identical") {
      EXPECT_EQ(zeros, 200) << family.name;
    }
    if (family.name == "random_sep" || family.name == "near_vf") {
      EXPECT_EQ(zeros, 0) << family.name;
    }
    if (family.name.starts_with("cross")) {
      EXPECT_GT(zeros, 150) << family.name;
    }
    if (family.name == "lattice" || family.name == "coplanar_mixed" || family.name == "touch_rounded") {
      EXPECT_GT(zeros, 40) << family.name;
      EXPECT_LT(zeros, 190) << family.name;
    }
  }
}

} // namespace trigrain
