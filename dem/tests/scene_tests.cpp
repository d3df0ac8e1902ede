#include "dem/random.hpp"
#include "dem/scene.hpp"
#include "dem/simulation.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <numbers>
#include <unistd.h>

using namespace trigrain;
using Eigen::Vector3d;

namespace {

const std::filesystem::path data = TRIGRAIN_TEST_DATA;

double volume(const Body& b) {
  return b.mesh ? b.mesh->volume : 4. / 3. * std::numbers::pi * std::pow(b.sphere_radius, 3);
}
double radius(const Body& b) { return b.mesh ? b.mesh->radius : b.sphere_radius; }
Vector3d centre(const Body& b) { return b.mesh ? b.position + b.orientation * b.mesh->origin : b.position; }

std::vector<Vector3d> corners(const Body& b) {
  std::vector<Vector3d> list;
  for (const Vector3d& v : b.mesh->vertices) list.push_back(b.position + b.orientation * b.mesh->in_shape_frame(v));
  return list;
}

/// The box around a body in the world.
Eigen::AlignedBox3d bounds(const Body& b) {
  Eigen::AlignedBox3d box;
  if (!b.mesh) return {b.position.array() - b.sphere_radius, b.position.array() + b.sphere_radius};
  for (const Vector3d& v : corners(b)) box.extend(v);
  return box;
}

/// Do any two bounding spheres of free bodies overlap? All pairs, sorted along x.
bool bounding_spheres_overlap(const Scene& scene) {
  std::vector<std::pair<Vector3d, double>> spheres;
  for (const Body& b : scene.bodies)
    if (!b.fixed) spheres.emplace_back(centre(b), radius(b));
  double largest = 0;
  for (const auto& [c, r] : spheres) largest = std::max(largest, r);
  std::sort(spheres.begin(), spheres.end(), [](const auto& a, const auto& b) { return a.first.x() < b.first.x(); });
  for (std::size_t i = 0; i < spheres.size(); ++i)
    for (std::size_t j = i + 1; j < spheres.size(); ++j) {
      if (spheres[j].first.x() - spheres[i].first.x() > 2 * largest) break;
      if ((spheres[j].first - spheres[i].first).norm() <= spheres[i].second + spheres[j].second) return true;
    }
  return false;
}

struct Case {
  const char* scene;
  int particles, vertices;
  const char* halo = "relative";
  double size_ratio = 1, fill = .5;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.scene << " with " << c.particles << " x " << c.vertices << ", halo " << c.halo << ", 1:" << c.size_ratio
       << ", fill " << c.fill;
}

class BuiltInScene : public testing::TestWithParam<Case> {
 protected:
  const Case c = GetParam();
  const Scene scene = make_scene(c.scene, {c.particles, c.vertices, 1, c.halo, c.size_ratio, c.fill});
};

} // namespace

TEST_P(BuiltInScene, StartsWithoutOverlapInsideTheDomain) {
  EXPECT_EQ(scene.name, c.scene);
  EXPECT_FALSE(bounding_spheres_overlap(scene));
  const Eigen::AlignedBox3d domain(scene.domain.min, scene.domain.min + Vector3d::Constant(scene.domain.size));
  for (const Body& b : scene.bodies) {
    const Eigen::AlignedBox3d box = bounds(b);
    ASSERT_TRUE(domain.contains(box));
    if (b.fixed) continue;
    for (const Body& wall : scene.bodies) // all walls are convex or, the hopper, below all grains
      ASSERT_FALSE(wall.fixed && bounds(wall).intersects(box));
  }
}

TEST_P(BuiltInScene, GrainsHaveMassHaloAndTheirOwnShapeAndOrientation) {
  std::vector<const Mesh*> meshes;
  for (const Body& b : scene.bodies) {
    EXPECT_GT(b.halo, 0);
    if (b.fixed) continue;
    ASSERT_GT(volume(b), 0);
    ASSERT_EQ(b.density, 1000);
    ASSERT_EQ(b.mesh == nullptr, c.vertices == 0);
    ASSERT_NEAR(b.orientation.norm(), 1, 1e-14);
    if (b.mesh) {
      meshes.push_back(b.mesh.get());
      ASSERT_NE(b.orientation.coeffs(), Eigen::Quaterniond::Identity().coeffs());
    }
  }
  for (std::size_t i = 1; i < meshes.size(); ++i) ASSERT_NE(meshes[i]->vertices, meshes[i - 1]->vertices);
}

