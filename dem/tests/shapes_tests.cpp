#include "dem/mesh.hpp"
#include "dem/random.hpp"
#include "kernels/name_table.hpp"
#include <cmath>
#include <gtest/gtest.h>
#include <malloc.h>
#include <numbers>
#include <set>

using namespace trigrain;
using Eigen::Vector3d;

namespace {

constexpr double pi = std::numbers::pi;

/// The mesh with its vertices as the shape has them: origin and axes undone.
Mesh in_shape_frame(Mesh m) {
  for (Vector3d& v : m.vertices) v = m.in_shape_frame(v);
  return m;
}

/// Does the ray x + s d, s > 0, meet the mesh? By signed volumes; grazing rays have probability 0.
bool ray_meets(const Mesh& m, const Vector3d& x, const Vector3d& d) {
  for (const auto& f : m.faces) {
    const Vector3d a = m.vertices[f[0]] - x, b = m.vertices[f[1]] - x, c = m.vertices[f[2]] - x;
    const double u = d.dot(b.cross(c)), v = d.dot(c.cross(a)), w = d.dot(a.cross(b));
    const bool same_sign = (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
    if (same_sign && a.dot((b - a).cross(c - a)) / (u + v + w) > 0) return true;
  }
  return false;
}

} // namespace

TEST(Box, HasClosedFormsAndExactCorners) {
  for (const int n : {1, 2, 3, 16}) {
    const Mesh m = box({.1, .2, .3}, n);
    EXPECT_EQ(m.faces.size(), 12u * n * n);
    EXPECT_EQ(m.vertices.size(), 6u * n * n + 2);
    EXPECT_NEAR(m.volume, .006, 1e-15);
    EXPECT_NEAR(m.inertia.x(), .006 * (.04 + .09) / 12, 1e-18);
    EXPECT_NEAR(m.inertia.y(), .006 * (.01 + .09) / 12, 1e-18);
    EXPECT_NEAR(m.inertia.z(), .006 * (.01 + .04) / 12, 1e-18);
    EXPECT_EQ(m.origin, Vector3d::Zero());
    EXPECT_EQ(m.axes.coeffs(), Eigen::Quaterniond::Identity().coeffs());
    for (const Vector3d& v : m.vertices) {
      EXPECT_LE(std::abs(v.x()), .05);
      EXPECT_TRUE(std::abs(v.x()) == .05 || std::abs(v.y()) == .1 || std::abs(v.z()) == .15);
    }
    EXPECT_EQ(m.part, std::vector<int>(m.faces.size(), 0));
  }
}

TEST(Icosphere, ConvergesToTheSphereAsOneOverItsTriangles) {
  // ACCURACY C8: inscribed, volume error 11.1 / T, inertia 18.4 / T, worst gap 5.83 / T; slope -1.
  double previous = 0;
  for (const int level : {2, 3, 4, 5}) {
    const Mesh m = icosphere(2, level);
    const double t = static_cast<double>(m.faces.size());
    EXPECT_EQ(m.faces.size(), 20u << (2 * level));
    const double volume_error = 1 - m.volume / (4. / 3. * pi * 8);
    const double inertia_error = 1 - m.inertia.x() / (.4 * 4. / 3. * pi * 8 * 4);
    double nearest = 2;
    for (const auto& f : m.faces) {
      const Vector3d &a = m.vertices[f[0]], &b = m.vertices[f[1]], &c = m.vertices[f[2]];
      nearest = std::min(nearest, (b - a).cross(c - a).normalized().dot(a));
    }
    EXPECT_NEAR(volume_error * t, 11.1, .4) << level;
    EXPECT_NEAR(inertia_error * t, 18.4, .8) << level;
    EXPECT_NEAR((1 - nearest / 2) * t, 5.83, .8) << level;
    if (level > 2) {
      EXPECT_NEAR(std::log(volume_error / previous) / std::log(4.), -1, .1);
    }
    previous = volume_error;
    for (const Vector3d& v : m.vertices) EXPECT_NEAR(v.norm(), 2, 1e-15);
    EXPECT_LT((m.inertia - Vector3d::Constant(m.inertia.mean())).norm(), 1e-12 * m.inertia.mean());
  }
}

TEST(Granulate, IsAClosedConvexHullOfPointsInItsShell) {
  for (const int points : {4, 10, 20, 40})
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
      const Mesh m = granulate(.02, points, seed);
      ASSERT_GT(m.volume, 0) << points << " points, seed " << seed;
      ASSERT_LE(m.faces.size(), 2u * points - 4);
      ASSERT_EQ(m.faces.size(), 2 * m.vertices.size() - 4); // Euler: one closed surface
      for (const Vector3d& v : m.vertices) {
        const double r = m.in_shape_frame(v).norm();
        ASSERT_LE(r, .01 * (1 + 1e-14));
        ASSERT_GE(r, .0075 * (1 - 1e-14));
      }
      for (const auto& f : m.faces) {
        const Vector3d& a = m.vertices[f[0]];
        const Vector3d n = (m.vertices[f[1]] - a).cross(m.vertices[f[2]] - a).normalized();
        for (const Vector3d& v : m.vertices) ASSERT_LE(n.dot(v - a), 1e-14) << points << " points, seed " << seed;
      }
    }
}

