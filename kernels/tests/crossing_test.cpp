#include "kernels/brute.hpp"
#include "kernels/crossing.hpp"
#include <gtest/gtest.h>

namespace trigrain {

namespace {
constexpr Triangle flat{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
bool meet(const Triangle& a, const Triangle& b) {
  const bool ab = common_point(a, b, {}).has_value(), ba = common_point(b, a, {}).has_value();
  EXPECT_EQ(ab, ba);
  return ab;
}
} // namespace

TEST(Crossing, AnEdgeThroughTheFaceMeetsItWhereItDoes) {
  const auto point = common_point(flat, {{.25, .25, -1}, {.25, .25, 3}, {5, 5, 3}}, {9, 9, 9});
  ASSERT_TRUE(point);
  EXPECT_NEAR(point->x, .25, 1e-15);
  EXPECT_NEAR(point->y, .25, 1e-15);
  EXPECT_NEAR(point->z, 0, 1e-15);
}

TEST(Crossing, TheLastBitDecidesBetweenTouchingAndNot) {
  const Triangle steep{{0, 0, 0}, {1, 0, 1}, {0, 1, 1}}; // in the plane z = x + y
  const auto with_corner_at = [](double z) { return Triangle{{.25, .25, z}, {.25, .25, 3}, {.5, .5, 3}}; };
  EXPECT_TRUE(meet(steep, with_corner_at(.5)));
  EXPECT_TRUE(meet(steep, with_corner_at(.5 - 0x1p-54)));
  EXPECT_FALSE(meet(steep, with_corner_at(.5 + 0x1p-53)));
  EXPECT_TRUE(meet(flat, {{.5, .5, -1}, {.5, .5, 1}, {2, 2, 1}})); // through the longest edge
  EXPECT_FALSE(meet(flat, {{.5 + 0x1p-53, .5, -1}, {.5 + 0x1p-53, .5, 1}, {2, 2, 1}}));
}

TEST(Crossing, CoplanarTrianglesMeetWhereTheyOverlapTouchOrContain) {
  EXPECT_TRUE(meet(flat, {{.1, .1, 0}, {.2, .1, 0}, {.1, .2, 0}}));
  EXPECT_TRUE(meet(flat, {{-9, -9, 0}, {9, -9, 0}, {0, 20, 0}}));
  EXPECT_TRUE(meet(flat, {{1, 0, 0}, {2, 0, 0}, {2, 1, 0}}));
  EXPECT_TRUE(meet(flat, {{0, 0, 0}, {1, 0, 0}, {0, -1, 0}}));
  EXPECT_FALSE(meet(flat, {{1, 1, 0}, {2, 1, 0}, {1, 2, 0}}));
}

TEST(Crossing, SegmentsAndPointsMeetWhatTheyTouch) {
  const Triangle segment{{.25, .25, -1}, {.25, .25, 1}, {.25, .25, 0}},
      point{{.25, .25, 0}, {.25, .25, 0}, {.25, .25, 0}};
  EXPECT_TRUE(meet(flat, segment));
  EXPECT_TRUE(meet(flat, point));
  EXPECT_TRUE(meet(segment, point));
  EXPECT_TRUE(meet(segment, {{-1, .25, .5}, {1, .25, .5}, {0, .25, .5}}));
  EXPECT_FALSE(meet(segment, {{-1, .25, 1.5}, {1, .25, 1.5}, {0, .25, 1.5}}));
  EXPECT_TRUE(meet(segment, {{.25, .25, 1}, {.25, .25, 3}, {.25, .25, 2}}));
  EXPECT_FALSE(meet(segment, {{.25, .25, 1.5}, {.25, .25, 3}, {.25, .25, 2}}));
  EXPECT_FALSE(meet(segment, {{.5, .25, -1}, {.5, .25, 1}, {.5, .25, 0}}));
  EXPECT_FALSE(meet(point, {{.25, .25, 1e-300}, {.25, .25, 1e-300}, {.25, .25, 1e-300}}));
}

// Seen from a corner of A, 1e-20 m is lost in 1 m and the distance comes out as zero; but zero would say "crossing".
TEST(Brute, ReportsNoZeroForAGapBelowRounding) {
  const Triangle steep{{0, 0, 1}, {1, 0, -1}, {0, 1, -1}}, above{{.25, .25, 1e-20}, {.5, .25, 1}, {.5, .5, 1}};
  for (const Closest& c : {closest_by_brute_force(steep, above), closest_by_brute_force(above, steep)}) {
    EXPECT_GT(c.distance, 0);
    EXPECT_LT(c.distance, 1e-14);
    EXPECT_GT(dot(c.p - c.q, c.p - c.q), 0);
  }
}

} // namespace trigrain
