#include "experiments/verify.hpp"
#include "kernels/name_table.hpp"
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace trigrain {
namespace {

const Kernel& brute() { return kernel_named("brute"); }

Scene two_granulates() {
  Scene scene;
  scene.name = "two";
  const auto mesh = std::make_shared<const Mesh>(granulate(.02, 20, 3));
  scene.bodies.push_back({.mesh = mesh, .position = {.49, .5, .5}, .velocity = {.1, 0, 0}, .halo = .0005});
  scene.bodies.push_back({.mesh = mesh, .position = {.51, .5, .5}, .velocity = {-.1, 0, 0}, .halo = .0005});
  return scene;
}

std::vector<TriangleBlock> blocks() {
  Simulation simulation(two_granulates(), {});
  simulation.step();
  return sample_triangle_pairs(simulation, 2048, 1);
}

/// Brute force's hits, each changed, or left out where `change` says false.
template <class Change>
void brute_changed(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts, Change change) {
  Hits right;
  brute().closest(list, query, right, counts);
  for (int k = 0; k < right.size(); ++k)
    if (Hit hit = right[k]; change(hit)) hits.push_back(hit);
}

// Kernels with one fault each.

void distances_off(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts) {
  brute_changed(list, query, hits, counts, [](Hit& hit) {
    if (hit.i == 3 && hit.j == 3) hit.closest.distance *= 1 + 1e-9;
    return true;
  });
}
void points_off(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts) {
  brute_changed(list, query, hits, counts, [](Hit& hit) {
    hit.closest.p.x += 1e-9;
    return true;
  });
}
void last_row_left_out(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts) {
  brute_changed(list, query, hits, counts, [&](Hit& hit) { return hit.i != list.a.size - 1; });
}
void contacts_lost(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts) {
  brute().closest(list, {.reach = std::isfinite(query.reach) ? .6 * query.reach : query.reach}, hits, counts);
}
void not_a_number(const PairList& list, const Query& query, Hits& hits, KernelCounts& counts) {
  brute_changed(list, query, hits, counts, [](Hit& hit) {
    hit.closest.distance = std::nan("");
    return true;
  });
}

TEST(Verify, a_wrong_kernel_is_caught) {
  const auto sample = blocks();
  struct Fault {
    const char* name;
    KernelFunction closest;
  };
  for (const Fault& fault : {Fault{"distances_off", distances_off}, Fault{"points_off", points_off},
                             Fault{"last_row_left_out", last_row_left_out}, Fault{"contacts_lost", contacts_lost},
                             Fault{"not_a_number", not_a_number}}) {
    Kernel wrong = brute();
    wrong.name = fault.name;
    wrong.closest = fault.closest;
    const CheckItem item = check_kernel(wrong, brute(), sample);
    EXPECT_FALSE(item.passed) << fault.name << ": " << item.detail;
  }
  EXPECT_TRUE(check_kernel(brute(), brute(), sample).passed);
}

TEST(Verify, the_sample_holds_near_and_far_pairs) {
  std::int64_t pairs = 0, near = 0;
  for (const TriangleBlock& block : blocks()) {
    Hits hits;
    KernelCounts counts;
    closest_of_all(brute(), block.a.view(), block.b.view(), {.reach = block.reach}, hits, counts);
    near += hits.size();
    pairs += block.a.size() * block.b.size();
  }
  EXPECT_GE(pairs, 2048);
  EXPECT_GE(near, 10);
  EXPECT_LE(near, pairs / 2);
}

TEST(Verify, the_same_seed_gives_the_same_sample) {
  const auto one = blocks(), two = blocks();
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    ASSERT_EQ(one[i].b.size(), two[i].b.size());
    for (int j = 0; j < one[i].b.size(); ++j) EXPECT_EQ(one[i].b.view()[j].a0.x, two[i].b.view()[j].a0.x);
  }
}

TEST(Verify, the_sample_is_in_the_frame_of_the_first_body) {
  Scene scene = two_granulates();
  scene.bodies[0].orientation = Eigen::AngleAxisd(1, Eigen::Vector3d(1, 2, 3).normalized());
  scene.bodies[1].orientation = Eigen::AngleAxisd(2, Eigen::Vector3d(3, -1, 1).normalized());
  const Simulation simulation(scene, {});
  const Particles& p = simulation.particles();
  const auto is_vertex = [&](int body, const Vec3<double>& x) { // x in the first body's frame
    const Eigen::Vector3d world = p.position[0] + p.orientation[0] * Eigen::Vector3d(x.x, x.y, x.z);
    const Eigen::Vector3d local = p.to_body(body, world);
    const auto& vertices = p.mesh[body]->vertices;
    return std::any_of(vertices.begin(), vertices.end(), [&](const auto& v) { return (v - local).norm() < 1e-14; });
  };
  const auto sample = sample_triangle_pairs(simulation, 512, 5);
  ASSERT_GE(sample.size(), 2u);
  for (std::size_t k = 0; k < sample.size(); k += 2) { // the others were moved nearer
    for (int i = 0; i < sample[k].a.size(); ++i) EXPECT_TRUE(is_vertex(0, sample[k].a.view()[i].a1)) << k << ", " << i;
    for (int j = 0; j < sample[k].b.size(); ++j) EXPECT_TRUE(is_vertex(1, sample[k].b.view()[j].a1)) << k << ", " << j;
  }
}

TEST(Verify, a_wrong_hash_is_caught) {
  Options options;
  options.scheme = "task";
  options.threads = 2;
  const auto good = [](const Options&) -> std::uint64_t { return 7; };
  const auto wrong_scheme = [](const Options& o) -> std::uint64_t { return o.scheme == "serial" ? 7 : 8; };
  const auto wrong_grid = [](const Options& o) -> std::uint64_t { return o.grid == "none" ? 7 : 8; };
  EXPECT_TRUE(check_scheme(options, good).passed);
  EXPECT_TRUE(check_grid(options, good).passed);
  EXPECT_FALSE(check_scheme(options, wrong_scheme).passed);
  EXPECT_FALSE(check_grid(options, wrong_grid).passed);
  EXPECT_TRUE(check_scheme(options, wrong_grid).passed) << "everything but the scheme must stay equal";
}

TEST(Verify, one_failed_item_fails_the_check) {
  Check check;
  check.how = {{"a", true, ""}, {"b", true, ""}};
  EXPECT_TRUE(check.passed());
  check.how.push_back({"c", false, ""});
  EXPECT_FALSE(check.passed());
}

TEST(Verify, a_state_that_is_not_finite_is_caught) {
  Particles particles;
  for (const Body& body : two_granulates().bodies) particles.add(body);
  EXPECT_TRUE(check_state(particles).passed);
  Particles broken = particles;
  broken.velocity[1].y() = std::nan("");
  EXPECT_FALSE(check_state(broken).passed);
  broken = particles;
  broken.orientation[0].w() += 1e-6;
  EXPECT_FALSE(check_state(broken).passed);
}

TEST(Verify, bodies_outside_are_counted_but_not_fixed_ones) {
  Scene scene = two_granulates();
  scene.bodies[0].position = {.5, -.01, .5};
  scene.bodies.push_back({.mesh = std::make_shared<const Mesh>(plane(1)), .position = {0, -3, 0}, .fixed = true});
  Particles particles;
  for (const Body& body : scene.bodies) particles.add(body);
  EXPECT_EQ(bodies_outside(particles, scene.domain), 1);
}

TEST(Verify, spheres_alone_need_no_kernel) {
  Scene scene;
  scene.bodies.push_back({.mesh = nullptr, .sphere_radius = .1, .position = {.2, .2, .2}, .halo = .01});
  scene.bodies.push_back({.mesh = nullptr, .sphere_radius = .1, .position = {.8, .8, .8}, .halo = .01});
  const auto none = sample_triangle_pairs(Simulation(scene, {}), 2048, 1);
  EXPECT_TRUE(none.empty());
  EXPECT_TRUE(check_kernel(brute(), brute(), none).passed);
}

TEST(Verify, a_good_engine_passes_every_check) {
  const Check check = verify(two_granulates(), {}, 20);
  for (const CheckItem& item : check.how) EXPECT_TRUE(item.passed) << item.what << ": " << item.detail;
  EXPECT_EQ(check.how.size(), 4u);
}

} // namespace
} // namespace trigrain
