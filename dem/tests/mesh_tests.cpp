#include "dem/mesh.hpp"
#include "kernels/name_table.hpp"
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

using namespace trigrain;
using Eigen::Vector3d;
using Face = std::array<int, 3>;

namespace {

/// A surface in the shape's own frame, for building others from it.
struct Surface {
  std::vector<Vector3d> vertices;
  std::vector<Face> faces;

  void append(const Surface& other) {
    const int first = static_cast<int>(vertices.size());
    vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const Face& f : other.faces) faces.push_back({first + f[0], first + f[1], first + f[2]});
  }
  Surface moved(const Eigen::Quaterniond& q, const Vector3d& t) const {
    Surface s = *this;
    for (Vector3d& v : s.vertices) v = q * v + t;
    return s;
  }
  Surface turned_inside_out() const {
    Surface s = *this;
    for (Face& f : s.faces) std::swap(f[0], f[1]);
    return s;
  }
  Mesh mesh() const { return make_mesh("test", vertices, faces); }
};

Surface of(const Mesh& m) {
  Surface s{m.vertices, m.faces};
  return s.moved(m.axes, m.origin);
}

/// Signed volume of the faces as they are, without looking at anything else in the mesh.
double signed_volume(const Mesh& m) {
  double v = 0;
  for (const Face& f : m.faces) v += m.vertices[f[0]].dot(m.vertices[f[1]].cross(m.vertices[f[2]])) / 6;
  return v;
}

Vector3d sorted(Vector3d v) {
  std::sort(v.begin(), v.end());
  return v;
}

const Surface cuboid = of(box({1, 2, 3}));

} // namespace

TEST(Mesh, BodyFrameHasItsCentreAndPrincipalAxes) {
  // Second moments of the body-frame faces, by the mesh's own tetrahedra, must be diagonal about the origin.
  const Mesh m = cuboid.moved(Eigen::Quaterniond(.5, .1, -.7, .3).normalized(), {4, -5, 6}).mesh();
  Vector3d first = Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (const Face& f : m.faces) {
    const Vector3d &a = m.vertices[f[0]], &b = m.vertices[f[1]], &c = m.vertices[f[2]], s = a + b + c;
    const double v = a.dot(b.cross(c)) / 6;
    first += v / 4 * s;
    second += v / 20 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
  }
  EXPECT_LT(first.norm(), 1e-13);
  const Eigen::Matrix3d inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  EXPECT_LT((inertia - Eigen::Matrix3d(m.inertia.asDiagonal())).norm(), 1e-12);
}

TEST(Mesh, MovedCopiesHaveTheSamePrincipalMoments) {
  const Mesh still = of(granulate(1, 20, 5)).mesh();
  for (int i = 0; i < 20; ++i) {
    const auto q = Eigen::Quaterniond(1, .3 * i, 2. - i, .1 * i * i).normalized();
    const Vector3d t(i, -3. * i, .5);
    const Mesh moved = of(granulate(1, 20, 5)).moved(q, t).mesh();
    EXPECT_NEAR(moved.volume, still.volume, 1e-13);
    EXPECT_LT((sorted(moved.inertia) - sorted(still.inertia)).norm(), 1e-13) << i;
    EXPECT_LT((moved.origin - (q * still.origin + t)).norm(), 1e-13 * (1 + t.norm())) << i;
    EXPECT_NEAR(moved.axes.norm(), 1, 1e-15);
  }
}

TEST(Mesh, BodyFrameLeadsBackToTheShape) {
  const Surface shape = of(granulate(1, 20, 9)).moved(Eigen::Quaterniond(.2, .3, .4, .5).normalized(), {1, 2, 3});
  const Mesh m = shape.mesh();
  const Surface back = of(m);
  // Vertices come in the order in which faces use them; compare corner by corner.
  ASSERT_EQ(m.faces.size(), shape.faces.size());
  for (std::size_t f = 0; f < m.faces.size(); ++f)
    for (int k = 0; k < 3; ++k)
      EXPECT_LT((back.vertices[back.faces[f][k]] - shape.vertices[shape.faces[f][k]]).norm(), 1e-14);
}

TEST(Mesh, RadiusReachesTheFarthestVertex) { EXPECT_DOUBLE_EQ(box({2, 4, 4}).radius, 3); }

