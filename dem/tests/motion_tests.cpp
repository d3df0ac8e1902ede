#include "dem/motion.hpp"
#include <cmath>
#include <gtest/gtest.h>

namespace trigrain {
namespace {

using Eigen::Vector3d;

struct Top {
  Particles particles;
  Loads none{{Vector3d::Zero()}, {Vector3d::Zero()}};

  Top(const Vector3d& size, double density, const Vector3d& spin) {
    Body body;
    body.mesh = std::make_shared<Mesh>(box(size));
    body.density = density;
    body.angular_velocity = spin;
    particles.add(body);
  }
  void turn(double step, int steps) {
    for (int i = 0; i < steps; ++i) integrate(particles, none, Vector3d::Zero(), step, 0, 1);
  }
};

/// Cuboid 1 x 2 x 3 of mass 6: moments 5, 2.5 and 6.5 for the middle, long and short axis.
Top cuboid(const Vector3d& spin) { return Top({2, 3, 1}, 1, spin); }

TEST(Motion, AFreeTopFlipsWithThePeriodOfTheEllipticFunctions) {
  // Middle axis x with moment 5; spin .01 about the long axis y, 1 about x: period 48.6898507741311 s (Euler's top).
  Top top = cuboid({1, .01, 0});
  const int steps = 200000;
  const double step = 48.6898507741311 / steps;
  double smallest = 1;
  for (int i = 0; i < steps; ++i) {
    top.turn(step, 1);
    smallest = std::min(smallest, (top.particles.orientation[0].conjugate() * top.particles.angular_velocity(0)).x());
  }
  const Vector3d w = top.particles.orientation[0].conjugate() * top.particles.angular_velocity(0);
  EXPECT_LT(smallest, -.99); // it did flip in between
  EXPECT_NEAR(w.x(), 1, 1e-6);
  EXPECT_NEAR(w.y(), .01, 1e-5);
}

TEST(Motion, AFreeTopKeepsItsAngularMomentumAndBoundsItsEnergyError) {
  double error[2];
  for (int run = 0; run < 2; ++run) {
    Top top = cuboid({1, .01, 0});
    const double e0 = kinetic_energy(top.particles);
    const Vector3d l0 = top.particles.angular_momentum[0];
    const double step = .1 / (run + 1);
    error[run] = 0;
    for (int i = 0; i < 2500 * (run + 1); ++i) {
      top.turn(step, 1);
      error[run] = std::max(error[run], std::abs(kinetic_energy(top.particles) / e0 - 1));
    }
    EXPECT_LT((top.particles.angular_momentum[0] - l0).norm() / l0.norm(), 1e-12);
  }
  const double slope = std::log2(error[0] / error[1]);
  EXPECT_NEAR(slope, 2, .1); // second order in the step
}

TEST(Motion, SpinAboutSkewAxesStaysARotation) {
  for (const Vector3d& spin : {Vector3d(10, 0, 10), Vector3d(10, 5, 7), Vector3d(1, 2, 3)}) {
    Top top = cuboid(spin);
    top.turn(1e-3, 1000000);
    const Eigen::Matrix3d r = top.particles.orientation[0].toRotationMatrix();
    EXPECT_LT((r.transpose() * r - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-10) << spin.transpose();
  }
}

TEST(Motion, ASphereTurnsByItsSpinTimesTime) {
  Particles particles;
  Body ball;
  ball.sphere_radius = .5;
  ball.angular_velocity = {0, 0, 2};
  particles.add(ball);
  const Loads none{{Vector3d::Zero()}, {Vector3d::Zero()}};
  for (int i = 0; i < 1000; ++i) integrate(particles, none, Vector3d::Zero(), 1e-3, 0, 1);
  const Vector3d x = particles.orientation[0] * Vector3d::UnitX();
  EXPECT_NEAR(x.x(), std::cos(2.), 1e-10);
  EXPECT_NEAR(x.y(), std::sin(2.), 1e-10);
}

TEST(Motion, TorqueChangesTheAngularMomentumAndForceTheVelocity) {
  Top top = cuboid({0, 0, 0});
  const Loads push{{Vector3d(6, 0, 0)}, {Vector3d(0, 0, .5)}};
  integrate(top.particles, push, {0, -10, 0}, .25, 0, 1);
  EXPECT_NEAR(top.particles.velocity[0].x(), .25, 1e-14);
  EXPECT_NEAR(top.particles.velocity[0].y(), -2.5, 1e-14);
  EXPECT_NEAR(top.particles.angular_momentum[0].z(), .125, 1e-14);
}

TEST(Motion, FixedBodiesStayWhereTheyAre) {
  Particles particles;
  Body wall;
  wall.mesh = std::make_shared<Mesh>(plane(1));
  wall.fixed = true;
  particles.add(wall);
  const Loads push{{Vector3d(1, 1, 1)}, {Vector3d(1, 1, 1)}};
  integrate(particles, push, {0, -10, 0}, 1, 0, 1);
  EXPECT_EQ(particles.position[0], Vector3d::Zero());
  EXPECT_EQ(particles.angular_velocity(0), Vector3d::Zero());
}

TEST(Particles, TheHashKnowsEveryBitOfPlacesOrientationsAndMotions) {
  Particles particles;
  Body ball;
  ball.sphere_radius = .5;
  for (const double x : {1., 3.}) {
    ball.position = ball.velocity = ball.angular_velocity = {x, x, x};
    particles.add(ball);
  }
  const std::uint64_t hash = particles.hash();
  const auto expect_known = [&](double& number, const char* what) {
    const double before = number;
    number = std::nextafter(number, 10.);
    EXPECT_NE(particles.hash(), hash) << what;
    number = before;
    EXPECT_EQ(particles.hash(), hash) << what;
  };
  for (int i = 0; i < particles.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      expect_known(particles.position[i][axis], "position");
      expect_known(particles.velocity[i][axis], "velocity");
      expect_known(particles.angular_momentum[i][axis], "angular momentum");
    }
    for (int k = 0; k < 4; ++k) expect_known(particles.orientation[i].coeffs()[k], "orientation");
  }
}

} // namespace
} // namespace trigrain
