#include "dem/simulation.hpp"
#include <gtest/gtest.h>

namespace trigrain {
namespace {

TEST(Hopper, GrainsFlowThroughLandAndComeToRest) {
  Simulation sim(make_scene("hopper", {.particles = 150, .vertices = 10, .halo = "published"}), {});
  const Particles& p = sim.particles();
  const double start = sim.energy().total();
  std::int64_t crossings = 0;
  double highest = start;
  while (sim.time() < .8) {
    crossings += sim.run(100).crossings;
    highest = std::max(highest, sim.energy().total());
  }
  EXPECT_EQ(crossings, 0) << "surfaces crossed";
  EXPECT_LE(highest, start * (1 + 1e-8)) << "energy grew";
  const double floor_top = .35 + .05 / 2;
  int on_floor = 0, moving = 0;
  for (int i = 0; i < p.size(); ++i) {
    if (p.fixed(i)) continue;
    const bool over_floor = std::abs(p.position[i].x() - .5) < .16 && std::abs(p.position[i].z() - .5) < .16;
    EXPECT_TRUE(over_floor && p.position[i].y() > floor_top) << "grain " << i << " at " << p.position[i].transpose();
    on_floor += p.position[i].y() < .5 - .1333 / 2; // below the outlet
    moving += p.velocity[i].norm() > .05;
  }
  EXPECT_EQ(on_floor, 150);
  EXPECT_LE(moving, 2);
}

} // namespace
} // namespace trigrain
