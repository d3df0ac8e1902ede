#include "dem/kept_pairs.hpp"
#include "dem/random.hpp"
#include "dem/simulation.hpp"
#include <cmath>
#include <gtest/gtest.h>

namespace trigrain {
namespace {

using Eigen::Vector3d;

/// Steps of two simulations of a scene, one that searches in every step and one that keeps what is near.
struct Twins {
  Simulation searching, keeping;
  StepStats found, kept;
  Twins(const Scene& scene, const std::string& rule)
      : searching(scene, {.contact_rule = rule, .triangle_search = "every-step"}),
        keeping(scene, {.contact_rule = rule, .triangle_search = "when-needed"}) {}
  bool step() {
    found += searching.step();
    kept += keeping.step();
    return searching.state_hash() == keeping.state_hash();
  }
};

void same_contacts(const Simulation& one, const Simulation& other) {
  const auto &c = one.contacts(), &d = other.contacts();
  ASSERT_EQ(c.size(), d.size());
  for (std::size_t i = 0; i < c.size(); ++i) {
    EXPECT_EQ(std::pair(c[i].feature_a, c[i].feature_b), std::pair(d[i].feature_a, d[i].feature_b));
    EXPECT_EQ(c[i].force, d[i].force);
  }
}

TEST(KeptPairs, ChangeNoBitOfAnyStep) {
  const Scene scene = make_scene("hopper-dense", {.particles = 60, .vertices = 12, .halo = "published"});
  for (const char* rule : {"features", "nearest", "dedupe", "all-pairs"}) {
    Twins twins(scene, rule);
    for (int step = 0; step < 3000; ++step) ASSERT_TRUE(twins.step()) << rule << ", step " << step;
    same_contacts(twins.searching, twins.keeping);
    EXPECT_EQ(twins.found.contacts, twins.kept.contacts);
    EXPECT_GT(twins.found.contacts, 4000) << "the test needs contacts";
    EXPECT_EQ(twins.found.searched_pairs, twins.found.body_pairs);
    EXPECT_LT(twins.kept.searched_pairs, .8 * twins.kept.body_pairs) << rule;
  }
}

TEST(KeptPairs, OfSpheresChangeNoBitOfAnyStep) {
  Scene scene = make_scene("hopper-dense", {.particles = 60, .vertices = 12, .halo = "published"});
  for (std::size_t i = 0; i < scene.bodies.size(); i += 2) {
    Body& body = scene.bodies[i];
    if (body.fixed) continue;
    body.sphere_radius = body.mesh->radius;
    body.mesh = nullptr;
  }
  for (const char* rule : {"features", "nearest", "dedupe", "all-pairs"}) {
    Twins twins(scene, rule);
    std::int64_t of_spheres = 0;
    for (int step = 0; step < 3000; ++step) {
      ASSERT_TRUE(twins.step()) << rule << ", step " << step;
      const Particles& p = twins.keeping.particles();
      for (const Contact& c : twins.keeping.contacts()) of_spheres += p.is_sphere(c.a) != p.is_sphere(c.b);
    }
    same_contacts(twins.searching, twins.keeping);
    EXPECT_GT(of_spheres, 2000) << "the test needs contacts of spheres with meshes";
    EXPECT_LT(twins.kept.searched_pairs, .8 * twins.found.searched_pairs) << rule;
  }
}

/// Body 1, ten times smaller than the plate that is body 0, flies at it with a spin that sweeps its corners along.
Scene shot(double speed, double spin) {
  Scene scene;
  scene.name = "shot";
  scene.domain = {{-2, -2, -2}, 4};
  scene.contact = {.stiffness = 1e5, .damping_ratio = .1, .friction = .3};
  scene.time.step = 1e-5;
  scene.time.force = true;
  scene.bodies.resize(2);
  scene.bodies[0].mesh = std::make_shared<const Mesh>(box({1, .1, 1}));
  scene.bodies[0].fixed = true;
  scene.bodies[1].mesh = std::make_shared<const Mesh>(box({.1, .1, .1}));
  scene.bodies[1].position = {.1, .2, .05};
  scene.bodies[1].velocity = {0, -speed, 0};
  scene.bodies[1].angular_velocity = {spin, spin / 3, -spin / 2};
  for (Body& body : scene.bodies) body.halo = .01;
  return scene;
}

TEST(KeptPairs, SeeWhateverASearchInEveryStepSees) {
  // Hard ones bounce; soft ones, and fast ones, dig into the plate until surfaces cross.
  for (const auto& [speed, spin, stiffness, crosses] :
       {std::tuple(2., 40., 1e5, false), {5., 300., 1e5, false}, {2., 40., 10., true}, {150., 2000., 1e5, true}}) {
    Scene scene = shot(speed, spin);
    scene.contact.stiffness = stiffness;
    Twins twins(scene, "features");
    for (int step = 0; step < 12000 && twins.searching.time() * speed < .2; ++step)
      ASSERT_TRUE(twins.step()) << speed << ", step " << step;
    EXPECT_EQ(twins.found.crossings > 0, crosses) << speed;
    EXPECT_EQ(twins.found.crossings, twins.kept.crossings) << speed;
    EXPECT_GT(twins.found.contacts, 0);
    EXPECT_EQ(twins.found.contacts, twins.kept.contacts);
  }
}

TEST(KeptPairs, AreSearchedAgainBeforeAnyPointHasMovedByTheirRoom) {
  Random random(7);
  const auto number = [&](double size) { return size * (2 * random.uniform() - 1); };
  Scene scene = shot(0, 0);
  int complete = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    Particles p;
    for (Body& body : scene.bodies) {
      body.position = {number(1), number(1), number(1)};
      body.orientation = Eigen::Quaterniond(1, number(1), number(1), number(1)).normalized();
      p.add(body);
    }
    const RelativePose first = relative_pose(p, {0, 1});
    KeptPair kept;
    kept.keep(first, .05);
    const double far = std::pow(10., number(1) - 1.5);
    for (int i = 0; i < 2; ++i) {
      p.position[i] += far * Vector3d(number(.1), number(.1), number(.1));
      const Eigen::Quaterniond turn(1, far * number(1), far * number(1), far * number(1));
      p.orientation[i] = (turn * p.orientation[i]).normalized();
    }
    const RelativePose now = relative_pose(p, {0, 1});
    if (!kept.is_complete(now, p.radius[1])) continue;
    ++complete;
    for (const Vector3d& x : p.mesh[1]->vertices)
      ASSERT_LE((now.turn * x + now.centre - first.turn * x - first.centre).norm(), .05);
  }
  EXPECT_GT(complete, 1000) << "the test needs small moves too";
  EXPECT_LT(complete, 19000);
}

TEST(KeptPairs, BelongToTheirBodiesAndTakeOverPlacesOfThoseThatAreGone) {
  Scene scene = shot(0, 0);
  scene.bodies.push_back(scene.bodies[1]);
  scene.bodies.push_back(scene.bodies[1]);
  Particles p;
  for (const Body& body : scene.bodies) p.add(body);
  PairMemory<KeptPair> pairs(p.size());
  pairs.begin_step();
  KeptPair &one = pairs.of({0, 1}, p), &two = pairs.of({1, 2}, p);
  one.keep(relative_pose(p, {0, 1}), 1);
  EXPECT_NE(&one, &two);
  pairs.begin_step();
  EXPECT_EQ(&pairs.of({0, 1}, p), &one);
  EXPECT_TRUE(one.is_complete(relative_pose(p, {0, 1}), p.radius[1]));
  for (int step = 0; step < 3; ++step) pairs.begin_step();
  KeptPair& taken = pairs.of({0, 2}, p); // of body 2, as {1, 2} was
  EXPECT_EQ(&taken, &two);
  EXPECT_FALSE(taken.is_complete(relative_pose(p, {0, 2}), p.radius[2]));
}

} // namespace
} // namespace trigrain
