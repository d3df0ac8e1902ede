#include "kernels/precheck.hpp"
#include "kernels/sphere.hpp"
#include "pairs.hpp"
#include <cmath>
#include <gtest/gtest.h>
#include <set>

namespace trigrain {

TEST(Spheres, TouchingSpheresHaveGapZero) {
  const SphereClosest c = closest_points({{0, 0, 0}, 1}, {{0, 3, 0}, 2});
  EXPECT_EQ(c.gap, 0);
  EXPECT_EQ(c.p.y, 1);
  EXPECT_EQ(c.q.y, 1);
}

TEST(Spheres, OverlapIsANegativeGapAndConcentricSpheresStayFinite) {
  EXPECT_DOUBLE_EQ(closest_points({{0, 0, 0}, 1}, {{1.5, 0, 0}, 1}).gap, -.5);
  const SphereClosest c = closest_points({{1, 1, 1}, 1}, {{1, 1, 1}, 2});
  EXPECT_EQ(c.gap, -3);
  EXPECT_TRUE(std::isfinite(c.p.x) && std::isfinite(c.q.z));
}

TEST(Spheres, PointTriangleMeetsExactNumbers) {
  for (const RandomFamily& family : random_families())
    for (int k = 0; k < 2000; ++k) {
      const Pair pair = random_pair(family, k);
      const Vec3<double> from = pair.b.a0;
      const PointOnTriangle c = closest_point(from, pair.a);
      const double truth = static_cast<double>(oracle::distance(from, pair.a));
      const double off = distance_from(c.point, pair.a, 1e-14 * scale(pair));
      ASSERT_NEAR(std::sqrt(c.distance2), truth, 1e-14 * scale(pair)) << "case " << k << ": " << pair;
      ASSERT_LE(off, 1e-14 * scale(pair)) << "case " << k << ": " << pair;
    }
}

TEST(Spheres, ManyTrianglesAtOnceMeetExactNumbersWhereverTheyStand) {
  for (const RandomFamily& family : random_families()) {
    Triangles triangles;
    std::vector<Triangle> each;
    std::vector<double> sizes;
    for (int k = 0; k < 1003; ++k) { // not a multiple of any pack
      const Pair pair = random_pair(family, k);
      const Vec3<double> from = pair.b.a0;
      each.push_back({pair.a.a0 - from, pair.a.a1 - from, pair.a.a2 - from});
      sizes.push_back(scale(Pair{.a = each.back(), .b = each.back()}));
      triangles.push_back(each.back());
    }
    std::vector<PointOnTriangle> points;
    closest_to_origin(triangles.view(), points);
    ASSERT_EQ(points.size(), each.size());
    for (std::size_t k = 0; k < each.size(); ++k) {
      const double truth = static_cast<double>(oracle::distance(Vec3<double>{0, 0, 0}, each[k]));
      ASSERT_NEAR(std::sqrt(points[k].distance2), truth, 1e-14 * sizes[k]) << family.name << ", case " << k;
      ASSERT_LE(distance_from(points[k].point, each[k], 1e-14 * sizes[k]), 1e-14 * sizes[k])
          << family.name << ", " << k;
      Triangles alone;
      alone.push_back(each[k]);
      std::vector<PointOnTriangle> point;
      closest_to_origin(alone.view(), point);
      ASSERT_EQ(point[0].distance2, points[k].distance2) << family.name << ", case " << k;
    }
  }
}

namespace {

std::vector<Vec3<double>> corners_of(const Triangles& triangles) {
  std::vector<Vec3<double>> corners;
  for (int k = 0; k < triangles.size(); ++k)
    for (const Vec3<double>& x : {triangles.view()[k].a0, triangles.view()[k].a1, triangles.view()[k].a2})
      corners.push_back(x);
  return corners;
}

} // namespace

// For every family of triangle, slivers and degenerate ones too, with the reach put right at one of the distances.
TEST(TrianglesNearPoint, MissesNoneAndTakesNoneBeyondItsSlack) {
  for (const RandomFamily& family : random_families())
    for (int first = 0; first < 600; first += 35) {
      const int size = 1 + first % 36;
      Triangles triangles;
      std::vector<double> distances;
      double extent = 0; // of all coordinates, seen from the centre
      std::mt19937_64 random(first);
      const Vec3<double> centre = family.make(random).a.a1;
      for (int k = 0; k < size; ++k) {
        std::mt19937_64 seed(first + k);
        const Triangle t = family.make(seed).b;
        triangles.push_back(t);
        for (const Vec3<double>& x : {t.a0 - centre, t.a1 - centre, t.a2 - centre})
          extent = std::max({extent, std::fabs(x.x), std::fabs(x.y), std::fabs(x.z)});
        distances.push_back(static_cast<double>(oracle::distance(centre, t)));
      }
      for (const double reach : {0., distances[0], distances[size / 2], 0.7, everywhere}) {
        std::vector<int> found{-7}; // is replaced
        triangles_near_point(triangles.view(), centre, reach, found);
        EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
        for (int k = 0; k < size; ++k) {
          const bool taken = std::binary_search(found.begin(), found.end(), k);
          if (distances[k] <= reach) {
            ASSERT_TRUE(taken) << family.name << ", first " << first << ", triangle " << k;
          }
          if (distances[k] > reach + 32 * 0x1p-52 * extent) {
            ASSERT_FALSE(taken) << family.name << ", first " << first << ", triangle " << k;
          }
        }
        EXPECT_TRUE(found.empty() || (found.front() >= 0 && found.back() < size));
        const Octree octree(corners_of(triangles), triangles.view(), first % 2 == 0 ? Cuts::adaptive : Cuts::regular);
        for (const Precheck& precheck : prechecks()) {
          std::vector<int> near{-7};
          precheck.triangles({triangles.view(), &octree}, centre, reach, near);
          EXPECT_TRUE(std::is_sorted(near.begin(), near.end()));
          for (int k = 0; k < size; ++k)
            if (distances[k] <= reach) {
              ASSERT_TRUE(std::binary_search(near.begin(), near.end(), k))
                  << precheck.name << ", " << family.name << ", first " << first << ", triangle " << k;
            }
        }
      }
    }
}

namespace {

/// Depths of the leaves below a cut, and how many triangles they hold.
void walk(const Octree& octree, int number, int depth, std::set<int>& depths, int& triangles) {
  const Cut& cut = octree.cut(number);
  if (cut.leaf) depths.insert(depth);
  for (int k = 0; k < 8; ++k) {
    if (cut.boxes.low[0][k] > cut.boxes.high[0][k]) continue; // empty
    if (cut.leaf)
      ++triangles;
    else
      walk(octree, cut.entry[k], depth + 1, depths, triangles);
  }
}

} // namespace

TEST(Octree, RegularCutsEndAtOneDepthAndAdaptiveOnesWhereTheyMay) {
  Triangles triangles; // many in one corner, few elsewhere
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> share(0, 1);
  for (int k = 0; k < 500; ++k) {
    const double size = k % 2 == 0 ? 1 : .01, x = size * share(random), y = size * share(random),
                 z = size * share(random);
    triangles.push_back({{x, y, z}, {x + .001, y, z}, {x, y + .001, z}});
  }
  std::set<int> adaptive, regular;
  int in_adaptive = 0, in_regular = 0;
  walk(Octree(corners_of(triangles), triangles.view()), 0, 0, adaptive, in_adaptive);
  walk(Octree(corners_of(triangles), triangles.view(), Cuts::regular), 0, 0, regular, in_regular);
  EXPECT_GT(adaptive.size(), 1u);
  EXPECT_EQ(regular.size(), 1u);
  EXPECT_EQ(*regular.begin(), *adaptive.rbegin());
  EXPECT_EQ(in_adaptive, 500);
  EXPECT_EQ(in_regular, 500);
}

} // namespace trigrain
