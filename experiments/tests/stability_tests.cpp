#include "experiments/stability/study.hpp"
#include "kernels/name_table.hpp"
#include <cmath>
#include <gtest/gtest.h>
#include <utility>

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

/// Level 1 has edges that count as sharp; friction sees the facets longer than the force does.
TEST(Impact, MeshBallsConvergeToTrueOnes) {
  const auto error_of = [](double test, int level) {
    return row_named(studies(), "study", "impact").run({.level = level, .value = test})[0].value;
  };
  for (const auto& [test, fall] : {std::pair{1., 10.}, {2., 10.}, {4., 3.}, {6., 1.3}})
    EXPECT_LT(error_of(test, 4), error_of(test, 2) / fall) << "test " << test;
}

TEST(ClosedForm, BallsSlideAndRoll) {
  for (const double degrees : {0., 10., 60.}) expect_within("rolling-ball", {.value = degrees});
}

TEST(ClosedForm, PrismsRollOverTheirEdges) {
  for (const double corners : {8., 12., 16.}) expect_within("rolling-polygon", {.value = corners, .stiffness = .01});
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

/// The metrics are errors times the power of the triangles with which theory says they fall: they stay.
TEST(ClosedForm, AMeshSphereMissesWhatItsTrianglesCutOff) {
  const auto coarse = row_named(studies(), "study", "mesh-sphere").run({.level = 2}),
             fine = row_named(studies(), "study", "mesh-sphere").run({.level = 4});
  EXPECT_NEAR(fine[1].value, 5.83, .02) << fine[1].name;
  EXPECT_NEAR(fine[2].value, 11.1, .1) << fine[2].name;
  EXPECT_NEAR(fine[3].value, 18.4, .1) << fine[3].name;
  EXPECT_NEAR(fine[4].value, 40, 20) << fine[4].name;
  for (const int law : {1, 2, 3, 5})
    EXPECT_NEAR(std::log(fine[law].value / coarse[law].value) / std::log(16), 0, .1) << fine[law].name;
}

TEST(ClosedForm, BlocksOnSlopesSlideRestAndTopple) {
  expect_within("slope", {.value = 30});
  expect_within("slope-rest", {.value = 50000});
  expect_within("topple", {.value = 3});
}

TEST(ClosedForm, ABouncingBallComesToRestInTime) { expect_within("bounce", {.value = .5}); }

TEST(ClosedForm, ASceneFourTimesAsLargeMovesTheSameBitForBit) { expect_within("similarity", {.value = 4}); }

double metric(const char* study, const StudyRequest& request, std::string_view name) {
  for (const Metric& m : row_named(studies(), "study", study).run(request))
    if (m.name == name) return m.value;
  ADD_FAILURE() << "no metric " << name;
  return 0;
}

TEST(Discharge, ABinThatIsKeptFullFlowsAndOneThatEmptiesSinks) {
  const StudyRequest request{.value = 5, .stiffness = .25, .particles = 200};
  expect_within("discharge", request);
  const auto found = [&](const char* study, const char* name) {
    for (const Metric& m : row_named(studies(), "study", study).run(request))
      if (m.name == name) return m.value;
    return std::nan("");
  };
  const double full = found("discharge", "level_of_opening");
  EXPECT_GT(full, .8);
  EXPECT_LT(std::abs(found("discharge", "rate_change")), .3);
  EXPECT_NEAR(found("emptying", "level_of_opening_95"), full, .15 * full);
  EXPECT_LT(found("emptying", "level_of_opening_35"), .7 * full);
}

TEST(Stability, ObservedCriticalStepsAreThePredictedOnes) {
  for (const double scene : {0., 1., 5.}) expect_within("critical-step", {.value = scene});
  expect_within("critical-step", {.law = "hertz-mindlin", .value = 0});
  EXPECT_NEAR(metric("critical-step", {.value = 1}, "textbook_over_observed"), std::sqrt(6), .02);
}

TEST(Stability, TheErrorOfReboundsFallsWithTheOrderOfTheLaw) {
  for (const auto& [law, order] : {std::pair("spring-dashpot", 2.), std::pair("hertz-mindlin", 2.5)}) {
    const auto error = [&](double steps) {
      return metric("rebound", {.law = law, .steps_per_contact = steps}, "mean_restitution_error");
    };
    EXPECT_NEAR(std::log(error(160.3) / error(640.3)) / std::log(640.3 / 160.3), order, .1) << law;
  }
  expect_within("rebound", {.steps_per_contact = 20.3});
}

TEST(Stability, TheErrorOfDampedReboundsFallsWithTheSquareOfTheStep) {
  const auto error = [&](const char* law, double steps, const char* of) {
    return metric("rebound", {.law = law, .value = .6, .steps_per_contact = steps}, of);
  };
  const char* mean = "mean_restitution_error";
  EXPECT_NEAR(std::log(error("spring-dashpot", 40.3, mean) / error("spring-dashpot", 320.3, mean)) / std::log(8), 2,
              .1);
  for (const char* law : {"spring-dashpot", "hertz-mindlin"})
    EXPECT_LT(error(law, 40.3, "restitution_error"), 1.5e-3) << law;
}

TEST(Stability, NothingPassesThroughBelowTheResponseLimitOrInSilence) {
  for (const char* control : {"fixed", "approach"})
    for (const double value : {.5, .99, 1.01, 3.}) {
      expect_within("tunnelling", {.control = control, .value = value});
      expect_within("detection", {.control = control, .value = value});
    }
}

TEST(Stability, ReleasedOverlapsReturnWhatTheyStored) {
  for (const double overlap : {.2, .9}) expect_within("overlap-release", {.value = overlap});
}

TEST(Stability, CubesOfAnyMassComeToRestOnOneAnother) {
  for (const double ratio : {1e-2, 3., 30.}) expect_within("mass-ratio", {.value = ratio});
}

TEST(Stability, ACubeSlidesOverACutFloorAsOverAWholeOne) { expect_within("cut-floor", {.value = 7}); }

TEST(Stability, ACubeStaysWhereItRests) { expect_within("long-rest", {.value = 20000}); }

TEST(Stability, OverlapsAreRightFarFromTheOrigin) {
  for (const double away : {1., 1e4}) expect_within("far-from-origin", {.value = away, .seed = 5});
}

TEST(Stability, AnswersScaleBitForBit) {
  for (const double power : {-20., 13.}) expect_within("scale", {.value = power});
}

TEST(Stability, MeshesWithDefectsRunOrAreRefused) { expect_within("degenerate", {}); }

TEST(Stability, FlatDropsAreOneFunctionOfTiltAndSpeed) {
  for (const double theta : {.3, 1.7}) expect_within("flat-drop", {.value = theta});
}

TEST(Stability, GrazingImpactsGainNoEnergy) {
  for (const double degrees : {50., 80., 89.}) expect_within("grazing", {.value = degrees, .seed = 4});
}

TEST(Stability, EverySchemeAndGridGivesTheSameBits) { expect_within("determinism", {.value = 2, .particles = 16}); }

} // namespace
} // namespace trigrain
