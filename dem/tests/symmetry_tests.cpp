#include "dem/random.hpp"
#include "dem/simulation.hpp"
#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <numbers>

namespace trigrain {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double edge = .1, halo = 1e-3;

/// Vertices and faces as they come from a file; none for balls.
struct Shape {
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> faces;
};

Shape shape_of(const Mesh& mesh) {
  Shape shape{{}, mesh.faces};
  for (const Vector3d& x : mesh.vertices) shape.vertices.push_back(mesh.in_shape_frame(x));
  return shape;
}

/// Balls, cubes and granulates thrown together on a block: faces, edges and corners meet, slide and stick.
struct Heap {
  Scene scene;
  std::vector<Shape> shapes;
};

Heap heap() {
  Heap all;
  Scene& scene = all.scene;
  scene.name = "heap";
  scene.domain = {.min = Vector3d::Constant(-2), .size = 4};
  scene.gravity = {.5, -9.81, .7};
  scene.contact = {.stiffness = 1e6, .damping_ratio = .3, .friction = .4};
  scene.time.step = 1e-5;
  Random random(7);
  for (int i = 0; i < 9; ++i) {
    const Mesh mesh = i == 0 ? box({.6, .1, .6}) : i % 2 ? box({edge, edge, edge}) : granulate(edge, 20, 30 + i);
    Body body;
    body.halo = halo, body.fixed = i == 0;
    body.sphere_radius = i % 4 == 3 ? edge / 2 : 0;
    all.shapes.push_back(body.sphere_radius > 0 ? Shape{} : shape_of(mesh));
    if (i > 0) {
      body.position = {.13 * (i % 2 - .5), .12 + .13 * (i / 4), .13 * (i / 2 % 2 - .5)};
      body.orientation = random.rotation();
      body.velocity = Vector3d(0, -1, 0) - 6 * Vector3d(body.position.x(), 0, body.position.z());
      body.angular_velocity = 5 * random.direction();
    }
    scene.bodies.push_back(body);
  }
  return all;
}

/// The bodies, in the shapes' own frames, after thousands of steps with impacts.
std::vector<Body> after(const Heap& heap) {
  Scene scene = heap.scene;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (!heap.shapes[i].vertices.empty())
      scene.bodies[i].mesh = std::make_shared<Mesh>(make_mesh("shape", heap.shapes[i].vertices, heap.shapes[i].faces));
  Simulation sim(scene, {});
  EXPECT_GT(sim.run(2500).contacts, 1000);
  std::vector<Body> bodies;
  for (int i = 0; i < sim.particles().size(); ++i) bodies.push_back(sim.particles().body(i));
  return bodies;
}

/// Largest difference of positions (edges) and velocities (m/s) of bodies.
double difference(const std::vector<Body>& a, const std::vector<Body>& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    most = std::max(most, (a[i].position - b[i].position).norm() / edge);
    most = std::max(most, (a[i].velocity - b[i].velocity).norm());
    most = std::max(most, edge * (a[i].angular_velocity - b[i].angular_velocity).norm());
  }
  return most;
}

constexpr double round_off = 1e-10; ///< what it has grown to after some impacts

/// The body in a world turned by q.
Body turned(Body body, const Quaterniond& q) {
  body.position = q * body.position;
  body.orientation = q * body.orientation;
  body.velocity = q * body.velocity;
  body.angular_velocity = q * body.angular_velocity;
  return body;
}

/// The body behind the mirror x = 0; its shape is mirrored too.
Body mirrored(Body body) {
  const Vector3d flip(-1, 1, 1);
  const Quaterniond q = body.orientation;
  body.position = body.position.cwiseProduct(flip);
  body.orientation = Quaterniond(q.w(), q.x(), -q.y(), -q.z());
  body.velocity = body.velocity.cwiseProduct(flip);
  body.angular_velocity = -body.angular_velocity.cwiseProduct(flip);
  return body;
}

void all_bodies(std::vector<Body>& bodies, const std::function<Body(Body)>& change) {
  for (Body& body : bodies) body = change(body);
}

TEST(Symmetry, ATurnedSceneMovesTheSame) {
  const std::vector<Body> expected = after(heap());
  for (const Quaterniond& q : {Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitZ())),
                               Quaterniond(Eigen::AngleAxisd(1, Vector3d(1, 2, -3).normalized()))}) {
    Heap other = heap();
    other.scene.gravity = q * other.scene.gravity;
    all_bodies(other.scene.bodies, [&](const Body& b) { return turned(b, q); });
    std::vector<Body> found = after(other);
    all_bodies(found, [&](const Body& b) { return turned(b, q.conjugate()); });
    EXPECT_LT(difference(expected, found), round_off);
  }
}

TEST(Symmetry, AMirroredSceneMovesTheSame) {
  const std::vector<Body> expected = after(heap());
  Heap other = heap();
  other.scene.gravity.x() *= -1;
  all_bodies(other.scene.bodies, mirrored);
  for (Shape& shape : other.shapes) {
    for (Vector3d& x : shape.vertices) x.x() *= -1;
    for (auto& face : shape.faces) std::swap(face[1], face[2]);
  }
  std::vector<Body> found = after(other);
  all_bodies(found, mirrored);
  EXPECT_LT(difference(expected, found), round_off);
}

TEST(Symmetry, TheOrderOfBodiesDoesNotMatter) {
  const std::vector<Body> expected = after(heap());
  Heap other = heap();
  std::reverse(other.scene.bodies.begin(), other.scene.bodies.end());
  std::reverse(other.shapes.begin(), other.shapes.end());
  std::vector<Body> found = after(other);
  std::reverse(found.begin(), found.end());
  EXPECT_LT(difference(expected, found), round_off);
}

TEST(Symmetry, TheOrderOfVerticesAndTrianglesDoesNotMatter) {
  const std::vector<Body> expected = after(heap());
  Heap other = heap();
  for (Shape& shape : other.shapes) {
    const int n = static_cast<int>(shape.vertices.size());
    std::reverse(shape.vertices.begin(), shape.vertices.end());
    for (auto& face : shape.faces) face = {n - 1 - face[1], n - 1 - face[2], n - 1 - face[0]};
    if (n > 0) std::rotate(shape.faces.begin(), shape.faces.begin() + n / 2, shape.faces.end());
  }
  EXPECT_LT(difference(expected, after(other)), round_off);
}

} // namespace
} // namespace trigrain
