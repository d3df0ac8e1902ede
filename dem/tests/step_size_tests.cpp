#include "dem/simulation.hpp"
#include "dem/step_size.hpp"
#include <cmath>
#include <gtest/gtest.h>

namespace trigrain {
namespace {

using Eigen::Vector3d;

/// An elastic ball of radius .01 m falls .1 m onto a thin floor at y = 0: impact at 1.4 m/s, halos of .5 mm in all.
Scene bouncing_ball(std::string control) {
  Scene scene;
  scene.domain = {.min = {-1, -1, -1}, .size = 2};
  scene.contact.damping_ratio = scene.contact.friction = 0;
  Body floor;
  floor.mesh = std::make_shared<Mesh>(plane(1));
  floor.fixed = true;
  floor.halo = 2.5e-4;
  Body ball;
  ball.sphere_radius = .01;
  ball.position = {0, .11, 0};
  ball.halo = 2.5e-4;
  scene.bodies = {floor, ball};
  const double mass = 4. / 3. * M_PI * 1e-3;
  scene.contact.stiffness = mass * std::pow(2 * 1.4 / 5e-4, 2); // V_max is twice the speed of the impact
  scene.time.step = M_PI * std::sqrt(mass / scene.contact.stiffness) / 40.3;
  scene.time.control = std::move(control);
  return scene;
}

struct Bounces {
  std::int64_t steps = 0, contact_steps = 0, crossings = 0;
  double lowest = 1, energy_error = 0, longest_step = 0;
};

Bounces bounce(const Scene& scene, double seconds, const std::string& grid = "adaptive") {
  Simulation sim(scene, {.grid = grid});
  Bounces b;
  const double floor_energy = sim.particles().mass[1] * 9.81 * .01, start = sim.energy().total() - floor_energy;
  while (sim.time() < seconds) {
    const StepStats s = sim.step();
    b.steps += s.steps;
    b.contact_steps += s.contacts > 0;
    b.crossings += s.crossings;
    b.lowest = std::min(b.lowest, sim.particles().position[1].y());
    b.longest_step = std::max(b.longest_step, sim.step_size());
    if (s.contacts == 0) b.energy_error = std::abs(sim.energy().total() - floor_energy - start) / start;
  }
  return b;
}

TEST(StepSize, FixedIsTheScenesStep) {
  const Scene scene = bouncing_ball("fixed");
  EXPECT_DOUBLE_EQ(bounce(scene, .2).longest_step, scene.time.step);
}

TEST(StepSize, ApproachNeverCrossesAndNeedsAQuarterOfTheStepsAtEqualEnergyError) {
  const Bounces fixed = bounce(bouncing_ball("fixed"), 2);
  for (const char* grid : {"none", "regular", "adaptive", "reluctant"}) {
    Scene scene = bouncing_ball("approach");
    scene.time.step /= 4;
    const Bounces b = bounce(scene, 2, grid);
    EXPECT_EQ(b.crossings, 0);
    EXPECT_GT(b.lowest, .01) << "the surfaces crossed";
    EXPECT_GT(b.contact_steps, 5 * 150) << "at least five impacts of 161 steps";
    EXPECT_LE(b.energy_error, fixed.energy_error) << grid;
    EXPECT_LT(b.steps * 4, fixed.steps) << grid;
    RecordProperty(grid, std::to_string(b.steps) + " steps of " + std::to_string(fixed.steps));
  }
}

/// A hundred elastic bounces: if all contacts began at one phase of a step, their errors would add up to 13 %.
TEST(StepSize, ContactsBeginAtAnyPhaseSoThatErrorsDoNotAddUp) {
  for (const double height : {.11, .112, .115}) {
    Scene scene = bouncing_ball("approach");
    scene.bodies[1].position.y() = height;
    const Bounces b = bounce(scene, 28);
    EXPECT_LT(b.energy_error, .02) << "from " << height;
  }
}

TEST(StepSize, DampedImpactsAfterLongStepsGainNoEnergy) {
  for (const char* grid : {"none", "regular", "regular-dense", "adaptive", "reluctant"}) {
    Scene scene = make_scene("two-particles", {.vertices = 0});
    scene.time.control = "approach";
    Simulation sim(scene, {.grid = grid});
    const double before = sim.energy().kinetic;
    double longest_step = 0;
    std::int64_t contacts = 0;
    while (sim.time() < 4) {
      contacts += sim.step().contacts;
      longest_step = std::max(longest_step, sim.step_size());
    }
    EXPECT_GT(longest_step, 100 * scene.time.step) << grid;
    EXPECT_GT(contacts, 5) << grid << ": an impact takes more than one step";
    EXPECT_LT(sim.energy().kinetic, before) << grid;
    EXPECT_LT(sim.particles().velocity[0].norm(), .6) << grid << ": it meets a wall that moves at .17 m/s";
  }
}

TEST(StepSize, ApproachSeesTheSpeedOfATurningRod) {
  Scene scene = bouncing_ball("approach");
  scene.gravity.setZero();
  scene.bodies[1].mesh = std::make_shared<Mesh>(box({.2, .01, .01}));
  scene.bodies[1].position = {0, .12, 0};
  scene.bodies[1].angular_velocity = {0, 0, 5}; // the ends move at .5 m/s, the centre rests
  Simulation sim(scene, {.grid = "adaptive"});
  sim.run(2000);
  const double gap = .12 - .1 - .005;
  EXPECT_LE(sim.step_size() * 5 * sim.particles().radius[1], gap);
}

TEST(StepSize, GapOnlyAsPublishedLetsAFastBodyThrough) {
  const Bounces b = bounce(bouncing_ball("gap-only"), .5);
  EXPECT_LT(b.lowest, 0) << "the failing baseline no longer fails";
}

TEST(StepSize, ApproachKeepsTheGrainsOfAHopperApart) {
  Scene scene = make_scene("hopper", {.particles = 64, .vertices = 10, .halo = "published"});
  scene.time.control = "approach";
  Simulation sim(scene, {.grid = "adaptive"});
  std::int64_t crossings = 0, steps = 0;
  while (sim.time() < .4) {
    const StepStats s = sim.step();
    crossings += s.crossings;
    steps += s.steps;
  }
  EXPECT_EQ(crossings, 0);
  EXPECT_LT(static_cast<double>(steps), .4 / scene.time.step);
}

} // namespace
} // namespace trigrain