TEST(Granulate, MostPointsAreCorners) {
  double triangles = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed)
    triangles += static_cast<double>(granulate(1, 20, seed).faces.size());
  EXPECT_GT(triangles / 100, 26); // of at most 36
}

TEST(Granulate, SameSeedSameBitsOtherSeedOtherShape) {
  const Mesh a = granulate(1, 20, 42), b = granulate(1, 20, 42), c = granulate(1, 20, 43);
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.faces, b.faces);
  EXPECT_EQ(a.inertia, b.inertia);
  EXPECT_NE(a.vertices, c.vertices);
}

TEST(Granulate, LeavesNoMemoryBehind) {
  const auto in_use = [] {
    const struct mallinfo2 now = mallinfo2();
    return now.uordblks + now.hblkhd;
  };
  granulate(1, 20, 1);
  const std::size_t before = in_use();
  for (int seed = 0; seed < 20; ++seed) granulate(1, 20, seed);
  EXPECT_LT(in_use(), before + 100000); // byte; the pools of 20 hulls take 2.6 MB, memory that grows once some kB
}

TEST(Granulate, PointsAreThoseOfTheStandardGenerator) {
  // The standard fixes the 10 000th output of mt19937_64; the direction was worked out apart, in Python's integers.
  std::mt19937_64 standard;
  standard.discard(9999);
  EXPECT_EQ(standard(), 9981545732273789042u);
  Random random(1);
  const Vector3d d = random.direction();
  EXPECT_EQ(d, Vector3d(-0x1.15258fd3d94b6p-4, -0x1.f81522e129426p-1, 0x1.4aedb7f20e6a0p-3));
}

TEST(Random, DirectionsAndRotationsAreUniform) {
  Random random(7);
  const int n = 20000;
  Vector3d mean = Vector3d::Zero(), turned = Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero(), turned_second = second;
  double u1 = 0, u2 = 0;
  for (int i = 0; i < n; ++i) {
    const Vector3d d = random.direction();
    const Eigen::Quaterniond q = random.rotation();
    ASSERT_NEAR(d.norm(), 1, 1e-15);
    ASSERT_NEAR(q.norm(), 1, 1e-15);
    mean += d / n;
    second += d * d.transpose() / n;
    turned += q * Vector3d::UnitX() / n;
    turned_second += (q * Vector3d::UnitX()) * (q * Vector3d::UnitX()).transpose() / n;
    const double u = random.uniform();
    ASSERT_TRUE(u >= 0 && u < 1);
    u1 += u / n, u2 += u * u / n;
  }
  const double bar = 4 / std::sqrt(n); // some four standard deviations
  EXPECT_LT(mean.norm(), bar);
  EXPECT_LT(turned.norm(), bar);
  EXPECT_LT((second - Eigen::Matrix3d::Identity() / 3).norm(), bar);
  EXPECT_LT((turned_second - Eigen::Matrix3d::Identity() / 3).norm(), bar);
  EXPECT_NEAR(u1, 1. / 2, bar);
  EXPECT_NEAR(u2, 1. / 3, bar);
}

