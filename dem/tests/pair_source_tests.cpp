#include "dem/grid_kind.hpp"
#include "dem/random.hpp"
#include "dem/simulation.hpp"
#include "hash_grid.hpp"
#include "one_thread.hpp"
#include <gtest/gtest.h>
#include <map>

namespace trigrain {
namespace {

using Pairs = std::map<std::pair<int, int>, int>; // pair -> how often it came

/// Pairs whose bounding spheres with halo overlap, as a source of candidates reports them.
Pairs near_pairs(PairSource& source, const Particles& p) {
  source.update(p, one_thread());
  std::vector<BodyPair> found;
  for (int e = 0; e < source.entries(); ++e) source.pairs_of(e, p, Sieve::none, found);
  Pairs pairs;
  for (const auto& [a, b] : found) {
    // What a fixed mesh's bounding sphere meets may still be far from its triangles: Grid knows, the hash does not.
    if ((p.fixed(a) && p.mesh[a]) || (p.fixed(b) && p.mesh[b])) continue;
    const double reach = p.radius[a] + p.radius[b] + p.halo[a] + p.halo[b];
    if ((p.position[a] - p.position[b]).norm() < reach) ++pairs[{a, b}];
  }
  return pairs;
}

/// Every grid kind and k against the hash grid on the same bodies while they move; `move` is called between turns.
template <class Move> void compare(const Domain& domain, const Particles& p, const char* what, const Move& move) {
  std::vector<std::unique_ptr<PairSource>> grids;
  for (const GridKind& kind : grid_kinds())
    for (const int k : {2, 3})
      if (!kind.visits_all) grids.push_back(make_pair_source({kind.name, k}, domain, p));
  HashGrid hash(p);
  std::size_t most = 0;
  for (int turn = 0; turn < 20; ++turn, move()) {
    const Pairs expected = near_pairs(hash, p);
    most = std::max(most, expected.size());
    for (const auto& [pair, count] : expected) ASSERT_EQ(count, 1) << "the hash grid reports a pair twice";
    for (std::size_t g = 0; g < grids.size(); ++g)
      ASSERT_EQ(near_pairs(*grids[g], p), expected) << what << " grid " << g << " turn " << turn;
  }
  EXPECT_GT(most, 20u) << what << ": too few pairs for a test";
}

TEST(PairSource, AHashGridFindsTheSamePairsOnceInAFlowingHopper) {
  const Scene scene = make_scene("hopper-dense", {.particles = 60, .vertices = 10});
  Simulation sim(scene, {.grid = "adaptive"});
  compare(scene.domain, sim.particles(), "hopper-dense", [&] {
    for (const double end = sim.time() + .01; sim.time() < end;) sim.step();
  });
}

TEST(PairSource, TheEngineTakesItsPairsFromAnySource) {
  Scene scene = make_scene("hopper-dense", {.particles = 60, .vertices = 10});
  for (Body& body : scene.bodies) body.halo = .01; // neighbours on the lattice touch
  const Particles bodies = Simulation(scene, {}).particles();
  for (const char* scheme : {"serial", "plain", "task"}) {
    const Options options{.scheme = scheme, .threads = std::string_view(scheme) == "serial" ? 1 : 2};
    Simulation grid(scene, options), hash(scene, options, std::make_unique<HashGrid>(bodies));
    const StepStats ours = grid.run(60), theirs = hash.run(60);
    EXPECT_GT(ours.contacts, 1000);
    EXPECT_EQ(ours.contacts, theirs.contacts);
    EXPECT_NE(ours.candidate_pairs, theirs.candidate_pairs) << "the source given was not asked";
    EXPECT_EQ(grid.state_hash(), hash.state_hash()) << scheme;
  }
}

TEST(PairSource, AHashGridFindsTheSamePairsOnceInCloudsOfManySizes) {
  for (const double ratio : {1., 5., 20., 100.})
    for (const double gravity : {0., -9.81}) {
      Random random(17);
      Particles p;
      for (int i = 0; i < 300; ++i) {
        Body ball;
        ball.sphere_radius = .04 / std::sqrt(ratio) * std::pow(ratio, random.uniform());
        ball.halo = .05 * ball.sphere_radius;
        ball.position = {random.uniform(), random.uniform(), random.uniform()};
        ball.velocity = 4 * random.direction();
        p.add(ball);
      }
      compare({}, p, "cloud", [&] {
        for (int i = 0; i < p.size(); ++i) {
          p.velocity[i].y() += .01 * gravity;
          p.position[i] += .01 * p.velocity[i]; // many leave the domain
        }
      });
    }
}

} // namespace
} // namespace trigrain
