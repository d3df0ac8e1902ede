#include "dem/critical_step.hpp"
#include "dem/grid_kind.hpp"
#include "dem/simulation.hpp"
#include "kernels/name_table.hpp"
#include <array>
#include <cmath>
#include <gtest/gtest.h>

namespace trigrain {
namespace {

using Eigen::Vector3d;

/// A hopper of `grains` granulates in the midst of its flow: many grains touch each other and the walls.
Scene flowing_hopper(int grains) {
  Scene scene = make_scene("hopper", {.particles = grains, .vertices = 10, .halo = "published"});
  Simulation sim(scene, {});
  while (sim.time() < .2) sim.step();
  for (int i = 0; i < sim.particles().size(); ++i) scene.bodies[i] = sim.particles().body(i);
  return scene;
}

/// Granulates and spheres of many sizes among walls, with halos so wide that many touch: more than any loop hands out
/// at once. Its forces are for a few steps only.
Scene crowd() {
  Scene scene = make_scene("gas", {.particles = 1500, .vertices = 10, .size_ratio = 5, .fill = .9});
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    Body& body = scene.bodies[i];
    if (body.fixed) continue;
    body.halo = body.mesh->radius;
    if (i % 2 == 0) continue;
    body.sphere_radius = body.mesh->radius;
    body.mesh = nullptr;
  }
  scene.contact.damping_ratio = scene.contact.friction = .3;
  scene.time.force = true;
  return scene;
}

/// What must be the same whoever does it.
struct Outcome {
  std::uint64_t hash;
  std::int64_t contacts, candidate_pairs, body_pairs, triangle_pairs;
  bool operator==(const Outcome&) const = default;
};

Outcome outcome(const Scene& scene, const Options& options, int steps) {
  Simulation sim(scene, options);
  const StepStats stats = sim.run(steps);
  return {sim.state_hash(), stats.contacts, stats.candidate_pairs, stats.body_pairs, stats.triangle_pairs};
}

TEST(Simulation, EverySchemeLayerRuntimeAndThreadCountGivesTheSameBits) {
  const Scene hopper = flowing_hopper(200), many = crowd();
  struct Case {
    const Scene& scene;
    const char *rule, *precheck;
    int steps;
  };
  // Without a pre-check all body pairs are split into parts.
  for (const auto& [scene, rule, precheck, steps] :
       {Case{hopper, "features", "sphere", 5}, Case{hopper, "all-pairs", "box", 3}, Case{hopper, "features", "none", 1},
        Case{many, "features", "box", 2}}) {
    const Outcome serial = outcome(scene, {.precheck = precheck, .contact_rule = rule, .scheme = "serial"}, steps);
    ASSERT_GT(serial.contacts, 10 * steps) << "the test needs contacts";
    for (const Scheme& scheme : schemes())
      for (const char* layers : {"none", "grid", "particle", "triangle", "grid+particle", "grid+triangle",
                                 "particle+triangle", "grid+particle+triangle"})
        for (const char* runtime : {"openmp", "tbb"})
          for (const int threads : {1, 2, 3, 5}) {
            if (scheme.name == "serial" && threads > 1) continue;
            const Options options{.precheck = precheck,
                                  .contact_rule = rule,
                                  .scheme = std::string(scheme.name),
                                  .runtime = runtime,
                                  .layers = layers,
                                  .threads = threads};
            EXPECT_EQ(outcome(scene, options, steps), serial)
                << rule << " " << precheck << " " << scheme.name << " " << layers << " " << runtime << " " << threads;
          }
  }
}

TEST(Simulation, BooksAndTheStepLimitHaveTheSameBitsForEveryTeam) {
  const Scene scene = crowd();
  const auto sums = [&](const char* runtime, int threads) {
    Simulation sim(scene, {.scheme = "plain", .runtime = runtime, .threads = threads});
    sim.run(3);
    const Energy e = sim.energy();
    const Momentum m = sim.momentum_error();
    return std::array{e.damping, e.friction, m.linear.y(), m.angular.x(), sim.contact_step_limit()};
  };
  const auto serial = sums("openmp", 1);
  ASSERT_GT(serial[0], 0) << "the test needs contacts";
  ASSERT_LT(serial[4], 1);
  for (const char* runtime : {"openmp", "tbb"})
    for (const int threads : {2, 3, 5}) EXPECT_EQ(sums(runtime, threads), serial) << runtime << " " << threads;
}

TEST(Simulation, GridsAndPrechecksChangeTheWorkAndNotTheResult) {
  const Scene scene = flowing_hopper(60);
  Simulation reference(scene, {.kernel = "brute", .precheck = "none", .grid = "none"});
  const StepStats all = reference.run(5);
  for (const GridKind& grid : grid_kinds())
    for (const Precheck& precheck : prechecks())
      for (const int k : {2, 3}) {
        Simulation sim(scene, {.kernel = "brute",
                               .precheck = std::string(precheck.name),
                               .grid = std::string(grid.name),
                               .subdivision = k});
        const StepStats stats = sim.run(5);
        EXPECT_EQ(sim.state_hash(), reference.state_hash()) << grid.name << " " << precheck.name << " " << k;
        EXPECT_EQ(stats.contacts, all.contacts);
        EXPECT_LE(stats.triangle_pairs, all.triangle_pairs);
      }
}

TEST(Simulation, TheSameSeedGivesTheSameBitsAndAnotherSeedOthers) {
  const auto hash = [](std::uint64_t seed) {
    Simulation sim(make_scene("hopper", {.particles = 50, .vertices = 10, .seed = seed}), {});
    sim.run(20);
    return sim.state_hash();
  };
  EXPECT_EQ(hash(1), hash(1));
  EXPECT_NE(hash(1), hash(2));
}

/// A cube of edge .1 m above a wide floor at y = 0, tilted about a skew axis.
Scene tilted_cube() {
  Scene scene;
  scene.contact = {.stiffness = 2e6, .damping_ratio = .5, .friction = .5};
  scene.time.step = 2e-5;
  scene.domain = {.min = {-1, -1, -1}, .size = 2};
  Body floor;
  floor.mesh = std::make_shared<Mesh>(plane(2));
  floor.fixed = true;
  floor.halo = 1e-3;
  Body cube;
  cube.mesh = std::make_shared<Mesh>(box({.1, .1, .1}));
  cube.position = {0, .12, 0};
  cube.orientation = Eigen::AngleAxisd(.5, Vector3d(1, .2, .4).normalized());
  cube.halo = 1e-3;
  scene.bodies = {floor, cube};
  return scene;
}

TEST(Simulation, ATiltedCubeDroppedOnAPlaneComesToRestOnAFace) {
  for (const ContactRule& rule : contact_rules()) {
    Simulation sim(tilted_cube(), {.contact_rule = std::string(rule.name)});
    const double start = sim.energy().total();
    while (sim.time() < 2) sim.step();
    const Particles& p = sim.particles();
    // 9.81 N on 2e6 N/m: at most 4.9 um of the halos' 2 mm are pressed in.
    EXPECT_GT(p.position[1].y(), .05 + 2e-3 - 9.81 / 2e6 - 1e-6) << rule.name;
    EXPECT_LT(p.position[1].y(), .05 + 2e-3) << rule.name;
    const Eigen::Matrix3d r = p.orientation[1].toRotationMatrix();
    EXPECT_NEAR(r.row(1).cwiseAbs().maxCoeff(), 1, 1e-4) << rule.name << ": one face lies flat";
    EXPECT_LT(p.velocity[1].norm(), 1e-2) << rule.name;
    EXPECT_LT(p.angular_velocity(1).norm(), 1e-1) << rule.name;
    EXPECT_LT(sim.energy().total(), start);
  }
}

TEST(Simulation, FreeFallFollowsTheParabola) {
  Scene scene = tilted_cube();
  scene.bodies.erase(scene.bodies.begin());
  Simulation sim(scene, {});
  sim.run(1000);
  const double t = sim.time(), h = scene.time.step;
  // Symplectic Euler falls g t h / 2 farther than the exact parabola.
  EXPECT_NEAR(sim.particles().position[0].y(), .12 - 9.81 * t * t / 2 - 9.81 * t * h / 2, 1e-12);
}

TEST(Simulation, LoadsFromOutsideActForOneStep) {
  Scene scene = tilted_cube();
  scene.gravity = {0, 0, 0};
  Simulation sim(scene, {});
  sim.add_load(1, {3, 0, 0}, {0, 0, .1});
  sim.run(5);
  EXPECT_NEAR(sim.particles().velocity[1].x(), 3 / 1. * scene.time.step, 1e-15);
  EXPECT_NEAR(sim.particles().angular_momentum[1].z(), .1 * scene.time.step, 1e-15);
}

TEST(Simulation, ElasticImpactsConserveMomentumAndEnergyAndDampedOnesLoseEnergy) {
  for (const double zeta : {0., .3}) {
    Scene scene = make_scene("gas", {.particles = 30, .vertices = 10});
    std::erase_if(scene.bodies, [](const Body& b) { return b.fixed; });
    scene.gravity = {0, 0, 0};
    scene.contact.damping_ratio = zeta;
    scene.contact.friction = 0;
    for (Body& b : scene.bodies) b.velocity = (Vector3d::Constant(.5) - b.position) * 2; // all meet in the middle
    scene.contact.stiffness *= 400; // the scene's own is meant for slower bodies
    scene.time.step /= 30;          // the onset of a contact inside a step adds energy of order step^2
    Simulation sim(scene, {});
    Vector3d momentum = Vector3d::Zero(), spin = Vector3d::Zero();
    const auto add_up = [&] {
      const Particles& p = sim.particles();
      momentum = spin = Vector3d::Zero();
      for (int i = 0; i < p.size(); ++i) {
        momentum += p.mass[i] * p.velocity[i];
        spin += p.mass[i] * p.position[i].cross(p.velocity[i]) + p.angular_momentum[i];
      }
    };
    add_up();
    const Vector3d momentum0 = momentum, spin0 = spin;
    const double e0 = sim.energy().total(), scale = std::sqrt(2 * e0 * sim.particles().mass[0]);
    std::int64_t contacts = 0;
    double e = e0;
    while (sim.time() < .35) {
      contacts += sim.step().contacts;
      e = sim.energy().total();
      if (zeta > 0) {
        ASSERT_LT(e, e0 * 1.0002);
      }
    }
    add_up();
    EXPECT_GT(contacts, 100);
    EXPECT_LT((momentum - momentum0).norm(), 1e-11 * scale);
    EXPECT_LT((spin - spin0).norm(), 1e-9 * scale);
    if (zeta == 0)
      EXPECT_NEAR(e, e0, .05 * e0);
    else
      EXPECT_LT(e, .9 * e0);
  }
}

TEST(Simulation, TheBooksOfEnergyAndMomentumBalance) {
  Simulation sim(tilted_cube(), {});
  const double start = sim.energy().balance();
  while (sim.time() < .5) {
    if (sim.time() > .2 && sim.time() < .21) sim.add_load(1, {3, 1, 0}, {0, .02, .01});
    sim.step();
  }
  const Energy e = sim.energy();
  EXPECT_GT(e.damping, .1);
  EXPECT_GT(e.friction, .001);
  EXPECT_GT(e.outside, 1e-4);
  EXPECT_NEAR(e.balance(), start, 2e-3 * (e.damping + e.friction));
  EXPECT_LT(sim.momentum_error().linear.norm(), 1e-11);
  EXPECT_LT(sim.momentum_error().angular.norm(), 1e-11);
}

TEST(Simulation, ABodyThatIsPutElsewhereFallsFromThereAndTheBooksBalance) {
  Simulation sim(tilted_cube(), {});
  const double start = sim.energy().balance();
  const Vector3d first = sim.particles().position[1], other = first + Vector3d(.01, .02, .03);
  sim.run(20);
  ASSERT_TRUE(sim.contacts().empty());
  sim.put(1, other, Vector3d(1, 0, 0));
  EXPECT_EQ(sim.particles().angular_velocity(1).norm(), 0);
  EXPECT_GT(sim.energy().outside, 0) << "it was lifted";
  const double put = sim.time();
  sim.run(20);
  const double fallen = other.y() - sim.particles().position[1].y();
  EXPECT_NEAR(sim.particles().position[1].x() - other.x(), sim.time() - put, 1e-12);
  EXPECT_NEAR(fallen, 9.81 / 2 * std::pow(sim.time() - put, 2), .1 * fallen);
  EXPECT_NEAR(sim.energy().balance(), start, 1e-3 * sim.energy().outside);
  EXPECT_LT(sim.momentum_error().linear.norm(), 1e-11);
  EXPECT_LT(sim.momentum_error().angular.norm(), 1e-11);
}

TEST(Simulation, ContactsTooFastForTheirSpringsAreReported) {
  for (const double share : {.9, 1.1}) { // of the halo's response limit
    Scene scene = tilted_cube();
    scene.gravity = {0, 0, 0};
    scene.contact.damping_ratio = 0;
    Body ball;
    ball.sphere_radius = .05;
    ball.density = 1 / (4. / 3. * 3.14159265358979 * 1.25e-4);
    ball.halo = 1e-3;
    ball.position = {0, .06, 0};
    ball.velocity = {0, -share * 2e-3 * std::sqrt(scene.contact.stiffness), 0};
    scene.bodies[1] = ball;
    Simulation sim(scene, {});
    const StepStats stats = sim.run(1000);
    EXPECT_EQ(stats.fast_contacts > 0, share > 1);
    EXPECT_EQ(stats.crossings > 0, share > 1);
    EXPECT_EQ(sim.first_fast_contact().b, share > 1 ? 1 : -1);
    if (share > 1) {
      EXPECT_NEAR(sim.first_fast_contact().limit, 2e-3 * std::sqrt(scene.contact.stiffness), .1);
      EXPECT_NEAR(sim.first_fast_contact().time, .0064 / sim.first_fast_contact().speed, 5e-3);
    }
  }
}

TEST(Simulation, BodiesThatMayFlyPastAContactAreReported) {
  for (const double share : {.9, 1.1}) { // of the sum of halos, per step
    Scene scene = tilted_cube();
    scene.gravity = {0, 0, 0};
    scene.time.step = 1e-4;
    Body ball;
    ball.sphere_radius = .05;
    ball.halo = 1e-3;
    ball.position = {0, 5, 0}; // never meets the plane
    ball.velocity = {0, share * 2e-3 / scene.time.step, 0};
    scene.bodies[1] = ball;
    Simulation sim(scene, {});
    EXPECT_EQ(sim.run(3).fast_bodies, share > 1 ? 3 : 0);
    EXPECT_EQ(sim.first_fast_body().a, share > 1 ? 1 : -1);
    if (share > 1) {
      EXPECT_NEAR(sim.first_fast_body().limit, 20, 1e-9);
    }
  }
}

TEST(Simulation, AStepThatIsTooLongIsRefusedUnlessForcedAndThenCounted) {
  Scene scene = tilted_cube();
  scene.time.step = 2.5 * critical_step(scene);
  EXPECT_THROW(Simulation(scene, {}), InputError);
  scene.time.force = true;
  Simulation sim(scene, {});
  EXPECT_GT(sim.run(3000).unstable_steps, 0);
  Simulation calm(tilted_cube(), {});
  EXPECT_EQ(calm.run(20000).unstable_steps, 0);
  // A cube on its four corners rocks with 6 k / m; dashpots have the ratio asked for of its heave, 4 k / m.
  const double k = scene.contact.stiffness;
  EXPECT_NEAR(calm.contact_step_limit() * std::sqrt(6 * k), 2 * (std::sqrt(1 + .25) - .5), .5);
}

TEST(Simulation, TheCriticalStepOfACubeIsThatOfItsFace) {
  // On its four corners a cube rocks with 6 k / m: four times (a / 2)^2 k over m a^2 / 6. One corner alone has at most
  // 5.5 k / m.
  const Scene scene = tilted_cube();
  const double m = 1, k = scene.contact.stiffness, z = .5 * std::sqrt(6);
  EXPECT_NEAR(critical_step(scene), 2 / std::sqrt(6 * k / m) * (std::sqrt(1 + z * z) - z), 1e-9);
}

TEST(Simulation, RefusesWhatItCannotRun) {
  const Scene scene = tilted_cube();
  const auto message = [&](Scene s, Options o) -> std::string {
    try {
      Simulation sim(std::move(s), std::move(o));
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_NE(message(scene, {.kernel = "magic"}).find("brute, "), std::string::npos);
  EXPECT_NE(message(scene, {.precheck = "magic"}).find("none, sphere"), std::string::npos);
  EXPECT_NE(message(scene, {.grid = "magic"}).find("none, regular"), std::string::npos);
  EXPECT_NE(message(scene, {.contact_rule = "magic"}).find("all-pairs, dedupe, nearest, features"), std::string::npos);
  EXPECT_NE(message(scene, {.scheme = "magic"}).find("serial, plain, task"), std::string::npos);
  EXPECT_NE(message(scene, {.scheme = "plain", .runtime = "magic"}).find("openmp, tbb"), std::string::npos);
  EXPECT_NE(message(scene, {.scheme = "plain", .layers = "grid+magic"}).find("grid, particle, triangle"),
            std::string::npos);
  EXPECT_NE(message(scene, {.threads = 0}).find("at least 1"), std::string::npos);
  EXPECT_NE(message(scene, {.subdivision = 1}).find("at least 2"), std::string::npos);
  EXPECT_NE(message(scene, {.threads = 2}).find("one thread"), std::string::npos);
  Scene fast = scene;
  fast.time.step = .1;
  EXPECT_NE(message(fast, {}).find("critical step"), std::string::npos);
  Scene open = scene;
  open.bodies[0].fixed = false;
  EXPECT_NE(message(open, {}).find("bodies[0]"), std::string::npos);
}

} // namespace
} // namespace trigrain
