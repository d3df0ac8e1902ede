#include "dem/grid.hpp"
#include "kernels/name_table.hpp"
#include "one_thread.hpp"
#include <gtest/gtest.h>
#include <random>

namespace trigrain {
namespace {

using Eigen::Vector3d;

Grid grid_of(std::string_view kind, int k, const Particles& particles) {
  return {row_named(grid_kinds(), "grid", kind), k, {}, particles};
}

Body ball(double diameter, const Vector3d& position, const Vector3d& velocity = Vector3d::Zero()) {
  Body b;
  b.sphere_radius = diameter / 2;
  b.position = position;
  b.velocity = velocity;
  return b;
}

/// One step as a simulation sees it: update, then every entry is compared.
std::size_t compare_all(Grid& grid, const Particles& particles) {
  grid.update(particles, one_thread());
  std::vector<BodyPair> pairs;
  for (int e = 0; e < grid.entries(); ++e) grid.pairs_of(e, particles, Sieve::none, pairs);
  return pairs.size();
}

/// What the last update did.
StepStats count(const Grid& grid) {
  StepStats stats;
  grid.count(stats);
  return stats;
}

/// Does a vertex hang: are not all cells of its level around it there?
bool hangs(const Spacetree& tree, int k, int level, const Index3& vertex) {
  if (level == 0) return false;
  for (int corner = 0; corner < 8; ++corner) {
    const Index3 cell = vertex - Index3(corner & 1, corner >> 1 & 1, corner >> 2);
    if ((cell < 0).any() || (cell >= tree.level(level).cells).any()) continue;
    if (!tree.is_split(level - 1, cell / k)) return true;
  }
  return false;
}

TEST(Spacetree, BodiesLiveAtTheNearestVertexOfTheirLevelWhichNeverHangs) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> jump(0, .01);
  for (const char* kind : {"adaptive", "reluctant"})
    for (const int k : {2, 3}) {
      Particles p;
      for (int i = 0; i < 200; ++i)
        p.add(ball(.01 * std::pow(20, unit(random)), Vector3d(unit(random), unit(random), unit(random)),
                   Vector3d(unit(random), unit(random), unit(random)) - Vector3d::Constant(.5)));
      Grid grid = grid_of(kind, k, p);
      const Spacetree& tree = *grid.tree();
      for (int step = 0; step < 30; ++step) {
        compare_all(grid, p);
        for (int i = 0; i < p.size(); ++i) {
          const int level = grid.level_of(i), target = tree.level_for(2 * p.radius[i]);
          const Index3 vertex = tree.vertex_of(level, grid.vertex_of(i));
          ASSERT_EQ(tree.key(level, vertex), grid.vertex_of(i));
          ASSERT_TRUE((vertex == tree.vertex_near(level, p.position[i])).all()) << kind << k << " body " << i;
          ASSERT_FALSE(hangs(tree, k, level, vertex)) << kind << k << " step " << step << " body " << i;
          ASSERT_LE(level, target) << "a body that is wider than its cells";
          ASSERT_TRUE(level == target || std::string_view(kind) != "adaptive");
          ASSERT_TRUE(level == target || !tree.is_split_around(level, vertex)) << "it could have dropped";
        }
        for (auto& x : p.position) x += Vector3d(jump(random), jump(random), jump(random));
      }
      EXPECT_GT(tree.coarsenings(), 0);
    }
}

TEST(Spacetree, AtRestNothingIsSplitOrJoined) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(0, 1);
  Particles p;
  for (int i = 0; i < 300; ++i) p.add(ball(.02, Vector3d(unit(random), unit(random), unit(random))));
  for (const char* kind : {"adaptive", "reluctant"}) {
    Grid grid = grid_of(kind, 3, p);
    for (int step = 0; step < 20; ++step) compare_all(grid, p);
    for (int step = 0; step < 20; ++step) {
      compare_all(grid, p);
      const StepStats stats = count(grid);
      EXPECT_EQ(stats.refinements + stats.coarsenings, 0) << kind;
      EXPECT_EQ(stats.settled_bodies, 0) << kind << ": they stay where they are";
    }
  }
}

TEST(Spacetree, OnlyBodiesThatComeToAnotherVertexAreSettled) {
  Particles p;
  for (int i = 0; i < 1000; ++i)
    p.add(ball(.02, Vector3d(.05 + .1 * (i % 10), .05 + .1 * (i / 10 % 10), .05 + .1 * (i / 100))));
  Grid grid = grid_of("adaptive", 3, p);
  for (int step = 0; step < 3; ++step) compare_all(grid, p);
  const double cell = grid.tree()->level(grid.level_of(0)).cell_size;
  for (const int movers : {1, 10, 100}) {
    for (int i = 0; i < movers; ++i) p.position[i].z() += cell;
    compare_all(grid, p);
    EXPECT_EQ(count(grid).settled_bodies, movers);
  }
}

