#include "kernels/brute.hpp"
#include "kernels/name_table.hpp"
#include "pairs.hpp"
#include <array>
#include <cmath>
#include <gtest/gtest.h>

namespace trigrain {

namespace {

/// Brute force with a deliberate error.
template <class Spoil> void spoiled(const PairList& list, const Query& query, Hits& hits, Spoil spoil) {
  for (const PairIndex& index : list.pairs) {
    const Triangle a = list.a[index.i], b = list.b[index.j];
    Closest c = closest_by_brute_force(a, b);
    spoil(c, scale({"", a, b}));
    if (c.distance <= query.reach) hits.push_back({index.i, index.j, c});
  }
}

std::string first_fault(std::string_view family, KernelFunction function) {
  Kernel kernel = kernel_named("brute");
  kernel.closest = function;
  const std::array kernels{static_cast<const Kernel*>(&kernel)};
  const std::vector<Tally> tallies = prove(row_named(random_families(), "family", family), kernels, 0, 200);
  return tallies[0].faults == 0 ? "no fault" : tallies[0].examples[0];
}

/// Every kernel is right on `count` pairs of the family from number `first` on.
void expect_right(const RandomFamily& family, unsigned long long first, int count) {
  std::vector<const Kernel*> all;
  for (const Kernel& kernel : kernels()) all.push_back(&kernel);
  for (const Tally& tally : prove(family, all, first, count))
    EXPECT_EQ(tally.faults, 0) << testing::PrintToString(*tally.kernel) << ": " << tally.examples[0];
}

} // namespace

class RandomPairs : public testing::TestWithParam<RandomFamily> {};

// A small share of what `kernel_proof --pairs 1000000` proves.
TEST_P(RandomPairs, EveryKernelIsRight) { expect_right(GetParam(), 0, 1000); }

INSTANTIATE_TEST_SUITE_P(Families, RandomPairs, testing::ValuesIn(random_families().begin(), random_families().end()),
                         [](const auto& info) { return std::string(info.param.name); });

// Pairs that a million of the family brought up: the height of the first two is 1e-10 of an edge; of the others 1e-3,
// which is thin in float.
TEST(Slivers, AreRightHoweverThin) {
  for (const unsigned long long pair : {8701604331824ull, 8701604569056ull, 8701604232565ull, 8701603843089ull})
    expect_right(row_named(random_families(), "family", "sliver_near"), pair, 1);
}

// Brought up by a million as well: so close that brute force finds one point, which it moves apart by more than lanes
// allow for rounding.
TEST(Touching, ReportsTheContactsOfBruteForceForEveryReach) {
  expect_right(row_named(random_families(), "family", "coplanar_sep"), 87020882140445290ull, 1);
}

// Every bar of the proof must catch a kernel that fails it alone.
TEST(Proof, CatchesEachKindOfError) {
  const auto caught = [](std::string_view family, const char* fault, KernelFunction function) {
    const std::string found = first_fault(family, function);
    EXPECT_EQ(found.find(fault), 0u) << "expected: " << fault << ", found: " << found;
  };
  caught("near_vf", "no fault",
         [](const PairList& l, const Query& q, Hits& h, KernelCounts&) { spoiled(l, q, h, [](Closest&, double) {}); });
  caught("random_sep", "distance wrong", [](const PairList& l, const Query& q, Hits& h, KernelCounts&) {
    spoiled(l, q, h, [](Closest& c, double s) { // another pair of points, honestly bounded
      const Vec3<double> by = .7e-14 * s / c.distance * (c.p - c.q);
      c.p = c.p + by, c.q = c.q - by, c.distance += 1.4e-14 * s, c.upper += 1e-13 * s;
    });
  });
  caught("random_sep", "a point off its triangle", [](const PairList& l, const Query& q, Hits& h, KernelCounts&) {
    spoiled(l, q, h, [](Closest& c, double s) { c.p.x += 1e-13 * s, c.q.x += 1e-13 * s; });
  });
  caught("random_sep", "|p - q| off", [](const PairList& l, const Query& q, Hits& h, KernelCounts&) {
    spoiled(l, q, h, [](Closest& c, double s) { c.distance += 1.01e-14 * s, c.upper += 2e-14 * s; });
  });
  caught("random_sep", "lower bound", [](const PairList& l, const Query& q, Hits& h, KernelCounts&) {
    spoiled(l, q, h, [](Closest& c, double s) { c.lower = c.distance + 1e-15 * s; });
  });
  caught("random_sep", "upper bound", [](const PairList& l, const Query& q, Hits& h, KernelCounts&) {
    spoiled(l, q, h, [](Closest& c, double s) { c.upper = c.distance - 1e-15 * s; });
  });
  caught("random_sep", "not finite", [](const PairList& l, const Query& q, Hits& h, KernelCounts&) {
    spoiled(l, q, h, [](Closest& c, double) { c.q.y = std::numeric_limits<double>::quiet_NaN(); });
  });
  caught("touch_rounded", "false zero", [](const PairList& l, const Query& q, Hits& h, KernelCounts&) {
    spoiled(l, q, h, [](Closest& c, double s) {
      if (c.distance < 1e-14 * s) c.distance = c.lower = 0, c.q = c.p;
    });
  });
  caught("touch_vf", "missed zero", [](const PairList& l, const Query& q, Hits& h, KernelCounts&) {
    spoiled(l, q, h, [](Closest& c, double s) { c.distance = c.upper = 1e-16 * s; });
  });
  caught("random_mixed", "other bits", [](const PairList& l, const Query& q, Hits& h, KernelCounts&) {
    spoiled(l, q, h, [](Closest& c, double s) { c.upper += s < 1e-3 ? 1e-15 : 0; }); // an absolute threshold
  });
  caught("random_sep", "contact missed", [](const PairList& l, const Query& q, Hits& h, KernelCounts&) {
    spoiled(l, {.reach = std::nextafter(q.reach, 0)}, h, [](Closest&, double) {});
  });
  caught("random_sep", "contact invented", [](const PairList& l, const Query& q, Hits& h, KernelCounts&) {
    spoiled(l, {.reach = std::nextafter(q.reach, everywhere)}, h, [](Closest&, double) {});
  });
}

} // namespace trigrain
