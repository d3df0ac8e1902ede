#include "dem/narrow_phase.hpp"
#include "dem/simulation.hpp"
#include "kernels/name_table.hpp"
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <set>
#include <tuple>

namespace trigrain {
namespace {

using Eigen::Vector3d;

WorkerBuffer contacts_of(const Particles& particles, std::string_view kernel, std::string_view precheck,
                         std::string_view rule) {
  const NarrowPhase narrow{&kernel_named(kernel), &row_named(prechecks(), "pre-check", precheck),
                           &row_named(contact_rules(), "contact rule", rule)};
  WorkerBuffer buffer;
  if (!narrow.precheck->spheres || spheres_overlap(particles, {0, 1}))
    collide(particles, std::array{BodyPair{0, 1}}, narrow, buffer);
  for (const FoundPair& found : buffer.found)
    if (found.first == FoundPair::of_spheres)
      touch_of_spheres(particles, {found.a, found.b}, buffer.contacts.emplace_back());
  return buffer;
}

Body ball(double radius, const Vector3d& position, double halo) {
  return {.sphere_radius = radius, .position = position, .halo = halo};
}

Body cube(const Vector3d& position, double halo) {
  return {.mesh = std::make_shared<Mesh>(box({1, 1, 1})), .position = position, .halo = halo};
}

TEST(Contact, SpheresCloserThanTheirHalosTouchNearTheLighterOne) {
  Particles p;
  p.add(ball(.5, {0, 0, 0}, .1));
  p.add(ball(.25, {0, .9, 0}, .1));
  const auto found = contacts_of(p, "brute", "sphere", "nearest").contacts;
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].overlap, .05, 1e-15);
  EXPECT_TRUE(found[0].normal.isApprox(Vector3d(0, -1, 0), 1e-15));
  EXPECT_TRUE(found[0].point.isApprox(Vector3d(0, .5 + .15 * 8 / 9, 0), 1e-14));
}

TEST(Contact, SpheresFartherThanTheirHalosDoNotTouch) {
  Particles p;
  p.add(ball(.5, {0, 0, 0}, .05));
  p.add(ball(.25, {0, .9, 0}, .05));
  EXPECT_TRUE(contacts_of(p, "brute", "none", "all-pairs").contacts.empty());
}

TEST(Contact, ASphereAboveACubeTouchesItsFaceWhicheverComesFirst) {
  for (const bool sphere_first : {true, false}) {
    Particles p;
    if (sphere_first) p.add(ball(.5, {.1, 1.05, .2}, .05));
    p.add(cube({0, 0, 0}, .05));
    if (!sphere_first) p.add(ball(.5, {.1, 1.05, .2}, .05));
    for (const char* precheck : {"none", "sphere", "box", "octree"}) {
      const auto found = contacts_of(p, "brute", precheck, "nearest").contacts;
      ASSERT_EQ(found.size(), 1u);
      EXPECT_NEAR(found[0].overlap, .05, 1e-14);
      EXPECT_TRUE(found[0].normal.isApprox(Vector3d(0, sphere_first ? 1 : -1, 0), 1e-12));
      const double ball_mass = std::numbers::pi / 6; // of a cube's
      EXPECT_TRUE(found[0].point.isApprox(Vector3d(.1, .5 + .05 / (1 + ball_mass), .2), 1e-12));
    }
  }
}

