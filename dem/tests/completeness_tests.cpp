#include "dem/random.hpp"
#include "dem/simulation.hpp"
#include "kernels/name_table.hpp"
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

/// Sorted pairs that a grid reports; a pair that comes twice is there twice.
std::vector<Pair> reported(const Grid& grid, const Particles& p) {
  std::vector<BodyPair> found;
  for (int e = 0; e < grid.entries(); ++e) grid.pairs_of(e, p, found);
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

/// Every kind and k beside `none`: the same contacts to the last bit in every step, every overlapping pair reported,
/// and none twice.
void run_beside_none(double ratio, double gravity) {
  const Scene scene = crowd(ratio, gravity);
  Simulation none(scene, {.grid = "none"});
  std::vector<Simulation> others;
  std::vector<Grid> grids;
  for (const GridKind& kind : grid_kinds())
    for (const int k : {2, 3}) {
      others.emplace_back(scene, Options{.grid = std::string(kind.name), .subdivision = k});
      grids.emplace_back(kind, k, scene.domain, none.particles());
    }
  std::size_t overlaps = 0, contacts = 0;
  for (int step = 0; step < steps; ++step) {
    const Particles before = none.particles();
    none.step();
    contacts += none.contacts().size();
    const std::vector<Pair> needed = overlapping(before, none.contacts());
    overlaps += needed.size();
    for (std::size_t g = 0; g < grids.size(); ++g) {
      const std::string what = std::string(grids[g].tree().kind().name) + " k=" + std::to_string(2 + g % 2) + " step " +
                               std::to_string(step);
      grids[g].update(before);
      const std::vector<Pair> pairs = reported(grids[g], before);
      ASSERT_TRUE(std::adjacent_find(pairs.begin(), pairs.end()) == pairs.end()) << "a pair comes twice: " << what;
      ASSERT_TRUE(std::includes(pairs.begin(), pairs.end(), needed.begin(), needed.end()))
          << "a pair is lost: " << what;
      others[g].step();
      ASSERT_TRUE(same(others[g].contacts(), none.contacts())) << "contacts differ: " << what;
    }
  }
  EXPECT_GT(none.particles().position.back().x(), 1) << "no body left the domain";
  EXPECT_GT(overlaps, 1000u) << "too few for a test";
  EXPECT_GT(contacts, 300u) << "too few for a test";
  for (Simulation& other : others) EXPECT_EQ(other.state_hash(), none.state_hash());
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
