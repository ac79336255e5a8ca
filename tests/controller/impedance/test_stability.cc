// Stiffer than stable: refused where a bus is real, a warning where every bus is simulated.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "controller/controller_log.h"
#include "controller/impedance/stability.h"
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
  Gains gains(1, {});
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
    StabilityCheck check(kT, {"rail"});
    EXPECT_EQ(check.check(gains_of(0.999 * bound(zeta), zeta), terms), nullptr);
    EXPECT_STREQ(check.check(gains_of(2.0 * bound(zeta), zeta), terms),
                 "K_x is 2 times what is stable at 1000 Hz in this pose");
  }
  Gains joints = gains_of(3.0 * bound(0.7), 0.7);
  joints.K_x.setZero();
  EXPECT_STREQ(StabilityCheck(kT, {"rail"}).check(joints, terms),
               "K_q is 3 times what is stable at 1000 Hz in this pose");
  EXPECT_STREQ(StabilityCheck(kT, {"rail"}).check(gains_of(1.0, 0.0), terms),
               "K_x is unstable with this damping at 1000 Hz, however soft it is");
}

// A damper alone, a cycle late: D < 2 (sqrt(2) - 1) m / T.
TEST(Stability, OfADamperWithoutASpring) {
  ArmModel model(limber::testing::slider());
  ArmTerms terms(1);
  model.evaluate(VectorJ::Zero(1), VectorJ::Zero(1), &terms);
  const double most = 2.0 * (std::sqrt(2.0) - 1.0) * kSliderMass / kT;
  Gains gains = gains_of(0.0, 0.7);
  gains.settings.joint_damping = DampingDesign::kGiven;
  gains.D_q(0, 0) = 0.999 * most;
  StabilityCheck check(kT, {"rail"});
  EXPECT_EQ(check.check(gains, terms), nullptr);
  gains.D_q(0, 0) = 3.0 * most;
  EXPECT_STREQ(check.check(gains, terms),
               "D_q is 3 times what is stable at 1000 Hz in this pose, most of it at rail");
}

// Where K_x has no row, the whole mass is null space; where it has, none of it.
TEST(Stability, OfTheNullSpace) {
  ArmModel model(limber::testing::slider());
  ArmTerms terms(1);
  model.evaluate(VectorJ::Zero(1), VectorJ::Zero(1), &terms);
  const double most = 2.0 * (std::sqrt(2.0) - 1.0) * kSliderMass / kT;
  StabilityCheck check(kT, {"rail"});
  Gains gains = gains_of(0.0, 0.7);
  gains.D_null(0, 0) = 2.0 * most;
  EXPECT_STREQ(check.check(gains, terms),
               "D_null is 2 times what is stable at 1000 Hz in this pose, most of it at rail");
  gains.K_x(0, 0) = 100.0;
  EXPECT_EQ(check.check(gains, terms), nullptr) << "nothing is left of the null space";
  gains.K_x(0, 0) = 0.0;
  gains.D_null(0, 0) = 0.1 * most;
  // Far below its limit a damper D bears K < D / (3 T / 2).
  gains.K_null(0, 0) = 0.5 * gains.D_null(0, 0) / (1.5 * kT);
  EXPECT_NEAR(null_modes(gains, terms, kT).highest_share(), 0.5, 1e-9);
  gains.K_null(0, 0) *= 8.0;
  EXPECT_STREQ(check.check(gains, terms),
               "K_null is 4 times what is stable at 1000 Hz in this pose");
}

// Judged in the home pose before the first state.
TEST(Stability, RefusedUnlessTheScenarioAllowsItOnSimulatedBuses) {
  LoadedRobot robot = limber::testing::seven_joint_arm();
  struct Case {
    const char* can;
    bool allow;
    bool taken;
  };
  for (const auto& [can, allow, taken] : {Case{"virtual:arm", false, false},
                                          {"virtual:arm", true, true},
                                          {"socketcan:can0", false, false},
                                          {"socketcan:can0", true, false}}) {
    SCOPED_TRACE(std::string(can) + (allow ? " allowed" : ""));
    robot.robot.buses = {{.name = "arm", .can = can}};
    ArmControllerOptions options;
    options.allow_unstable = allow;
    ArmController controller(robot, options);
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
              taken ? +request_answer_t::REFUSED_NOTHING : +request_answer_t::REFUSED_UNSTABLE);
    const char* text = taken ? stiff.warning : stiff.reason;
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
