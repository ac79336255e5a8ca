// Kinetic energy that the torques of the arm cannot have given it: one joint, rigid or with a
// spring, whose motion is known in closed form.
#include <gtest/gtest.h>

#include <cmath>

#include "controller/watches/energy_watch.h"

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
    return watch_.exceeded(state, model(), kPeriod_s);
  }
  /// As many cycles at this speed as it takes.
  bool holds(double v, double tau = kWeight_Nm) {
    for (int k = 1; k < EnergyWatch::kCycles; ++k) EXPECT_FALSE(step(v, tau)) << "too early";
    return step(v, tau);
  }
  EnergyWatch& watch() { return watch_; }
  double unexplained_J() const { return watch_.unexplained_J(); }

 private:
  EnergyWatch::Model model() const { return {M_, B_, g_, VectorJ::Zero(1)}; }

  MatrixJ M_ = MatrixJ::Constant(1, 1, kInertia);
  VectorJ B_ = VectorJ::Zero(1);
  VectorJ g_ = VectorJ::Constant(1, kWeight_Nm);
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

Robot one_spring(bool link_encoder = true) {
  Robot robot = one_joint();
  robot.joints[0].transmission.kind = TransmissionKind::kElastic;
  robot.joints[0].link_encoder.present = link_encoder;
  return robot;
}

/// Link and rotor on a spring, no weight.
class SprungArm {
 public:
  static constexpr double kLink = 0.5;      // kg m^2
  static constexpr double kRotor = 0.2;     // kg m^2
  static constexpr double kSpring = 400.0;  // N m/rad

  explicit SprungArm(bool link_encoder = true) : watch_(one_spring(link_encoder)) {}

  /// One more cycle: speeds of link and motor, the spring's stretch in rad, the motor's torque.
  bool step(double v, double w, double stretch, double tau) {
    joint_state_t state{};
    state.num_joints = 1;
    state.v[0] = v;
    state.theta_dot[0] = w;
    state.tau_applied[0] = tau;
    return watch_.exceeded(state, {M_, B_, g_, VectorJ::Constant(1, kSpring * stretch)}, kPeriod_s);
  }
  double unexplained_J() const { return watch_.unexplained_J(); }

 private:
  MatrixJ M_ = MatrixJ::Constant(1, 1, kLink);
  VectorJ B_ = VectorJ::Constant(1, kRotor);
  VectorJ g_ = VectorJ::Zero(1);
  EnergyWatch watch_;
};

// Let go at a stretch s, link and rotor swing against each other: theta - q = s cos(w t) with
// w^2 = K (1/M + 1/B). The 18 J of the spring become motion; nothing comes from outside.
TEST(EnergyWatch, WhatASpringGivesIsExplained) {
  constexpr double kLink = SprungArm::kLink;
  constexpr double kRotor = SprungArm::kRotor;
  const double stretch = 0.3;
  const double omega = std::sqrt(SprungArm::kSpring * (1.0 / kLink + 1.0 / kRotor));
  SprungArm arm;
  for (int k = 0; k <= 2000; ++k) {
    const double phase = omega * k * kPeriod_s;
    const double rate = stretch * omega * std::sin(phase);
    ASSERT_FALSE(arm.step(rate * kRotor / (kLink + kRotor), -rate * kLink / (kLink + kRotor),
                          stretch * std::cos(phase), 0.0))
        << k;
  }
  EXPECT_NEAR(arm.unexplained_J(), 0.0, 0.05);
}

// Half a radian of wind-up by a motor that crawls: 50 J in the spring, none of them in the motion.
TEST(EnergyWatch, WindingASpringUpIsTheMotorsWork) {
  SprungArm arm;
  for (int k = 0; k <= 1000; ++k) {
    const double stretch = 0.5 * k * kPeriod_s;
    ASSERT_FALSE(arm.step(0.0, 0.5, stretch, SprungArm::kSpring * stretch));
  }
  EXPECT_NEAR(arm.unexplained_J(), 0.0, 0.05);
}

// The motor was told +tau and turned to the other side: T = tau^2 t^2 / (2 B), and as much again is
// missing of what the motor seems to have given.
TEST(EnergyWatch, AMotorThatTurnsTheWrongWayOnASpringIsFound) {
  SprungArm arm;
  const double tau = 10.0;
  int found = -1;
  for (int k = 0; k < 1000 && found < 0; ++k)
    if (arm.step(0.0, -tau / SprungArm::kRotor * k * kPeriod_s, 0.0, tau)) found = k;
  const double time_s = std::sqrt(5.0 * 2.0 * SprungArm::kRotor) / tau;
  EXPECT_EQ(found, static_cast<int>(std::ceil(time_s / kPeriod_s)) + 4);
}

TEST(EnergyWatch, ABlowOnALinkBehindASpringCounts) {
  const auto found = [](double energy_J) {
    SprungArm arm;
    const double v = std::sqrt(2.0 * energy_J / SprungArm::kLink);
    bool exceeded = arm.step(0.0, 0.0, 0.0, 0.0);
    for (int k = 0; k < EnergyWatch::kCycles; ++k) exceeded = arm.step(v, 0.0, 0.0, 0.0);
    return exceeded;
  };
  EXPECT_FALSE(found(4.9));
  EXPECT_TRUE(found(5.1));
}

TEST(EnergyWatch, SpringsWithoutLinkEncodersAreNotWatched) {
  SprungArm arm(false);
  arm.step(0.0, 0.0, 0.0, 0.0);
  for (int k = 0; k < 10; ++k) EXPECT_FALSE(arm.step(50.0, 50.0, 0.0, 0.0));
}

}  // namespace
}  // namespace limber::controller::test_energy_watch
