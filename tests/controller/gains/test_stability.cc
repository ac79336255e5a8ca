// Stiffer than stable: refused where a bus is real, a warning where every bus is simulated.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "controller/controller_log.h"
#include "controller/gains/stability.h"
#include "robots/loader/default_gains.h"
#include "tests/controller/rig.h"

namespace limber::controller::test_stability {
namespace {

using limber::testing::kSliderMass;

constexpr double kT = 1e-3;

// A mass on a rail: one mode, whose bound is that of a single mass with one cycle and a half of
// delay: K < (m / t^2) x^2 cos x, cos x = sqrt(4 zeta^4 + 1) - 2 zeta^2.
double bound(double zeta) {
  const double cosine = std::sqrt(4.0 * std::pow(zeta, 4) + 1.0) - 2.0 * zeta * zeta;
  const double x = std::acos(cosine) / (1.5 * kT);
  return kSliderMass * x * x * cosine;
}

Gains gains_of(double K, double zeta) {
  Gains gains(1);
  gains.K_x(0, 0) = gains.K_q(0, 0) = K;
  gains.damping_ratio = gains.joint_damping_ratio = zeta;
  return gains;
}

TEST(Stability, OfOneMass) {
  ArmModel model(limber::testing::slider());
  ArmTerms terms(1);
  model.evaluate(VectorJ::Zero(1), VectorJ::Zero(1), &terms);
  for (const double zeta : {0.3, 0.7, 1.0}) {
    const Gains half = gains_of(0.5 * bound(zeta), zeta);
    EXPECT_NEAR(tip_modes(half, terms, kT).highest_share(), 0.5, 1e-9);
    EXPECT_NEAR(joint_modes(half, terms, kT).highest_share(), 0.5, 1e-9);
    EXPECT_NEAR(joint_modes(half, terms, kT).modes[0].frequency_rad_per_s,
                std::sqrt(0.5 * bound(zeta) / kSliderMass), 1e-6);
    StabilityCheck check(kT);
    EXPECT_EQ(check.check(gains_of(0.999 * bound(zeta), zeta), terms), nullptr);
    EXPECT_STREQ(check.check(gains_of(2.0 * bound(zeta), zeta), terms),
                 "K_x is 2 times what is stable at 1000 Hz in this pose");
  }
  Gains joints = gains_of(3.0 * bound(0.7), 0.7);
  joints.K_x.setZero();
  EXPECT_STREQ(StabilityCheck(kT).check(joints, terms),
               "K_q is 3 times what is stable at 1000 Hz in this pose");
  EXPECT_STREQ(StabilityCheck(kT).check(gains_of(1.0, 0.0), terms),
               "K_x is unstable with this damping at 1000 Hz, however soft it is");
}

// Judged in the home pose before the first state.
TEST(Stability, RefusedOnARealBusWarnedOfElsewhere) {
  LoadedRobot robot = limber::testing::seven_joint_arm();
  for (const bool real : {false, true}) {
    SCOPED_TRACE(real ? "real bus" : "virtual bus");
    robot.robot.buses = {{.name = "arm", .can = real ? "socketcan:can0" : "virtual:arm"}};
    ArmController controller(robot, {});
    const auto send = [&](double K) {
      compliance_gains_t gains = limber::default_gains(robot.robot);
      gains.client = 5;
      for (int i = 3; i < 6; ++i) gains.K_x[i][i] = K;
      return controller.on_gains(gains);
    };
    EXPECT_EQ(send(20.0), nullptr);
    EXPECT_EQ(send(20.0).warning, nullptr);
    const Refusal stiff = send(1e4);
    EXPECT_EQ(stiff.code,
              real ? +request_answer_t::REFUSED_UNSTABLE : +request_answer_t::REFUSED_NOTHING);
    const char* text = real ? stiff.reason : stiff.warning;
    ASSERT_NE(text, nullptr);
    EXPECT_EQ(std::string(text).find("K_x is "), 0U) << text;
    EXPECT_EQ(answer_to(outcome_of(compliance_gains_t{}, stiff), 0).reason, text);
  }
}

TEST(Stability, JudgedWhereTheArmIs) {
  limber::testing::Rig rig(limber::testing::seven_joint_arm());
  rig.to_hold();
  compliance_gains_t gains = rig.gains();
  EXPECT_EQ(rig.controller.on_gains(gains).warning, nullptr);
  gains.K_x[5][5] = 1e4;
  EXPECT_NE(rig.controller.on_gains(gains).warning, nullptr);
}

}  // namespace
}  // namespace limber::controller::test_stability
