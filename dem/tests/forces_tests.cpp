#include "dem/contact_list.hpp"
#include "dem/contact_rule.hpp"
#include "dem/forces.hpp"
#include "dem/random.hpp"
#include "dem/simulation.hpp"
#include <cmath>
#include <gtest/gtest.h>

namespace trigrain {
namespace {

using Eigen::Vector3d;

constexpr double pi = 3.14159265358979323846;

/// A ball of mass 1 on or above a wide fixed floor whose top is at y = 0; the halos are small beside the ball.
Scene ball_on_floor(double height, const Vector3d& velocity, const ContactParameters& contact, double step) {
  Scene scene;
  scene.gravity = {0, 0, 0};
  scene.contact = contact;
  scene.time.step = step;
  scene.domain = {.min = {-5, -5, -5}, .size = 10};
  Body floor;
  floor.mesh = std::make_shared<Mesh>(box({8, 1, 8}));
  floor.position = {0, -.5, 0};
  floor.fixed = true;
  floor.halo = 5e-4;
  Body ball;
  ball.sphere_radius = .1;
  ball.density = 1 / (4. / 3. * pi * 1e-3);
  ball.position = {0, .1 + height, 0};
  ball.velocity = velocity;
  ball.halo = 5e-4;
  scene.bodies = {floor, ball};
  return scene;
}

/// Gives contacts the springs and masses that the contact rules do.
void press(const Particles& p, std::vector<Contact>& contacts) {
  std::vector<Touch> touches(contacts.begin(), contacts.end());
  contact_rules().front().reduce(p, touches, 0);
  for (std::size_t i = 0; i < contacts.size(); ++i) static_cast<Touch&>(contacts[i]) = touches[i];
}

std::vector<Vector3d> spins_of(const Particles& p) {
  std::vector<Vector3d> spins;
  for (int i = 0; i < p.size(); ++i) spins.push_back(p.angular_velocity(i));
  return spins;
}

/// Restitution of the clipped spring-dashpot (Schwager & Poeschel 2007).
double restitution(double zeta) {
  const double w = std::sqrt(1 - zeta * zeta);
  return std::exp(-zeta / w * (pi - std::atan2(2 * zeta * w, w * w - zeta * zeta)));
}

TEST(Forces, ReboundFollowsTheRestitutionOfTheDashpot) {
  for (const double zeta : {0., .1, .3, .5}) {
    const double k = 1e6, contact_time = pi / std::sqrt(k);
    const double step = contact_time / 1000.3;
    Simulation sim(ball_on_floor(1.5e-3, {0, -.1, 0}, {.stiffness = k, .damping_ratio = zeta, .friction = 0}, step),
                   {});
    while (sim.time() < .02 + 3 * contact_time) sim.step();
    EXPECT_NEAR(sim.particles().velocity[1].y() / .1, restitution(zeta), 2e-3) << "zeta " << zeta;
  }
}

TEST(Forces, ASlidingBallRollsAtFiveSeventhsOfItsSpeed) {
  const double mu = .3, u0 = .5, g = 9.81, k = 1e6;
  Scene scene = ball_on_floor(1e-3 - g / k, {u0, 0, 0}, {.stiffness = k, .damping_ratio = .3, .friction = mu}, 2e-5);
  scene.gravity = {0, -g, 0};
  Simulation sim(scene, {});
  const double slip_time = 2 * u0 / (7 * mu * g);
  while (sim.time() < slip_time / 2) sim.step();
  EXPECT_NEAR(sim.particles().velocity[1].x(), u0 - mu * g * sim.time(), 1e-3 * u0);
  while (sim.time() < 2 * slip_time) sim.step();
  EXPECT_NEAR(sim.particles().velocity[1].x(), 5. / 7. * u0, 1e-6 * u0);
  EXPECT_NEAR(sim.particles().velocity[1].x() + sim.particles().angular_velocity(1).z() * .1, 0, 1e-6 * u0);
}

TEST(Forces, ABallRollsDownAnInclineAtFiveSeventhsOfGravity) {
  const double slope = .3, g = 9.81, k = 1e6;
  Scene scene = ball_on_floor(1e-3 - g * std::cos(slope) / k, {0, 0, 0},
                              {.stiffness = k, .damping_ratio = .3, .friction = .5}, 2e-5);
  scene.gravity = {g * std::sin(slope), -g * std::cos(slope), 0};
  Simulation sim(scene, {});
  while (sim.time() < .3) sim.step();
  EXPECT_NEAR(sim.particles().velocity[1].x() / sim.time(), 5. / 7. * g * std::sin(slope), 5e-3 * g);
}

TEST(Forces, ABlockBelowTheFrictionAngleStaysWhereTheDashpotAloneWouldCreep) {
  const double slope = 20 * pi / 180, g = 9.81, zeta = .5, k = 1e6;
  Scene scene = ball_on_floor(0, {0, 0, 0}, {.stiffness = k, .damping_ratio = zeta, .friction = .5}, 2e-5);
  scene.gravity = {g * std::sin(slope), -g * std::cos(slope), 0};
  Body& block = scene.bodies[1];
  block.mesh = std::make_shared<Mesh>(box({.2, .1, .2}));
  block.density = 250; // mass 1
  block.position = {0, .05 + 1e-3 - 1e-6, 0};
  for (const ContactRule& rule : contact_rules()) {
    if (rule.name == "dedupe") continue; // creeps, as its points hop about
    Simulation sim(scene, {.contact_rule = std::string(rule.name)});
    sim.run(10000);
    const double settled = sim.particles().position[1].x(), since = sim.time();
    sim.run(10000);
    // A flat face rocks on either rule's few points and springs are lost with them; what is left must be small beside
    // the creep of friction without memory, m g sin(slope) / c_t.
    const double memoryless = g * std::sin(slope) / (2 * zeta * std::sqrt(k * scene.contact.tangential_ratio));
    EXPECT_LT(std::abs(sim.particles().position[1].x() - settled), .02 * memoryless * (sim.time() - since))
        << rule.name;
  }
}

TEST(Forces, TheDashpotNeverPulls) {
  Particles p;
  for (const double y : {0., 1.0005}) {
    Body ball;
    ball.sphere_radius = .5;
    ball.position = {0, y, 0};
    ball.halo = 5e-4;
    ball.velocity = {0, 100 * y, 0}; // parting fast
    p.add(ball);
  }
  std::vector<Contact> contacts{{0, 1, 0, 0, {0, .50025, 0}, {0, -1, 0}, 5e-4}};
  press(p, contacts);
  std::vector<HeldSpring> springs(1);
  contact_forces(p, spins_of(p), contact_laws().front(), {}, 1e-5, contacts, springs);
  EXPECT_EQ(contacts[0].force, Vector3d::Zero());
}

TEST(Forces, BothBodiesGetOppositeForceAndTheirTorquesAndItAddsUpToNothing) {
  Particles p;
  for (int i = 0; i < 2; ++i) {
    Body ball;
    ball.sphere_radius = .5 - .2 * i;
    ball.position = {.3 * i, .75 * i, .1};
    ball.velocity = {1. - i, .5 * i, .2};
    ball.angular_velocity = {3, 1. + i, -2};
    p.add(ball);
  }
  const Vector3d n = (p.position[0] - p.position[1]).normalized();
  std::vector<Contact> contacts{{0, 1, 0, 0, {.2, .45, .1}, n, .2}};
  press(p, contacts);
  std::vector<HeldSpring> springs{{0, 0, {1e-5, 0, 2e-5}, 1e4}};
  contact_forces(p, spins_of(p), contact_laws().front(), {}, 1e-5, contacts, springs);
  Loads loads{{Vector3d::Zero(), Vector3d::Zero()}, {Vector3d::Zero(), Vector3d::Zero()}};
  for (const bool to_a : {true, false}) add_reaction(p, reaction_of(p, contacts), to_a, loads);
  EXPECT_GT(contacts[0].force.norm(), 0);
  EXPECT_GT(loads.torque[0].norm(), 0);
  EXPECT_GT(loads.torque[1].norm(), 0);
  const double scale = contacts[0].force.norm();
  EXPECT_LT((loads.force[0] + loads.force[1]).norm(), 1e-13 * scale);
  Vector3d moment = Vector3d::Zero();
  for (int i = 0; i < 2; ++i) moment += p.position[i].cross(loads.force[i]) + loads.torque[i];
  EXPECT_LT(moment.norm(), 1e-13 * scale);
}

TEST(Forces, FrictionIsCappedByCoulombsLaw) {
  Particles p;
  for (int i = 0; i < 2; ++i) {
    Body ball;
    ball.sphere_radius = .5;
    ball.position = {0, 1. * i, 0};
    ball.velocity = {10. * i, 0, 0};
    p.add(ball);
  }
  const ContactParameters law{.stiffness = 1e3, .friction = .4};
  std::vector<Contact> contacts{{0, 1, 0, 0, {0, .5, 0}, {0, -1, 0}, 1e-3}};
  press(p, contacts);
  std::vector<HeldSpring> springs(1);
  contact_forces(p, spins_of(p), law_of(law), law, 1e-3, contacts, springs);
  const double normal = contacts[0].force.dot(contacts[0].normal);
  const double tangential = (contacts[0].force - normal * contacts[0].normal).norm();
  EXPECT_NEAR(tangential, .4 * normal, 1e-12);
  EXPECT_GT(contacts[0].force.x(), 0) << "ball 0 is dragged along by ball 1";
}

/// A number of contacts between two balls that move and turn: old and new ones, some of them sliding, some too fast.
struct ManyContacts {
  Particles particles;
  std::vector<Contact> contacts;
  std::vector<HeldSpring> springs;
  explicit ManyContacts(int count) {
    Random random(count);
    const auto anywhere = [&](double size) { return (size * random.uniform() * random.direction()).eval(); };
    for (int i = 0; i < 2; ++i)
      particles.add({.sphere_radius = .5,
                     .position = {0, 1.0005 * i, 0},
                     .velocity = anywhere(.05),
                     .angular_velocity = anywhere(1),
                     .halo = 5e-4});
    for (int i = 0; i < count; ++i) {
      contacts.push_back({0, 1, i, 0, Vector3d(0, .5, 0) + anywhere(.1), random.direction(), 1e-3 * random.uniform()});
      const bool is_old = random.uniform() < .6;
      springs.push_back({i, 0, is_old ? anywhere(1e-4) : Vector3d::Zero(), is_old ? 1e3 * random.uniform() : 0});
    }
    press(particles, contacts);
  }
};

TEST(Forces, AContactGetsTheSameBitsAloneAndAmongOthers) {
  int sliding = 0, fast = 0, opening = 0, all = 0;
  for (const char* name : {"spring-dashpot", "hertz-mindlin"}) {
    const ContactParameters law{
        .law = name, .stiffness = 1e4, .damping_ratio = .3, .friction = .4, .youngs_modulus = 1e6, .poisson_ratio = .3};
    for (int count = 1; count < 40; ++count) {
      ManyContacts many(count), one(count);
      const std::vector<Vector3d> spins = spins_of(many.particles);
      for (const HeldSpring& spring : many.springs) opening += spring.stiffness == 0;
      contact_forces(many.particles, spins, law_of(law), law, 1e-3, many.contacts, many.springs);
      for (int i = 0; i < count; ++i) {
        const Contact& c = many.contacts[i];
        contact_forces(one.particles, spins, law_of(law), law, 1e-3, std::span(one.contacts).subspan(i, 1),
                       std::span(one.springs).subspan(i, 1));
        ASSERT_EQ(c.force, one.contacts[i].force) << name << ", " << i << " of " << count;
        ASSERT_EQ(c.spring_energy, one.contacts[i].spring_energy);
        ASSERT_EQ(c.held, one.contacts[i].held);
        ASSERT_EQ(c.released, one.contacts[i].released);
        ASSERT_EQ(c.slides, one.contacts[i].slides);
        ASSERT_EQ(c.fast, one.contacts[i].fast);
        ASSERT_EQ(many.springs[i].stretch, one.springs[i].stretch);
        ASSERT_EQ(many.springs[i].stiffness, one.springs[i].stiffness);
        ASSERT_TRUE(c.force.allFinite());
        sliding += c.slides, fast += c.fast, ++all;
      }
    }
  }
  for (const int some : {sliding, fast, opening}) EXPECT_TRUE(some > all / 20 && some < all - all / 20) << some;
}

TEST(Forces, SpringsAreCarriedToTheSameContactOnly) {
  const std::vector<HeldSpring> last{{0, 5, {9, 9, 9}, 1}, {3, 4, {1, 2, 3}, 1}};
  const std::vector<Contact> contacts{{1, 2, 3, 3}, {1, 2, 3, 4}, {1, 2, 4, 4}};
  std::vector<HeldSpring> now(3);
  carry_springs(last, contacts, now);
  EXPECT_EQ(now[0].stretch, Vector3d::Zero());
  EXPECT_EQ(now[1].stretch, Vector3d(1, 2, 3));
  EXPECT_EQ(now[2].stretch, Vector3d::Zero());
}

} // namespace
} // namespace trigrain