TEST(Contact, ASphereTouchesEachPieceOfAMeshOnceAndCrossesSome) {
  const Mesh below = box({1, 1, 1});
  std::vector<Vector3d> corners;
  std::vector<std::array<int, 3>> faces;
  for (const double y : {-.5, 1.53}) { // tops and bottoms are .02 and .01 away from a ball of .5
    const int first = static_cast<int>(corners.size());
    for (const Vector3d& x : below.vertices) corners.push_back(x + Vector3d(0, y, 0));
    for (const auto& f : below.faces) faces.push_back({f[0] + first, f[1] + first, f[2] + first});
  }
  Particles p;
  p.add({.mesh = std::make_shared<Mesh>(make_mesh("two boxes", corners, faces)), .halo = .05, .fixed = true});
  p.add(ball(.5, {0, .52, 0}, .05)); // over the diagonals of both faces
  for (const char* rule : {"nearest", "features"}) {
    const auto found = contacts_of(p, "brute", "box", rule).contacts;
    ASSERT_EQ(found.size(), 2u) << rule;
    for (int piece = 0; piece < 2; ++piece) {
      EXPECT_EQ(std::pair(found[piece].feature_a, found[piece].feature_b), std::pair(piece, 0));
      EXPECT_NEAR(found[piece].overlap, piece == 0 ? .08 : .09, 1e-14);
      EXPECT_TRUE(found[piece].normal.isApprox(Vector3d(0, piece == 0 ? -1 : 1, 0), 1e-12));
      EXPECT_TRUE(found[piece].push.isApprox(found[piece].overlap * found[piece].normal, 1e-12));
    }
  }
  p.position[1].y() = .54; // .01 deep in the upper one
  const WorkerBuffer crossed = contacts_of(p, "brute", "box", "nearest");
  EXPECT_EQ(crossed.crossings, 2) << "of two triangles";
  ASSERT_EQ(crossed.contacts.size(), 1u);
  EXPECT_EQ(crossed.contacts[0].feature_a, 0);
}

TEST(Contact, CrossingBodiesAreCountedAndGiveNoForce) {
  Particles p;
  p.add(cube({0, 0, 0}, .01));
  p.add(cube({.4, .3, .2}, .01));
  const WorkerBuffer found = contacts_of(p, "brute", "sphere", "all-pairs");
  EXPECT_GT(found.crossings, 0);
  for (const Touch& c : found.contacts) EXPECT_TRUE(c.normal.allFinite());
}

TEST(Contact, NearestKeepsOneContactPerPairOfPieces) {
  Particles p;
  p.add(cube({0, 0, 0}, .01));
  p.add(cube({.1, 1.015, .2}, .01)); // face on face
  const auto all = contacts_of(p, "brute", "sphere", "all-pairs").contacts;
  const auto nearest = contacts_of(p, "brute", "sphere", "nearest").contacts;
  EXPECT_GT(all.size(), 3u);
  ASSERT_EQ(nearest.size(), 1u);
  EXPECT_NEAR(nearest[0].overlap, .005, 1e-14);
}

/// (a, b, feature_a, feature_b, overlap) of each contact.
using ContactSet = std::set<std::tuple<int, int, double>>;

ContactSet set_of(const std::vector<Touch>& contacts) {
  ContactSet set;
  for (const Touch& c : contacts) set.insert({c.feature_a, c.feature_b, c.overlap});
  return set;
}

TEST(Contact, PrechecksLeaveTheContactSetAsItIs) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::size_t touching = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    Particles p;
    for (int i = 0; i < 2; ++i) {
      Body grain;
      // every tenth of many faces: more come near the other body than a pack holds
      grain.mesh = std::make_shared<Mesh>(granulate(1, trial % 10 == 0 ? 80 : 12, 1000 + 2 * trial + i));
      grain.orientation = Eigen::Quaterniond(unit(random), unit(random), unit(random), unit(random)).normalized();
      grain.halo = .05;
      if (i == 1)
        grain.position = Vector3d(unit(random), unit(random), unit(random)).normalized() * (.9 + .2 * unit(random));
      p.add(grain);
    }
    for (const char* kernel : {"brute", "brute-simd", "hybrid-pair"}) {
      const auto without = contacts_of(p, kernel, "none", "all-pairs");
      for (const Precheck& precheck : prechecks()) {
        const auto with = contacts_of(p, kernel, precheck.name, "all-pairs");
        ASSERT_EQ(set_of(without.contacts), set_of(with.contacts)) << kernel << ' ' << precheck.name << ' ' << trial;
        ASSERT_LE(with.kernel.triangle_pairs, without.kernel.triangle_pairs);
      }
      touching += !without.contacts.empty();
    }
  }
  EXPECT_GT(touching, 500u);
}

TEST(Contact, FarFromTheOriginTheOverlapKeepsItsDigits) {
  for (const double far : {0., 1e4}) {
    Particles p;
    p.add(cube(Vector3d(far, 0, 0), .01));
    p.add(cube(Vector3d(far, 1.0175, 0), .01));
    const auto found = contacts_of(p, "brute", "sphere", "nearest").contacts;
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].overlap, .0025, 1e-15);
  }
}

} // namespace
} // namespace trigrain
