// From one set of gains to another: what ramps, what changes at once, and when it is over.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "controller/gains/gain_ramp.h"
#include "controller/laws/registry.h"
#include "tests/controller/arms.h"

namespace limber::controller::test_gain_ramp {
namespace {

// The stiffness stays symmetric positive semidefinite on the way; no step of the ramp is large.
TEST(GainRamp, GoesFromOneToTheOtherWithoutAStep) {
  std::mt19937 generator(1);
  Gains from(2, {});
  from.K_x = limber::testing::random_stiffness(300.0, 10.0, generator);
  Gains to = from;
  to.K_x = limber::testing::random_stiffness(900.0, 40.0, generator);
  to.K_q.diagonal().setConstant(50.0);
  to.damping_ratio = 1.0;
  GainRamp ramp(from);
  ramp.start(to, 0.2);
  Matrix6 before = from.K_x;
  for (int i = 0; i < 199; ++i) {
    ramp.advance(1e-3);
    const Matrix6& K = ramp.now().K_x;
    EXPECT_LT((K - before).norm(), 0.009 * (to.K_x - from.K_x).norm());
    EXPECT_GT(K.ldlt().vectorD().minCoeff(), 0.0);
    EXPECT_TRUE(ramp.moving());
    before = K;
    if (i == 99) {
      EXPECT_NEAR(ramp.now().K_q(0, 0), 25.0, 1e-9) << "half way";
    }
  }
  ramp.advance(1e-3 + 1e-12);
  EXPECT_FALSE(ramp.moving());
  EXPECT_EQ(ramp.now().K_x, to.K_x);
  EXPECT_EQ(ramp.now().damping_ratio, 1.0);
}

TEST(GainRamp, ANewRampStartsWhereTheOldOneIs) {
  Gains gains(1, law_catalog().parameters);
  GainRamp ramp(gains);
  gains.K_q.diagonal().setConstant(100.0);
  ramp.start(gains, 0.0);  // at least a tenth of a second
  for (int i = 0; i < 50; ++i) ramp.advance(1e-3);
  const double reached = ramp.now().K_q(0, 0);
  EXPECT_NEAR(reached, 50.0, 1e-6);
  gains.K_q.setZero();
  ramp.start(gains, 1.0);
  EXPECT_EQ(ramp.now().K_q(0, 0), reached);
  ramp.advance(1e-3);
  EXPECT_NEAR(ramp.now().K_q(0, 0), reached, 1e-3);
}

/// Every part that is ramped has `value`, whatever its unit.
Gains all(double value) {
  Gains gains(1, law_catalog().parameters);
  gains.K_x.diagonal().setConstant(value);
  gains.D_x.diagonal().setConstant(value);
  gains.damping_ratio = gains.joint_damping_ratio = value;
  for (MatrixJ* part : {&gains.K_q, &gains.D_q, &gains.K_null, &gains.D_null})
    part->setConstant(value);
  gains.parameters.set(*find_row(law_catalog().parameters, "K_acc_per_s2"),
                       MatrixJ(MatrixJ::Constant(1, 1, value)));
  return gains;
}
double parameter_of(const Gains& gains) {
  return gains.parameters.matrix(*find_row(law_catalog().parameters, "K_acc_per_s2"))(0, 0);
}
void expect_all(const Gains& gains, double value) {
  EXPECT_NEAR(gains.K_x(0, 0), value, 1e-12);
  EXPECT_NEAR(gains.D_x(5, 5), value, 1e-12);
  EXPECT_NEAR(gains.damping_ratio, value, 1e-12);
  EXPECT_NEAR(gains.joint_damping_ratio, value, 1e-12);
  for (const MatrixJ* part : {&gains.K_q, &gains.D_q, &gains.K_null, &gains.D_null})
    EXPECT_NEAR((*part)(0, 0), value, 1e-12);
  EXPECT_NEAR(parameter_of(gains), value, 1e-12);
}

TEST(GainRamp, EverythingFollowsTheCosine) {
  Gains from = all(2.0);
  from.settings.damping = from.settings.joint_damping = DampingDesign::kGiven;
  Gains to = all(4.0);
  to.settings = from.settings;
  GainRamp ramp(from);
  EXPECT_FALSE(ramp.moving());
  ramp.advance(1.0);
  expect_all(ramp.now(), 2.0);
  ramp.start(to, 0.3);
  EXPECT_TRUE(ramp.moving());
  expect_all(ramp.now(), 2.0);
  ramp.advance(0.1);
  expect_all(ramp.now(), 3.0 - std::cos(std::numbers::pi / 3.0));
  ramp.advance(0.1);
  expect_all(ramp.now(), 3.0 - std::cos(2.0 * std::numbers::pi / 3.0));
  ramp.advance(0.2);
  EXPECT_FALSE(ramp.moving());
  expect_all(ramp.now(), 4.0);
}

TEST(GainRamp, ANewRampStartsWhereTheParametersAre) {
  GainRamp ramp(all(0.0));
  ramp.start(all(2.0), 1.0);
  ramp.advance(0.5);
  EXPECT_NEAR(parameter_of(ramp.now()), 1.0, 1e-12);
  ramp.start(all(4.0), 1.0);
  EXPECT_NEAR(parameter_of(ramp.now()), 1.0, 1e-12);
  ramp.advance(0.5);
  EXPECT_NEAR(parameter_of(ramp.now()), 2.5, 1e-12);
}

TEST(GainRamp, TakesATenthOfASecondAtLeast) {
  GainRamp ramp(all(0.0));
  ramp.start(all(1.0), 0.01);
  ramp.advance(0.05);
  EXPECT_NEAR(ramp.now().K_q(0, 0), 0.5, 1e-12);
  EXPECT_TRUE(ramp.moving());
  ramp.advance(0.051);
  EXPECT_FALSE(ramp.moving());
}

TEST(GainRamp, DampingThatWasDesignedBeforeIsGivenAtOnce) {
  Gains from = all(1.0);
  Gains to = all(2.0);
  to.settings.damping = to.settings.joint_damping = DampingDesign::kGiven;
  GainRamp ramp(from);
  ramp.start(to, 1.0);
  EXPECT_EQ(ramp.now().D_x, to.D_x);
  EXPECT_EQ(ramp.now().D_q, to.D_q);
  EXPECT_EQ(ramp.now().K_x, from.K_x);
  ramp.advance(0.5);
  EXPECT_NEAR(ramp.now().D_x(0, 0), 2.0, 1e-12);
  EXPECT_NEAR(ramp.now().D_q(0, 0), 2.0, 1e-12);
}

TEST(GainRamp, SettingsInertiaAndParametersThatDoNotRampChangeAtOnce) {
  const GainRow& M_q = *find_row(law_catalog().parameters, "M_q_kgm2");
  const GainRow& torque_gain = *find_row(law_catalog().parameters, "torque_gain");
  Gains to(1, law_catalog().parameters);
  to.settings.orientation = Orientation::kQuat;
  to.M_x.setIdentity();
  to.parameters.set(M_q, MatrixJ(MatrixJ::Constant(1, 1, 3.0)));
  to.parameters.set(torque_gain, 4.0);
  GainRamp ramp{Gains(1, law_catalog().parameters)};
  ramp.start(to, 1.0);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(ramp.now().settings.orientation, Orientation::kQuat);
    EXPECT_EQ(ramp.now().M_x, to.M_x);
    EXPECT_EQ(ramp.now().parameters.matrix(M_q)(0, 0), 3.0);
    EXPECT_EQ(ramp.now().parameters.number(torque_gain), 4.0);
    ramp.advance(0.5);
  }
}

}  // namespace
}  // namespace limber::controller::test_gain_ramp
