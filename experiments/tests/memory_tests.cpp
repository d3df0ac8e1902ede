#include "dem/simulation.hpp"
#include "experiments/memory.hpp"
#include <gtest/gtest.h>
#include <memory>
#include <thread>
#include <vector>

namespace trigrain {
namespace {

TEST(Memory, HeapInUseGrowsByWhatIsHeldAndShrinksAgain) {
  const auto before = heap_in_use();
  if (!before) GTEST_SKIP() << "the C library cannot tell";
  constexpr int blocks = 1000, bytes = 1000, large = 10'000'000;
  {
    std::vector<std::unique_ptr<char[]>> small;
    for (int i = 0; i < blocks; ++i) small.push_back(std::make_unique<char[]>(bytes));
    const std::vector<char> mapped(large);
    const double held = static_cast<double>(*heap_in_use() - *before);
    EXPECT_NEAR(held, blocks * bytes + large, .05 * (blocks * bytes + large));
  }
  EXPECT_NEAR(static_cast<double>(*heap_in_use() - *before), 0, 1e5);
}

TEST(Memory, HeapOfOtherThreadsCounts) {
  const auto before = heap_in_use();
  if (!before) GTEST_SKIP() << "the C library cannot tell";
  std::vector<std::unique_ptr<char[]>> held;
  std::thread([&] {
    for (int i = 0; i < 1000; ++i) held.push_back(std::make_unique<char[]>(1000));
  }).join();
  EXPECT_NEAR(static_cast<double>(*heap_in_use() - *before), 1e6, 1e5);
}

/// Rows of five balls that touch their neighbours: .8 contacts per body.
Scene rows_of_balls(int balls) {
  constexpr double radius = 1e-3, halo = 5e-5;
  Scene scene;
  scene.contact.stiffness = 1e4;
  scene.time = {.step = 1e-7};
  for (int i = 0; i < balls; ++i) {
    Body ball;
    ball.sphere_radius = radius;
    ball.halo = halo;
    ball.position = {.1 + 2.05 * radius * (i % 5), .1 + 5 * radius * (i / 5 % 20), .1 + 5 * radius * (i / 100)};
    scene.bodies.push_back(ball);
  }
  return scene;
}

TEST(Memory, ABodyThatTouchesTakesLessThanAKilobyteBesideItsMesh) {
  constexpr int balls = 4000;
  const Scene scene = rows_of_balls(balls);
  for (const char* grid : {"regular", "adaptive", "reluctant"})
    for (const double skin : {0., .1}) {
      const auto before = heap_in_use();
      if (!before) GTEST_SKIP() << "the C library cannot tell";
      Simulation simulation(scene, {.precheck = "sphere", .grid = grid, .skin = skin});
      EXPECT_EQ(simulation.run(5).contacts, 5 * 4 * balls / 5);
      const double bytes = static_cast<double>(*heap_in_use() - *before) / balls;
      EXPECT_LT(bytes, 1000) << grid << ", skin " << skin;
      EXPECT_GT(bytes, 400) << "so much its motion alone takes";
    }
}

} // namespace
} // namespace trigrain
