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

/// Granulates and spheres of many sizes with halos so wide that they touch; more than any loop hands out at once.
Scene crowd() {
  Scene scene = make_scene("gas", {.particles = 1200, .vertices = 10, .size_ratio = 5, .fill = .9});
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    Body& body = scene.bodies[i];
    if (body.fixed) continue;
    body.halo = 2 * body.mesh->radius;
    if (i % 3 > 0) continue;
    body.sphere_radius = body.mesh->radius;
    body.mesh = nullptr;
  }
  scene.time.force = true; // three steps whose forces do not matter
  return scene;
}

} // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::strcmp(argv[1], "plant") == 0) {
    std::printf("a race was planted: the sum is %d\n", planted_race());
    return 0;
  }
  const Scene scene = crowd();
  int runs = 0;
  std::int64_t contacts = 0;
  for (const Scheme& scheme : schemes())
    for (const char* layers : {"grid", "particle", "triangle", "grid+particle+triangle"})
      for (const char* grid : {"regular", "adaptive"}) {
        Simulation simulation(scene, {.grid = grid,
                                      .scheme = std::string(scheme.name),
                                      .runtime = "openmp",
                                      .layers = layers,
                                      .threads = scheme.name == "serial" ? 1 : 3});
        contacts += simulation.run(3).contacts;
        ++runs;
      }
  std::printf("%d simulations ran; %lld contacts\n", runs, static_cast<long long>(contacts));
  if (contacts == 0) return 1; // loops over them had nothing to do
}