TEST(Spacetree, CellsOfTheAdaptiveGridFollowABodyAndLeaveNothingBehind) {
  Particles p;
  p.add(ball(.01, {.101, .203, .299}));
  for (const int k : {2, 3}) {
    Grid grid = grid_of("adaptive", k, p);
    grid.update(p, one_thread());
    const std::int64_t most = 1 + (grid.levels() - 1) * 8 * k * k * k; // 8 split cells per level
    EXPECT_LE(grid.tree()->cells(), most);
    for (int step = 0; step < 500; ++step) {
      p.position[0] = Vector3d(.5 + .4 * std::sin(.1 * step), .5 + .4 * std::sin(.13 * step), .5);
      grid.update(p, one_thread());
      ASSERT_LE(grid.tree()->cells(), most) << "k=" << k << " step " << step;
      ASSERT_EQ(grid.tree()->cells(), 1 + (grid.tree()->refinements() - grid.tree()->coarsenings()) * k * k * k);
    }
  }
}

TEST(Spacetree, ReluctantSplitsOnlyForBodiesThatMeet) {
  Particles p;
  p.add(ball(.02, {.2, .5, .5}, {1, 0, 0}));
  p.add(ball(.02, {.8, .5, .5}, {-1, 0, 0}));
  Grid grid = grid_of("reluctant", 3, p);
  const auto step = [&](double half_distance) {
    p.position[0].x() = .5 - half_distance;
    p.position[1].x() = .5 + half_distance;
    return compare_all(grid, p);
  };
  for (double x = .3; x > .0101; x -= .01) ASSERT_EQ(step(x), 1u) << "both at the root: one comparison";
  EXPECT_EQ(grid.tree()->refinements(), 0) << "they have not met yet";
  for (int i = 0; i < 10; ++i) step(.0099);
  EXPECT_EQ(grid.level_of(0), grid.tree()->level_for(.02));
  EXPECT_GT(grid.tree()->refinements(), 0);
  const std::int64_t most = grid.tree()->cells();
  for (auto& v : p.velocity) v = -v;
  step(.3);
  EXPECT_LT(grid.level_of(0), grid.tree()->level_for(.02)) << "lifted";
  for (int i = 0; i < 5; ++i) step(.3);
  EXPECT_LT(grid.tree()->cells(), most);
}

TEST(Spacetree, AnnealingHalvesTheMassOfACellInEverySweep) {
  const auto sweeps_until_gone = [](std::string_view kind, int bodies) {
    Spacetree tree(row_named(grid_kinds(), "grid", kind), 3, {}, .1);
    for (int i = 0; i < bodies; ++i) tree.enter(0, {0, 0, 0});
    for (int i = 0; i < 50; ++i) tree.sweep(); // mass tends to twice the number of bodies
    EXPECT_EQ(tree.cells(), 28);
    for (int i = 0; i < bodies; ++i) tree.leave(0, {0, 0, 0});
    int sweeps = 0;
    for (; tree.cells() > 1 && sweeps < 100; ++sweeps) tree.sweep();
    return sweeps;
  };
  EXPECT_EQ(sweeps_until_gone("reluctant", 1), 1);  // 2 -> 1
  EXPECT_EQ(sweeps_until_gone("reluctant", 3), 2);  // 6 -> 3 -> 1.5
  EXPECT_EQ(sweeps_until_gone("reluctant", 20), 5); // 40 -> 20 -> 10 -> 5 -> 2.5 -> 1.25
  EXPECT_EQ(sweeps_until_gone("adaptive", 20), 1);
}

TEST(Spacetree, ACrowdMakesTheReluctantGridSplitBeforeBodiesMeet) {
  Particles p;
  for (int i = 0; i < 1000; ++i)
    p.add(ball(.02, Vector3d(.05 + .1 * (i % 10), .05 + .1 * (i / 10 % 10), .05 + .1 * (i / 100))));
  Grid grid = grid_of("reluctant", 2, p);
  EXPECT_EQ(compare_all(grid, p), 499500u);
  for (int i = 0; i < 10; ++i) compare_all(grid, p);
  EXPECT_LT(compare_all(grid, p), 64000u);
}

} // namespace
} // namespace trigrain
