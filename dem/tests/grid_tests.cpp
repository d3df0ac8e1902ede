#include "dem/grid.hpp"
#include "kernels/name_table.hpp"
#include "one_thread.hpp"
#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <random>

namespace trigrain {
namespace {

using Eigen::Vector3d;
using Pairs = std::map<std::pair<int, int>, int>; // pair -> how often it was reported

std::vector<BodyPair> pairs_in_order(const PairSource& source, const Particles& particles) {
  std::vector<BodyPair> found;
  for (int e = 0; e < source.entries(); ++e) source.pairs_of(e, particles, Sieve::none, found);
  return found;
}

Pairs pairs_of(const PairSource& source, const Particles& particles) {
  Pairs pairs;
  for (const BodyPair p : pairs_in_order(source, particles)) {
    EXPECT_LT(p.a, p.b);
    ++pairs[{p.a, p.b}];
  }
  return pairs;
}

const GridKind& kind(std::string_view name) {
  for (const GridKind& k : grid_kinds())
    if (k.name == name) return k;
  throw std::invalid_argument(std::string(name));
}

/// Spheres of diameters from smallest to smallest * ratio, at random places, on vertices, between them and outside.
Particles crowd(int count, double smallest, double ratio, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  Particles particles;
  for (int i = 0; i < count; ++i) {
    Body ball;
    ball.sphere_radius = smallest / 2 * std::pow(ratio, i % 5 / 4.);
    ball.halo = .05 * ball.sphere_radius;
    ball.position = Vector3d(unit(random), unit(random), unit(random));
    if (i % 7 == 0) ball.position = (ball.position * 27).array().round() / 27;        // on a vertex
    if (i % 7 == 1) ball.position = ((ball.position * 27).array().floor() + .5) / 27; // half way between vertices
    if (i % 7 == 2) ball.position = 2 * ball.position - Vector3d::Constant(.5);       // often outside
    ball.fixed = i % 11 == 0;
    if (!ball.fixed) ball.velocity = Vector3d(unit(random), unit(random), unit(random)) - Vector3d::Constant(.5);
    particles.add(ball);
  }
  return particles;
}

/// Every pair of bodies once; no pair left out that overlaps, or could if both used the room they have.
void check_pairs(const PairSource& source, const Particles& p) {
  const Pairs pairs = pairs_of(source, p);
  for (const auto& [pair, count] : pairs) ASSERT_EQ(count, 1) << pair.first << " " << pair.second;
  for (int a = 0; a < p.size(); ++a)
    for (int b = a + 1; b < p.size(); ++b) {
      if ((p.fixed(a) && p.fixed(b)) || pairs.contains({a, b})) continue;
      const double gap = (p.position[a] - p.position[b]).norm() - p.radius[a] - p.radius[b] - p.halo[a] - p.halo[b];
      ASSERT_GE(gap, 0) << "lost: " << a << " " << b;
      const double used = (p.fixed(a) ? 0 : source.room(a)) + (p.fixed(b) ? 0 : source.room(b));
      ASSERT_GE(gap, used - 1e-12) << "room of " << a << " " << b;
    }
}

TEST(Grid, EveryOverlappingPairIsReportedOnceByEveryKindWhileBodiesMove) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> jump(0, .02);
  for (const GridKind& kind : grid_kinds())
    for (const int k : {2, 3})
      for (const double ratio : {1., 5., 20., 100.})
        for (const double skin : {0., .2}) {
          Particles particles = crowd(200, .02, ratio, random);
          const auto source = make_pair_source({kind.name, k, skin}, {}, particles);
          for (int step = 0; step < 20; ++step) {
            SCOPED_TRACE(std::string(kind.name) + " k=" + std::to_string(k) + " ratio " + std::to_string(ratio) +
                         " skin " + std::to_string(skin) + " step " + std::to_string(step));
            source->update(particles, one_thread());
            check_pairs(*source, particles);
            if (HasFatalFailure()) return;
            for (int i = 0; i < particles.size(); ++i)
              if (!particles.fixed(i) && i % 3 == step % 3 && step % 4 != 0)
                particles.position[i] += Vector3d(jump(random), jump(random), jump(random));
          }
        }
}

TEST(Grid, ManyCoarseBodiesGiveTheSamePairsOnEveryTeam) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> jump(0, .02);
  for (const std::string runtime : {"openmp", "tbb"})
    for (const std::string name : {"regular", "adaptive"}) {
      Particles particles = crowd(1200, .02, 5, random);
      Grid alone(kind(name), 3, {}, particles), shared(kind(name), 3, {}, particles);
      Team team(row_named(runtimes(), "runtime", runtime), 3);
      for (int step = 0; step < 4; ++step) {
        SCOPED_TRACE(runtime + " " + name + " step " + std::to_string(step));
        alone.update(particles, one_thread());
        shared.update(particles, team);
        check_pairs(alone, particles);
        if (HasFatalFailure()) return;
        EXPECT_TRUE(std::ranges::equal(pairs_in_order(alone, particles), pairs_in_order(shared, particles),
                                       [](BodyPair l, BodyPair r) { return l.a == r.a && l.b == r.b; }));
        for (int i = 0; i < particles.size(); ++i)
          if (!particles.fixed(i)) particles.position[i] += Vector3d(jump(random), jump(random), jump(random));
      }
    }
}

