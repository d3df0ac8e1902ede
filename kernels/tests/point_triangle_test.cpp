#include "kernels/point_triangle.hpp"
#include "kernels/segment.hpp"
#include <gtest/gtest.h>
#include <numbers>

namespace trigrain {

namespace {

struct Zone {
  const char* name;
  Vec3<double> from, nearest;
};

// Triangle a (0,0), b (4,0), c (0,4) in the plane z = 0 and one point above each zone of the drawing.
const Corners<double> triangle{Vec3<double>{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
const std::vector<Zone> zones{{"A", {-1, -2, 3}, {0, 0, 0}},          {"B", {6, -1, 3}, {4, 0, 0}},
                              {"C", {-1, 7, 3}, {0, 4, 0}},           {"AB", {1, -2, 3}, {1, 0, 0}},
                              {"BC", {3, 3, 3}, {2, 2, 0}},           {"AC", {-2, 1, 3}, {0, 1, 0}},
                              {"ABC", {1, 2, 3}, {1, 2, 0}},          {"A, obtuse side", {-1, 0, 3}, {0, 0, 0}},
                              {"corner itself", {4, 0, 0}, {4, 0, 0}}};

void expect_near(const Vec3<double>& x, const Vec3<double>& y, const std::string& what) {
  EXPECT_NEAR(x.x, y.x, 4e-15) << what;
  EXPECT_NEAR(x.y, y.y, 4e-15) << what;
  EXPECT_NEAR(x.z, y.z, 4e-15) << what;
}

/// The point of t that closest_on_triangle() gives weights of.
template <class T> Vec3<T> nearest_point(const Vec3<T>& from, const Corners<T>& t) {
  const auto [v, w] = closest_on_triangle(from, t);
  return t[0] + v * (t[1] - t[0]) + w * (t[2] - t[0]);
}

PointPair<double> nearest_points(const Vec3<double>& a0, const Vec3<double>& a1, const Vec3<double>& b0,
                                 const Vec3<double>& b1) {
  const auto [s, t] = closest_on_segments(a0, a1, b0, b1);
  return {a0 + s * (a1 - a0), b0 + t * (b1 - b0)};
}

Vec3<Lanes> in_lanes(const Vec3<double>& v) { return {Lanes(v.x), Lanes(v.y), Lanes(v.z)}; }

} // namespace

TEST(PointTriangle, EveryZoneIsNearestToItsFeature) {
  for (const Zone& zone : zones)
    for (int turn = 0; turn < 3; ++turn)
      for (const bool mirrored : {false, true}) {
        Corners<double> t{triangle[turn], triangle[(turn + 1) % 3], triangle[(turn + 2) % 3]};
        if (mirrored) std::swap(t[1], t[2]);
        const std::string what = std::string(zone.name) + ", turn " + std::to_string(turn);
        expect_near(closest_on_triangle_by_zones(zone.from, t).point, zone.nearest, what + ", by zones");
        expect_near(nearest_point(zone.from, t), zone.nearest, what + ", one lane");
        const Corners<Lanes> packed{in_lanes(t[0]), in_lanes(t[1]), in_lanes(t[2])};
        const Vec3<Lanes> q = nearest_point(in_lanes(zone.from), packed);
        expect_near({q.x[lane_count - 1], q.y[lane_count - 1], q.z[lane_count - 1]}, zone.nearest, what + ", lanes");
      }
}

TEST(PointTriangle, ZeroAreaIsItsEdgesOrItsPoint) {
  const Vec3<double> from{1, 1, 0};
  for (const auto& [t, nearest] :
       {std::pair{Corners<double>{Vec3<double>{0, 0, 0}, {2, 0, 0}, {3, 0, 0}}, Vec3<double>{1, 0, 0}},
        {{Vec3<double>{0, 0, 0}, {0, 0, 0}, {3, 0, 0}}, {1, 0, 0}},
        {{Vec3<double>{2, 2, 2}, {2, 2, 2}, {2, 2, 2}}, {2, 2, 2}}}) {
    expect_near(closest_on_triangle_by_zones(from, t).point, nearest, "by zones");
    expect_near(nearest_point(from, t), nearest, "without branches");
  }
}

TEST(Segments, EveryCombinationOfEndAndInside) {
  const Vec3<double> a0{-1, 0, 0}, a1{1, 0, 0};
  struct Case {
    const char* name;
    Vec3<double> b0, b1, p, q;
  };
  for (const Case& c : {Case{"inside - inside", {0, -1, 2}, {0, 1, 2}, {0, 0, 0}, {0, 0, 2}},
                        Case{"inside - end", {.5, 1, 2}, {.5, 3, 2}, {.5, 0, 0}, {.5, 1, 2}},
                        Case{"end - inside", {3, -1, 0}, {3, 1, 0}, {1, 0, 0}, {3, 0, 0}},
                        Case{"end - end", {2, 1, 0}, {3, 5, 0}, {1, 0, 0}, {2, 1, 0}},
                        Case{"parallel, beyond", {2, 1, 0}, {4, 1, 0}, {1, 0, 0}, {2, 1, 0}},
                        Case{"antiparallel, beyond", {4, 1, 0}, {2, 1, 0}, {1, 0, 0}, {2, 1, 0}},
                        Case{"point", {.25, 1, 1}, {.25, 1, 1}, {.25, 0, 0}, {.25, 1, 1}}}) {
    const auto ab = nearest_points(a0, a1, c.b0, c.b1), ba = nearest_points(c.b0, c.b1, a0, a1);
    expect_near(ab.p, c.p, c.name);
    expect_near(ab.q, c.q, c.name);
    expect_near(ba.q, c.p, std::string(c.name) + ", swapped");
    expect_near(ba.p, c.q, std::string(c.name) + ", swapped");
  }
}

// Lines at a small angle cross a gap h apart: the distance is h whatever the angle.
TEST(Segments, NearlyParallelLinesKeepTheirDistance) {
  for (const double angle : {1e-2, 1e-5, 1e-8, 1e-11, 1e-14})
    for (const double h : {1e-3, 1e-9}) {
      const auto [p, q] = nearest_points({-1, 0, 0}, {1, 0, 0}, {-.7, -.7 * angle, h}, {.9, .9 * angle, h});
      EXPECT_NEAR(std::sqrt(squared(p - q)), h, 1e-15) << angle;
    }
}

} // namespace trigrain