TEST_P(BuiltInScene, StepIsHalfTheCriticalOneForAnyContactPoint) {
  // Independently of how the scene finds it: random normals at all corners of all grains; on the two heaviest turning
  // points (2 / w)(sqrt(1 + z^2) - z), w^2 = k (1 / m_1 + 1 / m_2) and the dashpot that belongs to the grains' masses.
  Random random(5);
  std::vector<double> inverse; // of the smallest effective mass of each grain (1/kg)
  double turning = 1;
  for (const Body& b : scene.bodies) {
    if (b.fixed || !b.mesh) continue;
    const double m = b.density * volume(b);
    inverse.push_back(1 / m);
    for (const Vector3d& x : b.mesh->vertices) {
      const Vector3d torque = x.cross(random.direction().cross(x).normalized());
      inverse.back() = std::max(inverse.back(), 1 / m + torque.dot(torque.cwiseQuotient(b.density * b.mesh->inertia)));
    }
    turning = std::max(turning, m * inverse.back());
  }
  inverse.push_back(0); // a wall
  std::sort(inverse.rbegin(), inverse.rend());
  if (inverse.size() < 2) return; // balls only: nothing turns
  const double omega = std::sqrt(scene.contact.stiffness * (inverse[0] + inverse[1]));
  const double zeta = scene.contact.damping_ratio * std::sqrt(turning);
  const double smallest = 2 / omega * (std::sqrt(1 + zeta * zeta) - zeta);
  EXPECT_LE(scene.time.step, smallest / 2);
  if (c.vertices > 0 && c.size_ratio == 1) { // and not needlessly small
    EXPECT_GT(scene.time.step, smallest / 8);
  }
}

INSTANTIATE_TEST_SUITE_P(All, BuiltInScene,
                         testing::Values(Case{"hopper", 1000, 20}, Case{"hopper", 1000, 0}, Case{"hopper", 1, 10},
                                         Case{"hopper", 37, 40}, Case{"hopper", 10000, 0},
                                         Case{"hopper", 1000, 20, "published"}, Case{"hopper-dense", 1000, 20},
                                         Case{"hopper-dense", 1000, 10}, Case{"hopper-dense", 2000, 0},
                                         Case{"hopper-dense", 10000, 0}, Case{"two-particles", 2, 20},
                                         Case{"two-particles", 2, 0}, Case{"gas", 729, 20},
                                         Case{"gas", 729, 10, "relative", 20}, Case{"gas", 3000, 0},
                                         Case{"gas", 100, 10, "published"}, Case{"gas", 729, 10, "relative", 1, .9}));

TEST(Scenes, HopperHasThePublishedNumbersOfGrainsAndTheirMass) {
  for (const auto& [asked, made] : {std::pair{1000, 1000}, {10000, 10800}, {500, 500}}) {
    const Scene scene = make_scene("hopper", {.particles = asked, .vertices = asked == 1000 ? 20 : 0});
    EXPECT_EQ(scene.bodies.size(), made + 2u);
    double mass = 0;
    for (const Body& b : scene.bodies)
      if (!b.fixed) mass += b.density * volume(b);
    EXPECT_NEAR(mass, .05, 1e-14);
    EXPECT_TRUE(scene.bodies[0].fixed && scene.bodies[1].fixed && !scene.bodies[2].fixed);
  }
  const Scene scene = make_scene("hopper", {.particles = 1000, .vertices = 0});
  EXPECT_NEAR(scene.bodies[2].sphere_radius, 2.285e-3, 1e-6); // METHODS: 2.3 mm
  EXPECT_NEAR(scene.bodies[3].position.x() - scene.bodies[2].position.x(), .019, 1e-15);
  EXPECT_NEAR(bounds(scene.bodies[0]).max().y() - bounds(scene.bodies[0]).min().y(), .1333, 1e-15);
  EXPECT_NEAR(bounds(scene.bodies[1]).max().y(), .375 + .04, 1e-15); // slab and rim
  EXPECT_EQ(std::ranges::max(scene.bodies[1].mesh->part), 4) << "slab and four plates, each a piece of its own";
}

