// Kinetic energy that the torques of the arm cannot have given it: one joint whose motion is known
// in closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "controller/modes/energy_watch.h"

namespace limber::controller::test_energy_watch {
namespace {

constexpr double kPeriod_s = 1e-3;
constexpr double kInertia = 0.5;  // kg m^2
constexpr double kWeight_Nm = 3.0;

Robot one_joint() {
  Robot robot;
  robot.joints.resize(1);
  robot.energy_limit_J = 5.0;
  return robot;
}

class Arm {
 public:
  explicit Arm(const Robot& robot = one_joint()) : watch_(robot) {}

  /// One more cycle: the speed that was reached, by the torque `tau` as the drive was told.
  bool step(double v, double tau) {
    joint_state_t state{};
    state.num_joints = 1;
    state.v[0] = v;
    state.tau_applied[0] = tau;
    return watch_.exceeded(state, VectorJ::Constant(1, kWeight_Nm),
                           MatrixJ::Constant(1, 1, kInertia), kPeriod_s);
  }
  /// As many cycles at this speed as it takes.
  bool holds(double v, double tau = kWeight_Nm) {
    for (int k = 1; k < EnergyWatch::kCycles; ++k) EXPECT_FALSE(step(v, tau)) << "too early";
    return step(v, tau);
  }
  EnergyWatch& watch() { return watch_; }
  double unexplained_J() const { return watch_.unexplained_J(); }

