#include "experiments/stability/study.hpp"
#include "kernels/name_table.hpp"
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

} // namespace
} // namespace trigrain
