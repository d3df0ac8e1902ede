#include "pairs.hpp"
#include <gtest/gtest.h>

namespace trigrain {

namespace {

/// Triangles of both sides of random pairs, near enough to one another that some reach and some do not.
Triangles crowd(int size, std::uint64_t first) {
  Triangles t;
  for (int k = 0; k < size; ++k) {
    std::mt19937_64 random(first + k);
    t.push_back(random_families()[k % 2].make(random).b); // general and separated
  }
  return t;
}

bool same(const Closest& x, const Closest& y) {
  return x.distance == y.distance && x.upper == y.upper && x.lower == y.lower && x.fell_back == y.fell_back &&
         x.p.x == y.p.x && x.p.y == y.p.y && x.p.z == y.p.z && x.q.x == y.q.x && x.q.y == y.q.y && x.q.z == y.q.z;
}

} // namespace

// Ragged sizes leave lanes of padding; none of them may answer or change an answer.
TEST(Batches, GiveEveryPairTheAnswerItGetsAlone) {
  for (const Kernel& kernel : kernels())
    for (const auto& [m, n] : {std::pair{1, 1},
                               {1, 2},
                               {2, 3},
                               {3, 1},
                               {4, 4},
                               {5, 7},
                               {7, 15},
                               {1, 16},
                               {2, 17},
                               {3, 33},
                               {35, 5},
                               {17, 35}})
      for (const double reach : {0.3, everywhere}) {
        const Triangles a = crowd(m, 100), b = crowd(n, 900);
        Hits hits;
        std::vector<Hit> expected;
        KernelCounts counts;
        closest_of_all(kernel, a.view(), b.view(), {.reach = reach}, hits, counts);
        EXPECT_EQ(counts.triangle_pairs, m * n);
        for (int i = 0; i < m; ++i)
          for (int j = 0; j < n; ++j)
            if (const Closest c = solve(kernel, a.view()[i], b.view()[j]); c.distance <= reach)
              expected.push_back({i, j, c});
        ASSERT_EQ(hits.size(), std::ssize(expected)) << kernel.name << ' ' << m << " x " << n << " reach " << reach;
        for (int k = 0; k < hits.size(); ++k) {
          ASSERT_EQ(hits[k].i, expected[k].i);
          ASSERT_EQ(hits[k].j, expected[k].j);
          if (kernel.name == "hybrid-batch") continue; // its answers depend on the batch, its contacts do not
          ASSERT_TRUE(same(hits[k].closest, expected[k].closest))
              << kernel.name << ' ' << hits[k].i << ' ' << hits[k].j;
        }
      }
}

TEST(Batches, EverySizeUpToThreePacksReportsEveryPairInOrder) {
  for (const Kernel& kernel : kernels())
    for (int n = 1; n <= 35; ++n) {
      const Triangles a = crowd(2, 5), b = crowd(n, 50);
      Hits hits;
      KernelCounts counts;
      closest_of_all(kernel, a.view(), b.view(), {}, hits, counts);
      ASSERT_EQ(hits.size(), 2 * n) << kernel.name;
      for (int k = 0; k < 2 * n; ++k) ASSERT_EQ(hits[k].i * n + hits[k].j, k) << kernel.name;
    }
}

// Without damping Newton's matrix may be singular.
TEST(Batches, EveryScheduleAnswersEveryPair) {
  for (const RandomFamily& family : random_families()) {
    const Problem pairs = problem(family, 1, 100);
    for (const Kernel& kernel : kernels())
      for (const PenaltySchedule& schedule : penalty_schedules()) {
        Hits hits;
        KernelCounts counts;
        kernel.closest(pairs.pair_list(), {.steps = 8, .schedule = &schedule}, hits, counts);
        ASSERT_EQ(hits.size(), pairs.size()) << kernel.name << ' ' << schedule.name << ' ' << family.name;
      }
  }
}

TEST(Batches, NothingAgainstSomethingIsNothing) {
  const Triangles none, some = crowd(3, 1);
  for (const Kernel& kernel : kernels()) {
    Hits hits;
    KernelCounts counts;
    closest_of_all(kernel, none.view(), some.view(), {}, hits, counts);
    closest_of_all(kernel, some.view(), none.view(), {}, hits, counts);
    EXPECT_TRUE(hits.empty());
    EXPECT_EQ(counts.triangle_pairs, 0);
  }
}

TEST(Batches, HitsAreAppendedAndCountsAreAddedTo) {
  const Triangles a = crowd(3, 1), b = crowd(4, 7);
  for (const Kernel& kernel : kernels()) {
    Hits hits;
    KernelCounts counts;
    closest_of_all(kernel, a.view(), b.view(), {}, hits, counts);
    const KernelCounts once = counts;
    closest_of_all(kernel, a.view(), b.view(), {}, hits, counts);
    EXPECT_EQ(hits.size(), 24);
    EXPECT_EQ(counts.triangle_pairs, 24);
    EXPECT_EQ(counts.newton_steps, 2 * once.newton_steps);
    EXPECT_EQ(counts.fall_backs, 2 * once.fall_backs);
  }
}

TEST(HybridPair, CountsItsFallBacks) {
  const Triangle a{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, crossing{{.2, .2, -1}, {.2, .2, 1}, {2, 2, 1}};
  Hits hits;
  KernelCounts counts;
  const Triangles ta = only(a), tb = only(crossing);
  closest_of_all(kernel_named("hybrid-pair"), ta.view(), tb.view(), {}, hits, counts);
  EXPECT_EQ(counts.fall_backs, 1);
  EXPECT_TRUE(hits[0].closest.fell_back);
}

// What lets threads share a list of pairs: its parts give what the whole gives, bit for bit.
TEST(Batches, PartsOfAListGiveWhatTheWholeGives) {
  const Triangles a = crowd(23, 100), b = crowd(31, 900);
  std::vector<PairIndex> pairs;
  for (int i = 0; i < a.size(); ++i)
    for (int j = 0; j < b.size(); ++j) pairs.push_back({i, j});
  const PairList list{a.view(), b.view(), pairs};
  for (const Kernel& kernel : kernels())
    for (const int part : {1, 8, 40, 100}) {
      if (kernel.name == "hybrid-batch" && part % Query{}.batch != 0) continue; // must not cut its batches
      Hits whole, parts;
      KernelCounts counts;
      kernel.closest(list, {.reach = 1}, whole, counts);
      for (int first = 0; first < list.size(); first += part)
        kernel.closest(list.part(first, part), {.reach = 1}, parts, counts);
      ASSERT_EQ(whole.size(), parts.size()) << testing::PrintToString(kernel) << ", parts of " << part;
      for (int k = 0; k < whole.size(); ++k) {
        ASSERT_EQ(whole[k].i, parts[k].i);
        ASSERT_EQ(whole[k].j, parts[k].j);
        ASSERT_TRUE(same(whole[k].closest, parts[k].closest))
            << testing::PrintToString(kernel) << ", parts of " << part;
      }
    }
}

// A pack that lies across two cache lines takes twice as long to load or store.
TEST(Batches, ColumnsBeginAtCacheLines) {
  const auto begins_a_line = [](const void* x) { return reinterpret_cast<std::uintptr_t>(x) % cache_line == 0; };
  for (const int size : {1, 20, 1000}) {
    const Triangles t = crowd(size, 0);
    for (const double* column : t.view().coordinate) EXPECT_TRUE(begins_a_line(column));
    Hits hits;
    hits.reserve(size);
    for (int c = 0; c < Hits::columns; ++c) EXPECT_TRUE(begins_a_line(hits.next(static_cast<Hits::Quantity>(c))));
    EXPECT_TRUE(begins_a_line(hits.next_i()) && begins_a_line(hits.next_j()) && begins_a_line(hits.next_feature()));
  }
}

} // namespace trigrain
