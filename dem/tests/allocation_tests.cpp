#include "dem/simulation.hpp"
#include <atomic>
#include <cstdlib>
#include <gtest/gtest.h>
#include <new>

namespace {
std::atomic<bool> counting = false;
std::atomic<int> allocations = 0;

void* counted(std::size_t size, std::size_t alignment) {
  if (counting) ++allocations;
  const std::size_t whole = (size + alignment - 1) / alignment * alignment;
  if (void* memory = std::aligned_alloc(alignment, whole > 0 ? whole : alignment)) return memory;
  throw std::bad_alloc();
}
} // namespace

// Every allocation of this program but those of the runtimes, which have memory pools of their own.
void* operator new(std::size_t size) { return counted(size, alignof(std::max_align_t)); }
void* operator new(std::size_t size, std::align_val_t a) { return counted(size, static_cast<std::size_t>(a)); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace trigrain {
namespace {

/// Grains that lie crowded and at rest but for their contacts: no step has more of anything than the one before.
Scene crowd() {
  Scene scene = make_scene("hopper", {.particles = 150, .vertices = 10, .halo = "published"});
  Simulation sim(scene, {});
  while (sim.time() < .15) sim.step();
  for (int i = 0; i < sim.particles().size(); ++i) {
    scene.bodies[i] = sim.particles().body(i);
    scene.bodies[i].velocity = scene.bodies[i].angular_velocity = {0, 0, 0};
  }
  return scene;
}

TEST(Allocation, AStepTakesNoMemoryOnceItHasRun) {
  struct Case {
    const char *scheme, *runtime, *layers;
    int threads; // where the runtime always gives the same work to the same thread
  };
  const Scene scene = crowd();
  for (const auto& [scheme, runtime, layers, threads] :
       {Case{"serial", "default", "none", 1}, Case{"plain", "openmp", "grid", 1}, Case{"plain", "openmp", "grid", 3},
        Case{"plain", "openmp", "grid+particle+triangle", 2}, Case{"plain", "tbb", "grid", 1},
        Case{"task", "openmp", "grid+particle+triangle", 1}, Case{"task", "tbb", "grid+particle", 1}})
    for (const char* grid : {"regular", "adaptive"}) {
      Simulation sim(scene, {.grid = grid, .scheme = scheme, .runtime = runtime, .layers = layers, .threads = threads});
      ASSERT_GT(sim.run(10).contacts, 100) << "the test needs contacts";
      allocations = 0;
      counting = true;
      sim.run(5);
      counting = false;
      EXPECT_EQ(allocations, 0) << scheme << " " << runtime << " " << layers << " " << threads << " " << grid;
    }
}

} // namespace
} // namespace trigrain