TEST(Mesh, KernelsGetTheSameTriangles) {
  const Mesh m = cuboid.mesh();
  const TrianglesView t = m.triangles.view();
  ASSERT_EQ(t.size, static_cast<int>(m.faces.size()));
  for (int i = 0; i < t.size; ++i) {
    EXPECT_EQ(Vector3d(t[i].a0.x, t[i].a0.y, t[i].a0.z), m.vertices[m.faces[i][0]]);
    EXPECT_EQ(Vector3d(t[i].a1.x, t[i].a1.y, t[i].a1.z), m.vertices[m.faces[i][1]]);
    EXPECT_EQ(Vector3d(t[i].a2.x, t[i].a2.y, t[i].a2.z), m.vertices[m.faces[i][2]]);
  }
}

TEST(Mesh, InwardSurfaceIsTurnedOutward) {
  const Mesh m = cuboid.turned_inside_out().mesh();
  EXPECT_NEAR(m.volume, 6, 1e-14);
  EXPECT_NEAR(signed_volume(m), 6, 1e-14);
}

TEST(Mesh, SeparatePiecesAreTurnedEachForItself) {
  Surface two = cuboid;
  two.append(cuboid.turned_inside_out().moved(Eigen::Quaterniond::Identity(), {10, 0, 0}));
  const Mesh m = two.mesh();
  EXPECT_NEAR(m.volume, 12, 1e-13);
  EXPECT_NEAR(signed_volume(m), 12, 1e-13);
  EXPECT_EQ(m.origin, Vector3d(5, 0, 0));
  EXPECT_EQ(*std::max_element(m.part.begin(), m.part.end()), 1);
  for (int i = 0; i < 24; ++i) EXPECT_EQ(m.part[i], i / 12);
}

TEST(Mesh, CavityCountsNegativeHoweverItIsTurned) {
  const Surface cavity = of(box({.5, .5, .5}));
  for (const bool outer_in : {false, true})
    for (const bool inner_in : {false, true}) {
      Surface hollow = outer_in ? cuboid.turned_inside_out() : cuboid;
      hollow.append(inner_in ? cavity.turned_inside_out() : cavity);
      const Mesh m = hollow.mesh();
      EXPECT_NEAR(m.volume, 6 - .125, 1e-14);
      EXPECT_NEAR(m.inertia.x(), 6 * (4 + 9) / 12. - .125 * .5 / 12, 1e-13);
      EXPECT_NEAR(signed_volume(m), 6 - .125, 1e-14);
    }
}

TEST(Mesh, BallInACavityIsSolidAgain) {
  Surface nested = cuboid;
  nested.append(of(box({.8, .8, .8})));
  nested.append(of(box({.2, .2, .2})));
  EXPECT_NEAR(nested.mesh().volume, 6 - .512 + .008, 1e-14);
}

TEST(Mesh, OverlappingPiecesAreNoCavities) {
  Surface cross = of(box({3, 1, 1}));
  cross.append(of(box({1, 3, 1})));
  EXPECT_NEAR(cross.mesh().volume, 6, 1e-14);
}

TEST(Mesh, EqualVerticesAreOne) {
  Surface soup; // each triangle with corners of its own, as in an STL file
  for (const Face& f : cuboid.faces) {
    const int n = static_cast<int>(soup.vertices.size());
    for (const int v : f) soup.vertices.push_back(cuboid.vertices[v]);
    soup.faces.push_back({n, n + 1, n + 2});
  }
  soup.vertices.push_back({100, 100, 100}); // used by no face
  const Mesh m = soup.mesh();
  EXPECT_EQ(m.vertices.size(), 8u);
  EXPECT_NEAR(m.volume, 6, 1e-14);
  EXPECT_LT(m.radius, 2);
}

