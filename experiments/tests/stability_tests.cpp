#include "experiments/stability/study.hpp"
#include "kernels/name_table.hpp"
#include <cmath>
#include <gtest/gtest.h>

namespace trigrain {
namespace {

/// Runs a study and expects every metric within its bar.
void expect_within(const char* study, const StudyRequest& request) {
  for (const Metric& m : row_named(studies(), "study", study).run(request))
    EXPECT_TRUE(m.within()) << study << " at " << request.value << ": " << m.name << " is " << m.value;
}

TEST(ContactRuleFeatures, CuttingFacesChangesNothing) {
  for (const double cuts : {2., 5.}) expect_within("tessellation", {.value = cuts});
}

TEST(ContactRuleFeatures, NoWorkIsDoneAroundClosedPaths) {
  for (const double cuts : {1., 2.}) expect_within("loop-work", {.value = cuts, .seed = 3});
}

TEST(ContactRuleFeatures, ACubeStandsOnItsFaceWithoutWander) { expect_within("face-rest", {.value = 2}); }

TEST(ContactRuleFeatures, TenCubesStandOnEachOther) { expect_within("stack", {.value = 1}); }

TEST(Impact, TheEightTestsOfChungAndOoi) {
  for (int test = 1; test <= 8; ++test)
    expect_within("impact", {.value = static_cast<double>(test), .steps_per_contact = 100.3});
}

TEST(ClosedForm, FreeTops) {
  for (const double top : {1., 2.}) expect_within("free-top", {.value = top});
}

TEST(ClosedForm, ATiltedCubeRebounds) {
  for (const double degrees : {5., 13., 20., 45.}) expect_within("rigid-impact", {.value = degrees});
}

TEST(ClosedForm, AMeshEllipsoidConvergesToTheSmoothOne) {
  double last = 1;
  for (const int level : {2, 3, 4}) {
    const auto metrics = row_named(studies(), "study", "ellipsoid-impact").run({.level = level, .value = 15});
    EXPECT_LT(std::abs(metrics[0].value), last / 2) << "level " << level;
    last = std::abs(metrics[0].value);
  }
  EXPECT_LT(last, .02);
}

TEST(ClosedForm, AMeshSphereMissesWhatItsTrianglesCutOff) {
  const auto metrics = row_named(studies(), "study", "mesh-sphere").run({.level = 3});
  EXPECT_NEAR(metrics[1].value, 5.83, .1) << metrics[1].name;
  EXPECT_NEAR(metrics[2].value, 11.1, .2) << metrics[2].name;
  EXPECT_NEAR(metrics[3].value, 18.4, .3) << metrics[3].name;
  EXPECT_NEAR(metrics[4].value, 40, 20) << metrics[4].name;
}

TEST(ClosedForm, BlocksOnSlopesSlideRestAndTopple) {
  for (const double degrees : {20., 30.}) expect_within("slope", {.value = degrees});
  expect_within("topple", {.value = 3});
}

TEST(ClosedForm, ABouncingBallComesToRestInTime) { expect_within("bounce", {.value = .5}); }

TEST(ClosedForm, ASceneFourTimesAsLargeMovesTheSameBitForBit) { expect_within("similarity", {.value = 4}); }

} // namespace
} // namespace trigrain