TEST(Scenes, PackedBallsMayTakeTheStep) {
  for (const int particles : {1000, 10000})
    for (const char* halo : {"relative", "published"}) {
      Scene scene = make_scene("hopper", {.particles = particles, .vertices = 0, .halo = halo});
      const double touching = 2 * (scene.bodies[2].sphere_radius + scene.bodies[2].halo);
      const double edge = .999 * touching * 2 / std::sqrt(3); // of a body-centred lattice: eight contacts each
      for (int i = 0; i < 1000; ++i) {
        const int cell = i / 2;
        scene.bodies[2 + i].position = Vector3d(.5, .6, .5) + edge * (Vector3d(cell % 8, cell / 64, cell / 8 % 8) +
                                                                      Vector3d::Constant(i % 2 * .5));
      }
      scene.bodies.resize(2 + 1000);
      Simulation sim(scene, {});
      const StepStats stats = sim.run(1); // the first step is looked at
      EXPECT_GT(stats.contacts, 3000);
      EXPECT_EQ(stats.unstable_steps, 0) << particles << " balls with halo " << halo;
    }
}

TEST(Scenes, CentresOfMassStandOnTheLattice) {
  for (const char* name : {"hopper", "hopper-dense"}) {
    const Scene scene = make_scene(name, {.particles = 1000, .vertices = 10});
    const Vector3d first = centre(scene.bodies[2]);
    EXPECT_LT((first - Vector3d(.5 - .0855, .5 + .06665 + .0095, .5 - .0855)).norm(), 1e-15);
    EXPECT_LT((centre(scene.bodies[2 + 1]) - first - Vector3d(.019, 0, 0)).norm(), 1e-15);
    EXPECT_LT((centre(scene.bodies[2 + 10]) - first - Vector3d(0, 0, .019)).norm(), 1e-15);
    EXPECT_LT((centre(scene.bodies[2 + 100]) - first - Vector3d(0, .019, 0)).norm(), 1e-15);
  }
}

TEST(Scenes, StiffnessKeepsHopperImpactsShallowAndBodiesApart) {
  // The damped impact, integrated in small steps: overlap below 1 % of the radius at the fall speed, against a wall.
  const Scene scene = make_scene("hopper", {.particles = 1000, .vertices = 0});
  const double m = .05 / 1000, r = scene.bodies[2].sphere_radius, k = scene.contact.stiffness;
  double x = 0, v = 1.3, h = scene.time.step / 100;
  while (v > 0) v -= h * (k * x + 2 * .5 * std::sqrt(k * m) * v) / m, x += h * v;
  EXPECT_LT(x, .01 * r * 1.001);
  EXPECT_GT(x, .009 * r);
  EXPECT_GT(2 * scene.bodies[2].halo * std::sqrt(k / m), 2 * 1.3);
  EXPECT_DOUBLE_EQ(scene.time.step, std::numbers::pi * std::sqrt(m / 2 / k) / 15);
}

TEST(Scenes, PublishedContactIsAsPublished) {
  const Scene scene = make_scene("hopper", {.particles = 100, .halo = "published"});
  EXPECT_EQ(scene.contact.stiffness, 1e3);
  for (const Body& b : scene.bodies) EXPECT_EQ(b.halo, 1e-3);
  const Scene relative = make_scene("hopper", {.particles = 100, .vertices = 0});
  EXPECT_DOUBLE_EQ(relative.bodies[2].halo, .05 * relative.bodies[2].sphere_radius);
  EXPECT_EQ(relative.bodies[0].halo, relative.bodies[2].halo);
}

TEST(Scenes, DenseGrainsAreFourFifthsOfTheSpacing) {
  const Scene scene = make_scene("hopper-dense", {.particles = 1000, .vertices = 0});
  EXPECT_DOUBLE_EQ(scene.bodies[2].sphere_radius, .4 * .019);
}

