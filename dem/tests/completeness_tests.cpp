#include "dem/grid_kind.hpp"
#include "dem/random.hpp"
#include "dem/simulation.hpp"
#include "kernels/name_table.hpp"
#include "one_thread.hpp"
#include <algorithm>
#include <gtest/gtest.h>

namespace trigrain {
namespace {

using Eigen::Vector3d;

constexpr int corner_bodies = 4, steps = 1000;

/// Hopper and floor, and spheres of diameters 1:ratio with halos of 5 %: at random places, on corners of cells, and
/// some that fly out of the domain. All have one mass, so that small ones do not need smaller steps.
Scene crowd(double ratio, double gravity) {
  Scene scene = make_scene("hopper", {.particles = 1, .vertices = 0});
  scene.gravity = {0, gravity, 0};
  scene.bodies.pop_back();
  Random random(17);
  for (int i = 0; i < 36; ++i) {
    Body& ball = scene.bodies.emplace_back();
    ball.sphere_radius = .05 * std::pow(ratio, -(i % 5) / 4.);
    ball.halo = .05 * ball.sphere_radius;
    ball.density = 1e-4 / std::pow(ball.sphere_radius, 3);
    ball.position = Vector3d(.5, .55, .5) + .25 * random.uniform() * random.direction();
    if (i < corner_bodies) ball.position = (ball.position * 27).array().round() / 27;
    ball.velocity = std::pow(10, 2 * random.uniform() - 1) * random.direction(); // .1 to 10 m/s
  }
  scene.bodies.back().velocity = {30, 0, 0};
  scene.contact.stiffness = 100;
  scene.time.step = 1e-4;
  return scene;
}

using Pair = std::pair<int, int>;

/// Sorted pairs that a source reports; a pair that comes twice is there twice.
std::vector<Pair> reported(const PairSource& source, Sieve sieve, const Particles& p) {
  std::vector<BodyPair> found;
  for (int e = 0; e < source.entries(); ++e) source.pairs_of(e, p, sieve, found);
  std::vector<Pair> pairs;
  for (const BodyPair pair : found) pairs.emplace_back(pair.a, pair.b);
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

/// Sorted pairs of bodies whose halos overlap; with the walls by their contacts.
std::vector<Pair> overlapping(const Particles& p, const std::vector<Contact>& contacts) {
  std::vector<Pair> pairs;
  for (int a = 0; a < p.size(); ++a)
    for (int b = a + 1; b < p.size() && !p.fixed(a); ++b)
      if ((p.position[a] - p.position[b]).norm() < p.radius[a] + p.radius[b] + p.halo[a] + p.halo[b])
        pairs.emplace_back(a, b);
  for (const Contact& c : contacts)
    if (p.fixed(c.a) || p.fixed(c.b)) pairs.emplace_back(c.a, c.b);
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

bool same(const std::vector<Contact>& l, const std::vector<Contact>& r) {
  return std::equal(l.begin(), l.end(), r.begin(), r.end(), [](const Contact& x, const Contact& y) {
    return x.a == y.a && x.b == y.b && x.feature_a == y.feature_a && x.feature_b == y.feature_b && x.point == y.point &&
           x.normal == y.normal && x.overlap == y.overlap;
  });
}

/// One way to get pairs: a simulation that runs with it, and a source for itself.
struct Variant {
  std::string what;
  Simulation sim;
  std::unique_ptr<PairSource> source;
};

/// Every kind with every k, searched in every step and with a skin.
std::vector<Variant> variants(const Scene& scene, double ratio) {
  std::vector<Variant> all;
  for (const GridKind& kind : grid_kinds())
    for (const int k : {2, 3})
      for (const double skin : {0., .2}) {
        if (kind.visits_all && ratio > 1) continue; // stores, and visits, very many vertices
        if (skin > 0 && k != 3) continue;           // what it adds does not depend on k
        const std::string grid(kind.name);
        Simulation sim(scene, {.grid = grid, .subdivision = k, .skin = skin});
        auto source = make_pair_source({grid, k, skin}, scene.domain, sim.particles());
        all.push_back(
            {grid + " k=" + std::to_string(k) + " skin " + std::to_string(skin), std::move(sim), std::move(source)});
      }
  return all;
}

void compare(const Variant& v, const Particles& before, const std::vector<Pair>& needed) {
  v.source->update(before, one_thread());
  for (const Sieve sieve : {Sieve::none, Sieve::spheres}) {
    const std::vector<Pair> pairs = reported(*v.source, sieve, before);
    ASSERT_TRUE(std::adjacent_find(pairs.begin(), pairs.end()) == pairs.end()) << "a pair comes twice";
    ASSERT_TRUE(std::includes(pairs.begin(), pairs.end(), needed.begin(), needed.end())) << "a pair is lost";
  }
}

/// All beside `none`: the same contacts to the last bit in every step, every overlapping pair reported, none twice.
void run_beside_none(double ratio, double gravity) {
  const Scene scene = crowd(ratio, gravity);
  Simulation none(scene, {.grid = "none"});
  std::vector<Variant> all = variants(scene, ratio);
  std::size_t overlaps = 0, contacts = 0;
  for (int step = 0; step < steps; ++step) {
    const Particles before = none.particles();
    none.step();
    contacts += none.contacts().size();
    const std::vector<Pair> needed = overlapping(before, none.contacts());
    overlaps += needed.size();
    for (Variant& v : all) {
      SCOPED_TRACE(v.what + " step " + std::to_string(step));
      compare(v, before, needed);
      v.sim.step();
      ASSERT_TRUE(same(v.sim.contacts(), none.contacts())) << "contacts differ";
      if (testing::Test::HasFatalFailure()) return;
    }
  }
  EXPECT_GT(none.particles().position.back().x(), 1) << "no body left the domain";
  EXPECT_GT(overlaps, 1000u) << "too few for a test";
  EXPECT_GT(contacts, 300u) << "too few for a test";
  for (const Variant& v : all) EXPECT_EQ(v.sim.state_hash(), none.state_hash()) << v.what;
}

TEST(Completeness, EveryKindFindsTheContactsOfNoneOverAThousandSteps) {
  for (const double ratio : {1., 5., 20., 100.})
    for (const double gravity : {0., -9.81}) {
      SCOPED_TRACE("ratio " + std::to_string(ratio) + " gravity " + std::to_string(gravity));
      run_beside_none(ratio, gravity);
      if (HasFatalFailure()) return;
    }
}

} // namespace
} // namespace trigrain