TEST(Hopper, IsFourClosedPlatesOfTheRightSize) {
  const Mesh m = in_shape_frame(hopper(.2, .1333, .05, .005));
  EXPECT_EQ(m.faces.size(), 48u);
  EXPECT_EQ(std::set<int>(m.part.begin(), m.part.end()), (std::set<int>{0, 1, 2, 3}));
  EXPECT_GT(m.volume, 0);
  double top = 1, bottom = 1, low = 1, high = -1;
  for (const Vector3d& v : m.vertices) {
    low = std::min(low, v.y()), high = std::max(high, v.y());
    (v.y() > 0 ? top : bottom) = std::min(v.y() > 0 ? top : bottom, std::min(std::abs(v.x()), std::abs(v.z())));
  }
  EXPECT_NEAR(high - low, .1333, 1e-15);
  EXPECT_NEAR(2 * top, .2, 1e-15);
  EXPECT_NEAR(2 * bottom, .05, 1e-15);
}

TEST(Hopper, InsideIsFreeAndWallsAreAsThickAsAsked) {
  const Mesh m = in_shape_frame(hopper(.2, .1333, .05, .005));
  for (int i = 0; i < 12 * 4; i += 12) {
    // Distance between the two large parallel faces of a plate, measured along the normal of the inner one.
    double thickest = 0;
    const Vector3d a = m.vertices[m.faces[i][0]];
    const Vector3d n = (m.vertices[m.faces[i][1]] - a).cross(m.vertices[m.faces[i][2]] - a).normalized();
    for (int f = i; f < i + 12; ++f)
      for (const int v : m.faces[f]) thickest = std::max(thickest, -n.dot(m.vertices[v] - a));
    EXPECT_NEAR(thickest, .005, 1e-15);
  }
  // Nothing of any plate reaches inside the square of the clear width at its height: vertical rays through the inside
  // of the funnel at the opening's square meet nothing.
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const Vector3d x((random.uniform() - .5) * .0499, 1, (random.uniform() - .5) * .0499);
    ASSERT_FALSE(ray_meets(m, x, -Vector3d::UnitY()));
  }
}

TEST(Hopper, NothingEscapesDownwardsExceptThroughTheOpening) {
  const double width = .2, height = .1333, opening = .05;
  const Mesh m = in_shape_frame(hopper(width, height, opening, .005));
  Random random(11);
  int through = 0;
  for (int i = 0; i < 200000; ++i) {
    const double up = random.uniform() * .999, half = (opening + (width - opening) * up) / 2 * .999;
    const Vector3d x(half * (2 * random.uniform() - 1), (up - .5) * height, half * (2 * random.uniform() - 1));
    Vector3d d = random.direction();
    if (i % 2) { // half of the rays aim near the corners between two plates
      const double level = random.uniform() * up, at = (opening + (width - opening) * level) / 2;
      const Vector3d corner(random.bits() & 1 ? at : -at, (level - .5) * height, random.bits() & 1 ? at : -at);
      d = (corner + 1e-3 * random.direction() - x).normalized();
    }
    if (d.y() > -1e-9) continue;
    const Vector3d exit = x + d * ((-height / 2 - x.y()) / d.y());
    const bool by_opening = std::abs(exit.x()) < opening / 2 && std::abs(exit.z()) < opening / 2;
    ASSERT_EQ(ray_meets(m, x, d), !by_opening) << x.transpose() << " towards " << d.transpose();
    through += by_opening;
  }
  EXPECT_GT(through, 1000);
}

TEST(Plane, IsOpenAndFacesUp) {
  const Mesh m = plane(3);
  EXPECT_EQ(m.volume, 0);
  ASSERT_EQ(m.faces.size(), 2u);
  for (const auto& f : m.faces) {
    const Vector3d& a = m.vertices[f[0]];
    EXPECT_GT((m.vertices[f[1]] - a).cross(m.vertices[f[2]] - a).y(), 0);
  }
  EXPECT_DOUBLE_EQ(m.radius, 3 / std::sqrt(2.));
}

TEST(Shapes, SenselessSizesAreRefused) {
  EXPECT_THROW(box({1, 0, 1}), InputError);
  EXPECT_THROW(box({1, NAN, 1}), InputError);
  EXPECT_THROW(box({1, 1, 1}, 0), InputError);
  EXPECT_THROW(icosphere(-1, 2), InputError);
  EXPECT_THROW(icosphere(1, -1), InputError);
  EXPECT_THROW(icosphere(1, 30), InputError);
  EXPECT_THROW(granulate(1, 3, 1), InputError);
  EXPECT_THROW(granulate(INFINITY, 20, 1), InputError);
  EXPECT_THROW(hopper(.05, .1, .2, .005), InputError);
  EXPECT_THROW(hopper(.2, .1, .05, 0), InputError);
  EXPECT_THROW(plane(0), InputError);
}
