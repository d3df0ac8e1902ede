#include "dem/simulation.hpp"
#include <cmath>
#include <cstdio>

/// A cube falls freely for a tenth of a second: v = g t, whatever flags this program was compiled with.
int main() {
  trigrain::Scene scene;
  scene.time.step = 1e-4;
  scene.bodies.push_back(
      {.mesh = std::make_shared<const trigrain::Mesh>(trigrain::box({.1, .1, .1})), .position = {.5, .8, .5}});
  trigrain::Simulation simulation(scene, {});
  simulation.run(1000);
  const trigrain::Body body = simulation.particles().body(0);
  std::printf("v = %.15g m/s\n", body.velocity.y());
  return std::abs(body.velocity.y() + .981) < 1e-12 && std::abs(body.orientation.w() - 1) < 1e-12 ? 0 : 1;
}
