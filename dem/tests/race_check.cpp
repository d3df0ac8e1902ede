// Every scheme and layer on the OpenMP runtime, a few steps each, to be run under ThreadSanitizer (tools/race). With
// "plant" it first makes a race of its own, which must be found.
#include "dem/scene.hpp"
#include "dem/simulation.hpp"
#include <cstdio>
#include <cstring>

using namespace trigrain;

namespace {

/// Two workers add to one number without asking each other.
int planted_race() {
  const Runtime* openmp = nullptr;
  for (const Runtime& row : runtimes())
    if (row.name == "openmp") openmp = &row;
  Team team(*openmp, 2);
  int sum = 0;
  team.parallel_for(1000, 1, [&](int begin, int end, int) { sum += end - begin; });
  return sum;
}

} // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::strcmp(argv[1], "plant") == 0) {
    std::printf("a race was planted: the sum is %d\n", planted_race());
    return 0;
  }
  int runs = 0;
  for (const Scheme& scheme : schemes())
    for (const char* layers : {"grid", "particle", "triangle", "grid+particle+triangle"})
      for (const char* grid : {"regular", "adaptive"}) {
        Simulation simulation(make_scene("hopper-dense", {.particles = 60, .vertices = 12}),
                              {.grid = grid,
                               .scheme = std::string(scheme.name),
                               .runtime = "openmp",
                               .layers = layers,
                               .threads = scheme.name == "serial" ? 1 : 3});
        simulation.run(3);
        ++runs;
      }
  std::printf("%d simulations ran\n", runs);
}
