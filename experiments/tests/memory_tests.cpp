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

} // namespace
} // namespace trigrain