TEST(Mesh, MinusZeroIsZero) {
  Surface s{{{0., 0., 0.}, {-0., 0., -0.}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
            {{0, 3, 2}, {1, 2, 4}, {0, 4, 3}, {2, 3, 4}}};
  EXPECT_NEAR(s.mesh().volume, 1. / 6, 1e-15);
}

TEST(Mesh, OpenSurfaceKeepsItsOwnFrame) {
  Surface open = cuboid.moved(Eigen::Quaterniond::Identity(), {7, 0, 0});
  open.faces.pop_back();
  const Mesh m = open.mesh();
  EXPECT_EQ(m.volume, 0);
  EXPECT_EQ(m.inertia, Vector3d::Zero());
  EXPECT_EQ(m.origin, Vector3d::Zero());
  EXPECT_EQ(m.axes.coeffs(), Eigen::Quaterniond::Identity().coeffs());
  EXPECT_GT(m.radius, 7);
  EXPECT_EQ(m.triangles.size(), 11);
}

TEST(Mesh, OneFaceTurnedMakesTheSurfaceOpen) {
  Surface s = cuboid;
  std::swap(s.faces[3][0], s.faces[3][1]);
  EXPECT_EQ(s.mesh().volume, 0);
}

TEST(Mesh, EdgeOfFourFacesMakesTheSurfaceOpen) {
  Surface two = cuboid;
  two.append(cuboid.moved(Eigen::Quaterniond::Identity(), {1, 2, 0})); // they share one edge
  const Mesh m = two.mesh();
  EXPECT_EQ(m.vertices.size(), 14u);
  EXPECT_EQ(m.part, std::vector<int>(24, 0));
  EXPECT_EQ(m.volume, 0);
}

TEST(Mesh, FlatClosedSurfaceHasNoMass) {
  const Surface coin{{{0, 0, 0}, {1, 0, 0}, {0, 1, .3}}, {{0, 1, 2}, {0, 2, 1}}};
  EXPECT_EQ(coin.mesh().volume, 0);
  EXPECT_EQ(coin.mesh().origin, Vector3d::Zero());
}

TEST(Mesh, RepeatedAndCollapsedFacesAreKeptAndHaveNoMass) {
  Surface s = cuboid;
  s.faces.push_back({s.faces[4][1], s.faces[4][2], s.faces[4][0]}); // the same face again
  s.faces.push_back({s.faces[0][0], s.faces[0][0], s.faces[0][1]});
  s.faces.push_back({2, 2, 2});
  const Mesh m = s.mesh();
  EXPECT_EQ(m.faces.size(), 15u);
  EXPECT_EQ(m.triangles.size(), 15);
  EXPECT_NEAR(m.volume, 6, 1e-14);
}

TEST(Mesh, ZeroAreaTriangleThatClosesATJunctionIsFine) {
  // Edge 0-1 of a tetrahedron carries a vertex 4 on one side only; the sliver 0 4 1 joins the two sides.
  const Surface s{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {.5, 0, 0}},
                  {{0, 2, 1}, {0, 4, 3}, {4, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 1, 4}}};
  EXPECT_NEAR(s.mesh().volume, 1. / 6, 1e-15);
}

TEST(Mesh, FarFromTheOriginMomentsStayExact) {
  const Mesh m = cuboid.moved(Eigen::Quaterniond::Identity(), {1024, -2048, 4096}).mesh();
  EXPECT_NEAR(m.volume, 6, 1e-12);
  EXPECT_NEAR(m.inertia.x(), 6 * (4 + 9) / 12., 1e-11);
}

TEST(Mesh, ScaledByPowersOfTwoTheResultScalesBitwise) {
  const Surface shape = of(granulate(1, 20, 3));
  const Mesh one = shape.mesh();
  for (const int k : {-20, -1, 7, 20}) {
    const double s = std::ldexp(1., k);
    Surface scaled = shape;
    for (Vector3d& v : scaled.vertices) v *= s;
    const Mesh m = scaled.mesh();
    EXPECT_EQ(m.volume, s * s * s * one.volume);
    EXPECT_EQ(m.origin, s * one.origin);
    EXPECT_EQ(m.radius, s * one.radius);
  }
}

TEST(Mesh, SenselessInputIsRefused) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const std::vector<Vector3d> fine{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_THROW(make_mesh("m", fine, {}), InputError);
  EXPECT_THROW(make_mesh("m", {{0, nan, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}), InputError);
  EXPECT_THROW(make_mesh("m", {{0, 0, 0}, {1, 0, -inf}, {0, 1, 0}}, {{0, 1, 2}}), InputError);
  EXPECT_THROW(make_mesh("m", fine, {{0, 1, 3}}), InputError);
  EXPECT_THROW(make_mesh("m", fine, {{0, -1, 2}}), InputError);
  EXPECT_NO_THROW(make_mesh("m", fine, {{0, 1, 2}}));
}
