// A joint with dry friction and a spring: with dither it creeps home as a damper would let it, with
// the constants of the describing functions.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "controller/observers/dither.h"

namespace limber::controller::test_dither {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kOmega = 2.0 * kPi * Dither::kFrequency_Hz;
constexpr double kT = 1e-3;
constexpr double kInertia = 0.1;
constexpr double kModelled_Nm = 0.3;

Robot robot(double friction_Nm = kModelled_Nm, double limit_Nm = 100.0) {
  Robot made;
  made.joints.resize(2);
  made.joints[0].friction.coulomb_Nm = friction_Nm;
  made.joints[1].type = JointType::kPrismatic;
  for (JointConfig& joint : made.joints) joint.torque_limit_Nm = limit_Nm;
  return made;
}

VectorJ inertia() { return VectorJ::Constant(2, kInertia); }

/// Coulomb friction that sticks: the speed ends at zero where the friction can stop it in a step.
struct Joint {
  double friction_Nm;
  double spring_Nm_per_rad = 0.0;
  double x = 0.0;
  double v = 0.0;
  void step(double tau) {
    constexpr int kSteps = 50;
    constexpr double h = kT / kSteps;
    for (int i = 0; i < kSteps; ++i) {
      const double driven = v + h * (tau - spring_Nm_per_rad * x) / kInertia;
      const double stopped = h * friction_Nm / kInertia;
      v = std::abs(driven) <= stopped ? 0.0 : driven - std::copysign(stopped, driven);
      x += h * v;
    }
  }
};

/// Speed of the swing: M w V and the fundamental of the friction, 4 F / pi, are in quadrature.
double swing(double friction_Nm) {
  const double A = Dither::kBreak * kModelled_Nm + kOmega * kInertia * Dither::kTurn_rad_per_s;
  const double braked = 4.0 * friction_Nm / kPi;
  return std::sqrt(A * A - braked * braked) / (kOmega * kInertia);
}

TEST(Dither, AStuckJointCreepsHomeAsBehindADamper) {
  for (const double share : {0.5, 1.0, 2.0}) {
    Dither dither(robot());
    Joint joint{.friction_Nm = share * kModelled_Nm, .spring_Nm_per_rad = 0.2};
    for (int k = 0; k < 1000; ++k) joint.step(dither.next(inertia(), kT)[0]);
    joint.x += 0.1;  // 0.02 N m: it would stick
    const double d = 2.0 * joint.friction_Nm / (kPi * swing(joint.friction_Nm));
    const double k = joint.spring_Nm_per_rad;  // the slow root of M s^2 + d s + k
    const double s = (d - std::sqrt(d * d - 4.0 * kInertia * k)) / (2.0 * kInertia);
    const auto mean_over_a_swing = [&] {
      double sum = 0.0;
      for (int cycle = 0; cycle < 40; ++cycle) {
        joint.step(dither.next(inertia(), kT)[0]);
        sum += joint.x / 40.0;
      }
      return sum;
    };
    for (int i = 0; i < 20; ++i) mean_over_a_swing();
    const double before = mean_over_a_swing();
    for (int i = 0; i < 49; ++i) mean_over_a_swing();
    const double after = mean_over_a_swing();
    EXPECT_NEAR(std::log(before / after) / (50 * 40 * kT), s, 0.1 * s) << share;
  }
}

TEST(Dither, WithoutItTheJointSticks) {
  Joint joint{.friction_Nm = kModelled_Nm, .spring_Nm_per_rad = 10.0, .x = 2e-3};
  for (int k = 0; k < 2000; ++k) joint.step(0.0);
  EXPECT_EQ(joint.x, 2e-3);
}

TEST(Dither, TheSwingIsThatOfTheDescribingFunctions) {
  for (const double share : {0.5, 1.0, 2.0}) {
    Dither dither(robot());
    Joint joint{.friction_Nm = share * kModelled_Nm};
    double fastest = 0.0;
    for (int k = 0; k < 1500; ++k) {
      joint.step(dither.next(inertia(), kT)[0]);
      if (k > 1000) fastest = std::max(fastest, std::abs(joint.v));
    }
    EXPECT_NEAR(fastest / swing(joint.friction_Nm), 1.0, 0.1) << share;
    EXPECT_GE(fastest, Dither::kTurn_rad_per_s);
    EXPECT_LT(std::abs(joint.x), 2.0 * fastest / kOmega) << "it goes nowhere";
  }
}

TEST(Dither, RisesInHalfASecond) {
  Dither dither(robot());
  const auto greatest = [&dither] {
    double found = 0.0;
    for (int k = 0; k < 40; ++k) found = std::max(found, dither.next(inertia(), kT)[0]);
    return found;
  };
  const double first = greatest();
  for (int k = 0; k < 500; ++k) dither.next(inertia(), kT);
  EXPECT_LT(first, 0.08 * greatest());
  dither.restart();
  EXPECT_LT(greatest(), 0.08 * 2.5);
}

TEST(Dither, MeansNothingOverASwing) {
  Dither dither(robot());
  for (int k = 0; k < 500; ++k) dither.next(inertia(), kT);
  VectorJ sum = VectorJ::Zero(2);
  for (int k = 0; k < 400; ++k) sum += dither.next(inertia(), kT);
  EXPECT_NEAR(sum.norm(), 0.0, 1e-9);
}

TEST(Dither, JointsWithoutFrictionAreLeftAlone) {
  Dither dither(robot());
  for (int k = 0; k < 50; ++k) EXPECT_EQ(dither.next(inertia(), kT)[1], 0.0);
}

TEST(Dither, IsAQuarterOfTheTorqueLimitAtMost) {
  Dither dither(robot(kModelled_Nm, 4.0));
  double most = 0.0;
  for (int k = 0; k < 600; ++k) most = std::max(most, dither.next(inertia(), kT)[0]);
  EXPECT_NEAR(most, 1.0, 0.02);
  EXPECT_LE(most, 1.0);
}

TEST(Dither, SlidingJointsSwingByAboutAsFarAsTheTipOfATurningOne) {
  Robot made = robot();
  made.joints[1].friction.coulomb_Nm = 2.0;
  Dither dither(made);
  double most = 0.0;
  for (int k = 0; k < 600; ++k) most = std::max(most, dither.next(inertia(), kT)[1]);
  EXPECT_NEAR(most, 6.0 + kOmega * kInertia * Dither::kSlide_m_per_s, 0.1);
}

}  // namespace
}  // namespace limber::controller::test_dither