TEST(Scenes, TwoParticlesMeetWhenPublished) {
  const Scene scene = make_scene("two-particles", {.vertices = 0});
  const Body &a = scene.bodies[0], &b = scene.bodies[1];
  const double gap = (a.position - b.position).norm() - a.sphere_radius - b.sphere_radius;
  EXPECT_NEAR(gap / (a.velocity - b.velocity).norm(), 2.68, .01);
  EXPECT_LT(scene.time.step, .01);
}

TEST(Scenes, GasMixesSizesAsAsked) {
  const Scene scene = make_scene("gas", {.particles = 2000, .vertices = 0, .size_ratio = 20});
  double least = 1, most = 0;
  Vector3d mean = Vector3d::Zero();
  for (const Body& b : scene.bodies) {
    if (b.fixed) continue;
    least = std::min(least, b.sphere_radius), most = std::max(most, b.sphere_radius);
    mean += b.velocity / 2000;
    EXPECT_LE(b.velocity.cwiseAbs().maxCoeff(), .1);
  }
  EXPECT_NEAR(most / least, 20, 1);
  EXPECT_LT(mean.norm(), .01);
  EXPECT_EQ(scene.bodies.size(), 2006u);
}

TEST(Scenes, SameSeedSameSceneOtherSeedOtherScene) {
  for (const SceneRow& row : scenes()) {
    const Scene a = make_scene(row.name, {.particles = 20}), b = make_scene(row.name, {.particles = 20}),
                c = make_scene(row.name, {.particles = 20, .seed = 2});
    EXPECT_EQ(a.bodies.back().mesh->vertices, b.bodies.back().mesh->vertices);
    EXPECT_EQ(a.bodies.back().orientation.coeffs(), b.bodies.back().orientation.coeffs());
    EXPECT_EQ(a.bodies.back().position, b.bodies.back().position);
    EXPECT_NE(a.bodies.back().mesh->vertices, c.bodies.back().mesh->vertices) << row.name;
  }
}

TEST(Scenes, SenselessOptionsAreRefused) {
  EXPECT_THROW(make_scene("nowhere", {}), InputError);
  EXPECT_THROW(make_scene("hopper", {.particles = 0}), InputError);
  EXPECT_THROW(make_scene("hopper", {.vertices = 3}), InputError);
  EXPECT_THROW(make_scene("hopper", {.vertices = -1}), InputError);
  EXPECT_THROW(make_scene("hopper", {.halo = "some"}), InputError);
  EXPECT_THROW(make_scene("hopper", {.size_ratio = 2}), InputError);
  EXPECT_THROW(make_scene("gas", {.size_ratio = .5}), InputError);
  EXPECT_THROW(make_scene("gas", {.size_ratio = NAN}), InputError);
}

TEST(SceneFile, EveryShapeAndKeyIsRead) {
  const Scene s = load_scene(data / "every_shape.json");
  EXPECT_EQ(s.name, "every_shape");
  EXPECT_EQ(s.gravity, Vector3d(0, 0, -1.62));
  EXPECT_EQ(s.domain.min, Vector3d(-1, -1, -1));
  EXPECT_EQ(s.domain.size, 2);
  EXPECT_EQ(s.contact.stiffness, 2e4);
  EXPECT_EQ(s.contact.damping_ratio, .25);
  EXPECT_EQ(s.contact.friction, .3);
  EXPECT_EQ(s.contact.tangential_ratio, .5);
  EXPECT_EQ(s.time.step, 2e-6);
  EXPECT_EQ(s.time.end, .5);
  ASSERT_EQ(s.bodies.size(), 12u);
  const Body& box = s.bodies[0];
  EXPECT_EQ(box.mesh->faces.size(), 48u);
  EXPECT_EQ(box.position, Vector3d(.5, 0, 0));
  EXPECT_LT((box.orientation * Vector3d::UnitY() - Vector3d::UnitZ()).norm(), 1e-14); // .7071 made exact
  EXPECT_EQ(box.velocity, Vector3d(1, 2, 3));
  EXPECT_EQ(box.angular_velocity, Vector3d(4, 5, 6));
  EXPECT_EQ(box.density, 2700);
  EXPECT_EQ(box.halo, 1e-3);
  EXPECT_EQ(s.bodies[1].sphere_radius, .05);
  EXPECT_EQ(s.bodies[2].mesh->faces.size(), 320u);
  EXPECT_EQ(s.bodies[3].mesh->vertices, granulate(.1, 40, 18446744073709551615u).vertices);
  EXPECT_EQ(s.bodies[4].mesh->vertices, granulate(.1, 20, 1).vertices);
  for (int i = 5; i < 10; ++i) {
    EXPECT_EQ(s.bodies[i].mesh->faces.size(), 4u);
    EXPECT_NEAR(s.bodies[i].mesh->volume, 1e-3 / 6, 1e-18) << i;
    EXPECT_LT((s.bodies[i].mesh->origin - Vector3d::Constant(.025)).norm(), 1e-16) << i;
  }
  EXPECT_EQ(s.bodies[8].mesh, s.bodies[9].mesh); // equal shapes are kept once
  EXPECT_TRUE(s.bodies[10].fixed && s.bodies[11].fixed);
  EXPECT_EQ(s.bodies[11].mesh->volume, 0);
}