 private:
  EnergyWatch watch_;
};

TEST(EnergyWatch, TheMotorsOwnWorkIsExplained) {
  Arm arm;
  const double tau = 10.0;
  for (int k = 0; k <= 1000; ++k) {
    const double v = (tau - kWeight_Nm) / kInertia * k * kPeriod_s;  // 14 rad/s, 49 J in the end
    ASSERT_FALSE(arm.step(v, tau)) << k;
  }
  EXPECT_NEAR(arm.unexplained_J(), 0.0, 1e-9);
}

TEST(EnergyWatch, AFallIsExplainedByTheWeight) {
  Arm arm;
  for (int k = 0; k <= 1000; ++k) ASSERT_FALSE(arm.step(-kWeight_Nm / kInertia * k * kPeriod_s, 0));
  EXPECT_NEAR(arm.unexplained_J(), 0.0, 1e-9);
}

TEST(EnergyWatch, ADriveWithTheOppositeTorqueIsFound) {
  // It makes -10 N m of the 10 asked for, and the weight helps it: v = -26 t. T = 169 t^2 reaches
  // 5 J after 172 cycles; from outside come 260 t^2 more, less what is forgotten. Four cycles later
  // it is sure.
  Arm arm;
  const double tau = 10.0;
  int found = -1;
  for (int k = 0; k < 1000 && found < 0; ++k)
    if (arm.step((-tau - kWeight_Nm) / kInertia * k * kPeriod_s, tau)) found = k;
  EXPECT_EQ(
      found,
      static_cast<int>(std::ceil(std::sqrt(5.0 / (0.5 * kInertia * 26 * 26)) / kPeriod_s)) + 4);
}

TEST(EnergyWatch, ABlowCountsByTheSpeedItGives) {
  const auto speed = [](double energy_J) { return std::sqrt(2.0 * energy_J / kInertia); };
  Arm weak;
  weak.step(0.0, kWeight_Nm);
  weak.step(speed(4.9), kWeight_Nm);
  EXPECT_NEAR(weak.unexplained_J(), 4.9, 1e-9);
  EXPECT_FALSE(weak.holds(speed(4.9)));
  Arm strong;
  strong.step(0.0, kWeight_Nm);
  EXPECT_TRUE(strong.holds(speed(5.1)));
}

TEST(EnergyWatch, ASlowPushAgainstASpringIsNoMotion) {
  Arm arm;
  arm.step(0.0, kWeight_Nm);
  for (int k = 0; k <= 3000; ++k) {  // 0.5 rad/s against up to 150 N m: 112 J into the spring
    const double t = k * kPeriod_s;
    ASSERT_FALSE(arm.step(0.5, kWeight_Nm - 100.0 * 0.5 * t));
  }
  EXPECT_GT(arm.unexplained_J(), 20.0);
}

TEST(EnergyWatch, ForgetsInHalfASecond) {
  Arm arm;
  const double v = std::sqrt(2.0 * 4.0 / kInertia);
  arm.step(0.0, kWeight_Nm);
  arm.step(v, kWeight_Nm);
  for (int k = 0; k < 500; ++k) arm.step(v, kWeight_Nm);
  EXPECT_NEAR(arm.unexplained_J(), 4.0 * std::exp(-1.0), 0.01);
}

TEST(EnergyWatch, FrictionIsNoCredit) {
  Arm arm;
  for (int k = 0; k <= 1000; ++k) arm.step(1.0, kWeight_Nm + 20.0);  // 20 W into friction
  EXPECT_EQ(arm.unexplained_J(), 0.0);
  EXPECT_TRUE(arm.holds(std::sqrt(2.0 * 5.5 / kInertia)));
}

TEST(EnergyWatch, ASpeedThatIsWrongForAMomentIsNoEnergy) {
  Arm arm;
  for (int k = 0; k < 20; ++k) {
    ASSERT_FALSE(arm.step(0.0, kWeight_Nm));
    for (int wrong = 1; wrong < EnergyWatch::kCycles; ++wrong)
      ASSERT_FALSE(arm.step(100.0, kWeight_Nm));
  }
}

TEST(EnergyWatch, AResetStartsTheCountAnew) {
  Arm arm;
  arm.step(0.0, kWeight_Nm);
  for (int k = 1; k < EnergyWatch::kCycles; ++k) arm.step(9.0, kWeight_Nm);
  arm.watch().reset();
  arm.step(0.0, kWeight_Nm);
  EXPECT_TRUE(arm.holds(9.0));
}

TEST(EnergyWatch, AfterAResetTheMotionIsGiven) {
  Arm arm;
  arm.step(0.0, kWeight_Nm);
  arm.step(3.0, kWeight_Nm);
  EXPECT_GT(arm.unexplained_J(), 0.0);
  arm.watch().reset();
  EXPECT_EQ(arm.unexplained_J(), 0.0);
  EXPECT_FALSE(arm.holds(9.0));
  EXPECT_EQ(arm.unexplained_J(), 0.0);
}

TEST(EnergyWatch, WhatIsNoNumberIsTooMuch) {
  Arm arm;
  EXPECT_TRUE(arm.holds(std::nan("")));
}

// 4 J at 4 rad/s, while the motor has taken 1000 N m * 2 rad/s * 1 ms.
TEST(EnergyWatch, WhatTheMotorsTakeCameFromOutsideToo) {
  Arm arm;
  arm.step(0.0, kWeight_Nm);
  arm.step(4.0, kWeight_Nm - 1000.0);
  EXPECT_NEAR(arm.unexplained_J(), 4.0 + 2.0, 1e-9);
}

// 4 J and no more, however much the motors have taken besides.
TEST(EnergyWatch, TheLimitItselfIsAllowed) {
  Robot robot = one_joint();
  robot.energy_limit_J = 4.0;
  Arm arm(robot);
  arm.step(0.0, kWeight_Nm);
  arm.step(4.0, kWeight_Nm - 1000.0);
  for (int k = 0; k < 2 * EnergyWatch::kCycles; ++k) EXPECT_FALSE(arm.step(4.0, kWeight_Nm));
  EXPECT_GT(arm.unexplained_J(), 5.0);
  EXPECT_TRUE(arm.holds(4.03));
}

TEST(EnergyWatch, ArmsWithSpringsAreNotWatched) {
  Robot robot = one_joint();
  robot.joints[0].transmission.kind = TransmissionKind::kElastic;
  Arm arm(robot);
  arm.step(0.0, kWeight_Nm);
  EXPECT_FALSE(arm.step(50.0, kWeight_Nm));
}

}  // namespace
}  // namespace limber::controller::test_energy_watch
