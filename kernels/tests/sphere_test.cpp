#include "kernels/precheck.hpp"
#include "kernels/sphere.hpp"
#include "pairs.hpp"
#include <cmath>
#include <gtest/gtest.h>

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
        const Octree octree(corners_of(triangles), triangles.view());
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

} // namespace trigrain
