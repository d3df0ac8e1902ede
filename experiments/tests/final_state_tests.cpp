#include "experiments/atomic_file.hpp"
#include "experiments/final_state.hpp"
#include "kernels/name_table.hpp"
#include <bit>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <random>
#include <unistd.h>

namespace trigrain {
namespace {

namespace fs = std::filesystem;

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

/// A cuboid off its own centre of mass above a fixed floor, and a sphere.
Scene small_scene() {
  Scene scene;
  scene.name = "small";
  const auto cuboid = std::make_shared<const Mesh>(box({.1, .2, .3}));
  scene.bodies.push_back({.mesh = std::make_shared<const Mesh>(plane(1)), .halo = .001, .fixed = true});
  scene.bodies.push_back({.mesh = cuboid, .position = {.3, .5, .4}, .angular_velocity = {1, 2, 3}, .halo = .001});
  scene.bodies.push_back(
      {.mesh = nullptr, .sphere_radius = .05, .position = {.7, .5, .6}, .velocity = {.1, 0, .2}, .halo = .001});
  return scene;
}

struct FinalStateFile : testing::Test {
  fs::path file = fs::path(testing::TempDir()) / ("trigrain_state_" + std::to_string(::getpid()) + ".json");
  void TearDown() override { fs::remove(file); }

  void expect_refused(const std::string& text, const std::string& says) {
    write_atomically(file, text);
    try {
      continued(small_scene(), read_final_state(file), file);
      ADD_FAILURE() << "accepted: " << text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
  }
};

TEST_F(FinalStateFile, every_double_survives_the_round_trip) {
  const unsigned seed = 7;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> exponent(-300, 300), unit(-1, 1);
  const auto wild = [&] { return unit(random) * std::pow(10., exponent(random)); };
  FinalState state{.time = wild(), .energy = {wild(), wild(), wild()}, .bodies = {}, .fixed_bodies = 0};
  for (int i = 0; i < 500; ++i) {
    Body body;
    body.position = {wild(), -0., 5e-324};
    body.orientation = Eigen::Quaterniond(unit(random), unit(random), unit(random), unit(random)).normalized();
    body.velocity = {wild(), wild(), wild()};
    body.angular_velocity = {wild(), wild(), wild()};
    state.bodies.push_back(body);
  }
  write_atomically(file, to_json(state).dump());
  const FinalState found = read_final_state(file);
  ASSERT_EQ(found.bodies.size(), state.bodies.size());
  EXPECT_EQ(bits(found.time), bits(state.time));
  EXPECT_EQ(bits(found.energy.elastic), bits(state.energy.elastic));
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    SCOPED_TRACE("seed " + std::to_string(seed) + ", body " + std::to_string(i));
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(bits(found.bodies[i].position[k]), bits(state.bodies[i].position[k]));
      EXPECT_EQ(bits(found.bodies[i].velocity[k]), bits(state.bodies[i].velocity[k]));
      EXPECT_EQ(bits(found.bodies[i].angular_velocity[k]), bits(state.bodies[i].angular_velocity[k]));
    }
    for (int k = 0; k < 4; ++k)
      EXPECT_EQ(bits(found.bodies[i].orientation.coeffs()[k]), bits(state.bodies[i].orientation.coeffs()[k]));
  }
}

TEST_F(FinalStateFile, a_run_goes_on_where_the_state_was_left) {
  Simulation simulation(small_scene(), {});
  simulation.run(200);
  write_atomically(file, to_json(final_state(simulation)).dump());
  const Scene scene = continued(small_scene(), read_final_state(file), file);
  const Simulation again(scene, {});
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT((again.particles().position[i] - simulation.particles().position[i]).norm(), 1e-15) << i;
    EXPECT_LT((again.particles().velocity[i] - simulation.particles().velocity[i]).norm(), 1e-15) << i;
    EXPECT_LT((again.particles().angular_velocity(i) - simulation.particles().angular_velocity(i)).norm(), 1e-13) << i;
    EXPECT_LT(again.particles().orientation[i].angularDistance(simulation.particles().orientation[i]), 1e-7) << i;
  }
  EXPECT_GT(simulation.particles().velocity[1].norm(), .01) << "something must have moved";
}

TEST_F(FinalStateFile, a_snapshot_starts_twice_with_the_same_bits) {
  Simulation simulation(small_scene(), {});
  simulation.run(50);
  const Scene scene = snapshot(simulation);
  Simulation one(scene, {}), two(scene, {});
  one.run(50);
  two.run(50);
  EXPECT_EQ(one.state_hash(), two.state_hash());
}

TEST_F(FinalStateFile, refuses_a_state_that_is_not_of_this_scene) {
  const Simulation simulation(small_scene(), {});
  const auto good = to_json(final_state(simulation));
  const auto changed = [&](const char* pointer, const nlohmann::ordered_json& value) {
    auto json = good;
    json[nlohmann::ordered_json::json_pointer(pointer)] = value;
    return json.dump();
  };
  auto fewer = good;
  fewer["bodies"].erase(2);
  expect_refused(fewer.dump(), "3 bodies of scene 'small', found 2");
  expect_refused(changed("/fixed_bodies", 2), "fixed_bodies: expected 1");
  expect_refused(changed("/bodies/0/velocity_m_s", {0, 1, 0}), "bodies[0].velocity_m_s");
  expect_refused(changed("/bodies/1/position_m", {0, 1}), "bodies[1].position_m: expected 3 numbers");
  expect_refused(changed("/bodies/1/position_m", {0, 1, "x"}), "bodies[1].position_m: expected 3 numbers");
  expect_refused(changed("/bodies/2/orientation_wxyz", {1, 1, 0, 0}), "unit quaternion");
  expect_refused(changed("/time_s", "now"), "time_s: expected a number");
  expect_refused(changed("/bodies", 5), "bodies: expected an array");
  expect_refused("{", "JSON");
  expect_refused("[]", "time_s");
}

TEST_F(FinalStateFile, a_missing_file_is_an_input_error) { EXPECT_THROW(read_final_state(file), InputError); }

} // namespace
} // namespace trigrain