TEST(SceneFile, WhatIsLeftOutHasItsDefault) {
  const Scene s = load_scene(data / "minimal.json"), d;
  EXPECT_EQ(s.gravity, d.gravity);
  EXPECT_EQ(s.contact.stiffness, d.contact.stiffness);
  EXPECT_EQ(s.contact.law, d.contact.law);
  EXPECT_EQ(s.time.step, d.time.step);
  EXPECT_EQ(s.bodies.at(0).density, Body{}.density);
  EXPECT_FALSE(s.bodies[0].fixed);
}

TEST(MeshFile, WrittenAsTextOrBinaryItComesBack) {
  const Mesh m = granulate(2, 20, 4);
  const auto folder = std::filesystem::temp_directory_path() / ("trigrain_mesh_" + std::to_string(::getpid()));
  std::filesystem::create_directory(folder);
  std::ofstream text(folder / "m.stl"), binary(folder / "m.STL", std::ios::binary);
  text.precision(9);
  text << "solid m\n";
  const auto count = static_cast<std::uint32_t>(m.faces.size());
  binary << std::string(80, ' ') << std::string(reinterpret_cast<const char*>(&count), 4);
  const auto put = [&](double value) {
    const float f = static_cast<float>(value);
    binary.write(reinterpret_cast<const char*>(&f), 4);
  };
  for (const auto& face : m.faces) {
    text << "facet normal 0 0 0\n outer loop\n";
    for (int k = 0; k < 3; ++k) put(0);
    for (const int v : face) {
      const Vector3d p = m.in_shape_frame(m.vertices[v]);
      text << "  vertex " << p.x() << ' ' << p.y() << ' ' << p.z() << '\n';
      put(p.x()), put(p.y()), put(p.z());
    }
    text << " endloop\nendfacet\n";
    binary.write("\0", 2);
  }
  text << "endsolid m\n";
  text.close(), binary.close();
  for (const char* name : {"m.stl", "m.STL"}) {
    const Mesh back = load_mesh(folder / name, 3);
    EXPECT_EQ(back.vertices.size(), m.vertices.size()) << name;
    ASSERT_EQ(back.faces.size(), m.faces.size()) << name;
    for (std::size_t f = 0; f < m.faces.size(); ++f)
      for (int k = 0; k < 3; ++k) {
        const Vector3d p = back.in_shape_frame(back.vertices[back.faces[f][k]]);
        EXPECT_LT((p - 3 * m.in_shape_frame(m.vertices[m.faces[f][k]])).norm(), 1e-6) << name;
      }
    EXPECT_NEAR(back.volume, 27 * m.volume, 27e-6 * m.volume) << name; // the files hold floats
    EXPECT_LT((back.origin - 3 * m.origin).norm(), 1e-6) << name;
    EXPECT_LT((back.inertia - 243 * m.inertia).norm(), 1e-6 * back.inertia.norm()) << name;
  }
  std::filesystem::remove_all(folder);
}
