// The simulated fingers against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "robots/loader/load_robot.h"
#include "sim/hand/fingers.h"

namespace limber::sim::test_fingers {
namespace {

constexpr double kStep_s = 250e-6;

HandConfig hand() { return load_robot("openarm_right").robot.hand.value(); }

double slope(const HandConfig& hand) { return hand.travel.slope(-0.5); }

DriveLaw torque_law(double torque) {
  DriveLaw law;
  law.tau_ff = torque;
  law.limit = 10.0;
  return law;
}

TEST(Fingers, ComeCloserAsAConstantForceMovesTheirMass) {
  const HandConfig config = hand();
  const double kt = config.drive.drive.torque_constant_Nm_per_A;
  Fingers fingers(config, kt, /*friction=*/false);
  constexpr double kForce_N = -2.0;
  constexpr int kSteps = 400;  // 0.1 s
  for (int i = 0; i < kSteps; ++i) fingers.step(torque_law(kForce_N * slope(config)), {}, kStep_s);
  const double t = kSteps * kStep_s;
  const double a = kForce_N / config.mass_kg(slope(config));
  EXPECT_NEAR(fingers.speed(), a * t, 1e-9);
  EXPECT_NEAR(fingers.width(), 0.088 + 0.5 * a * t * t, std::abs(a) * t * kStep_s);
}

class Squeeze : public ::testing::TestWithParam<double> {};

TEST_P(Squeeze, FingersPressWithTorqueOverSlope) {
  const HandConfig config = hand();
  const double kt = config.drive.drive.torque_constant_Nm_per_A;
  Fingers fingers(config, kt, false);
  const Squeezed object = {0.05, GetParam(), 20.0};
  const double torque = -25.0 * slope(config);
  DriveLaw law = torque_law(torque);
  law.kd = 0.1;
  for (int i = 0; i < 40'000; ++i) fingers.step(law, object, kStep_s);
  EXPECT_NEAR(fingers.force(), 25.0, 1e-6);
  EXPECT_NEAR(object.width_m - fingers.width(), 25.0 / GetParam(), 1e-9);
}

TEST_P(Squeeze, FrictionAddsAtMostItsOwnForce) {
  const HandConfig config = hand();
  const double kt = config.drive.drive.torque_constant_Nm_per_A;
  Fingers fingers(config, kt, true);
  const Squeezed object = {0.05, GetParam(), 20.0};
  for (int i = 0; i < 40'000; ++i) fingers.step(torque_law(-25.0 * slope(config)), object, kStep_s);
  const double friction_N = config.drive.friction.coulomb_Nm / std::abs(slope(config));
  EXPECT_NEAR(fingers.force(), 25.0, 1.01 * friction_N);
}

INSTANTIATE_TEST_SUITE_P(Stiffness, Squeeze, ::testing::Values(500.0, 2e4, 1e7));

TEST(Fingers, AnObjectDoesNotPull) {
  const HandConfig config = hand();
  Fingers fingers(config, config.drive.drive.torque_constant_Nm_per_A, false);
  const Squeezed object = {0.05, 1e4, 500.0};
  for (int i = 0; i < 8000; ++i) fingers.step(torque_law(-20.0 * slope(config)), object, kStep_s);
  EXPECT_GT(fingers.force(), 10.0);
  for (int i = 0; i < 2000; ++i) {
    fingers.step(torque_law(20.0 * slope(config)), object, kStep_s);
    ASSERT_GE(fingers.force(), 0.0);
  }
  EXPECT_EQ(fingers.force(), 0.0);
  EXPECT_GT(fingers.width(), 0.05);
}

}  // namespace
}  // namespace limber::sim::test_fingers