TEST(Grid, NoneComparesAllPairs) {
  std::mt19937_64 random(3);
  const Particles particles = crowd(60, .02, 1, random);
  Grid grid(kind("none"), 3, {}, particles);
  grid.update(particles, one_thread());
  int moving_pairs = 0;
  for (int a = 0; a < particles.size(); ++a)
    for (int b = a + 1; b < particles.size(); ++b) moving_pairs += !(particles.fixed(a) && particles.fixed(b));
  EXPECT_EQ(static_cast<int>(pairs_of(grid, particles).size()), moving_pairs);
  EXPECT_EQ(grid.levels(), 1);
}

TEST(Grid, RegularGoesDownToTheSmallestBody) {
  Particles particles;
  for (const double r : {.3, .0045}) {
    Body ball;
    ball.sphere_radius = r;
    ball.position = Vector3d::Constant(.5);
    particles.add(ball);
  }
  const Grid grid(kind("regular"), 3, {}, particles); // diameter .009: cells of 1/81 = .0123, not of 1/243 = .0041
  EXPECT_EQ(grid.levels(), 5);
}

TEST(Grid, AFixedMeshAppearsOnlyAtVerticesNearItsTriangles) {
  Particles particles;
  Body wall;
  wall.mesh = std::make_shared<Mesh>(box({.8, .01, .8}));
  wall.position = Vector3d::Constant(.5);
  wall.fixed = true;
  particles.add(wall);
  for (int i = 0; i < 1000; ++i) {
    Body ball;
    ball.sphere_radius = .005;
    ball.position = Vector3d(.05 + .1 * (i % 10), .05 + .1 * (i / 10 % 10), .05 + .1 * (i / 100));
    particles.add(ball);
  }
  Grid grid(kind("regular"), 3, {}, particles);
  grid.update(particles, one_thread());
  const Pairs pairs = pairs_of(grid, particles);
  const auto with_wall = std::count_if(pairs.begin(), pairs.end(), [](const auto& p) { return p.first.first == 0; });
  EXPECT_EQ(with_wall, grid.virtual_copies());
  EXPECT_EQ(with_wall, 0) << "no ball is closer than .045 to the wall, and cells are .0123 wide";
  particles.position[450] = {.5, .512, .5};
  grid.update(particles, one_thread());
  EXPECT_TRUE(pairs_of(grid, particles).contains({0, 450}));
  EXPECT_EQ(grid.virtual_copies(), 1);
}

/// A coarse body ends just too far from the vertex of a fine one to leave a copy there, and the fine one is as near to
/// it as its vertex lets it: all that is between them is half of (cell - diameter).
TEST(Grid, ACoarseBodyAndAFineOneShareTheRoomBetweenThem) {
  constexpr double cell = 1. / 27, tiny = 1e-6;
  const Vector3d vertex = Vector3d(20, 14, 14) * cell;
  Particles particles;
  Body fine, coarse;
  fine.sphere_radius = .0065;
  fine.position = vertex - Vector3d(cell / 2 - tiny, 0, 0);
  coarse.sphere_radius = .1;
  coarse.position = vertex - Vector3d(cell + coarse.sphere_radius + tiny, 0, 0);
  particles.add(fine);
  particles.add(coarse);
  for (const char* name : {"regular", "adaptive"}) {
    Grid grid(kind(name), 3, {}, particles);
    grid.update(particles, one_thread());
    ASSERT_TRUE(pairs_of(grid, particles).empty()) << "a copy where the coarse body does not reach";
    EXPECT_GT(grid.room(0), 0);
    EXPECT_GT(grid.room(1), 0);
    check_pairs(grid, particles);
  }
}

/// Two balls a little more than the skin's reach apart come together, each by less than three skins.
TEST(Grid, PairsAreKeptUntilABodyHasMovedByTheSkin) {
  constexpr double diameter = .02, skin = .1 * diameter;
  Particles particles;
  for (const double x : {.5, .5 + diameter + 2.5 * skin}) {
    Body ball;
    ball.sphere_radius = diameter / 2;
    ball.position = {x, .5, .5};
    particles.add(ball);
  }
  for (const GridKind& kind : grid_kinds()) {
    Particles p = particles;
    const auto source = make_pair_source({kind.name, 3, .1}, {}, p);
    const auto searched = [&](double moved) {
      p.position[0].x() = particles.position[0].x() + moved;
      p.position[1].x() = particles.position[1].x() - moved;
      source->update(p, one_thread());
      StepStats stats;
      source->count(stats);
      return stats.searches;
    };
    EXPECT_EQ(searched(0), 1) << kind.name;
    EXPECT_EQ(searched(.99 * skin), 0) << kind.name;
    EXPECT_EQ(searched(1.3 * skin), 1) << kind.name;
    EXPECT_TRUE(pairs_of(*source, p).contains({0, 1})) << kind.name << ": they overlap";
  }
}

TEST(Grid, BodiesOutsideTheDomainStillMeet) {
  Particles particles;
  for (const double x : {5., 5.009, -3.}) {
    Body ball;
    ball.sphere_radius = .005;
    ball.position = {x, .5, .5};
    particles.add(ball);
  }
  Grid grid(kind("regular"), 3, {}, particles);
  grid.update(particles, one_thread());
  EXPECT_TRUE(pairs_of(grid, particles).contains({0, 1}));
}

} // namespace
} // namespace trigrain
