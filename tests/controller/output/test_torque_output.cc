// From the torque that is wanted to the torque that is sent: blend, limits and preload in a row.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limber/controller_status_t.hpp>
#include <limits>

#include "controller/output/torque_output.h"
#include "tests/controller/one_joint.h"

namespace limber::controller::test_torque_output {
namespace {

using Status = controller_status_t;

constexpr double kT = 1e-3;

VectorJ one(double x) { return VectorJ::Constant(1, x); }

/// One joint with two motors: 20 N m, steps of 0.4 N m. Its springs pull with 800 c^2 / 2 N m.
class TorqueOutputTest : public ::testing::Test {
 protected:
  TorqueOutputTest() : robot_(made()), output_(robot_), state_(1), terms_(1) {
    state_.period_s = kT;
    terms_.g.setZero();
    terms_.M.setConstant(0.5);
    terms_.M_total.setOnes();
  }
  static Robot made() {
    Robot robot = limber::testing::one_pair({}).robot;
    JointConfig& joint = robot.joints[0];
    joint.torque_limit_Nm = 20.0;
    joint.torque_rate_limit_Nm_per_s = 500.0;
    joint.velocity_limit = 10.0;
    joint.position_min = -3.0;
    joint.position_max = 3.0;
    return robot;
  }
  /// The drives apply what was sent.
  bool shape(double tau, const VectorJ* preload = nullptr) {
    state_.tau_applied = output_.torque();
    state_.tau_preload_applied = output_.preload_torque();
    return shape_as_applied(tau, preload);
  }
  bool shape_as_applied(double tau, const VectorJ* preload = nullptr) {
    limits_ = 0;
    return output_.shape(one(tau), preload, state_, terms_, one(0.0), kT, &limits_);
  }
  void stand_by(double target, const Standby& how) {
    limits_ = 0;
    output_.stand_by(one(target), how, state_, &limits_);
  }
  void sent(double tau) { stand_by(tau, {.preload = PreloadAtRest::kAsApplied}); }
  double torque() const { return output_.torque()[0]; }
  double preload_torque() const { return output_.preload_torque()[0]; }

  Robot robot_;
  TorqueOutput output_;
  ArmState state_;
  ArmTerms terms_;
  std::int32_t limits_ = 0;
};

TEST_F(TorqueOutputTest, ATorqueThatFitsIsSent) {
  state_.preload[0] = 0.3;
  sent(1.0);
  EXPECT_TRUE(shape(1.2));
  EXPECT_EQ(torque(), 1.2);
  EXPECT_EQ(limits_, 0);
}

// What it demands changes sign before the torque, in steps of 0.4 N m, has got there.
TEST_F(TorqueOutputTest, OfSpringsALawLetsGoThatItsRateLimitHoldsBack) {
  state_.preload[0] = 0.3;
  terms_.g << 2.0;
  sent(2.0);
  const auto swing = [&] {
    double most = 0.0;
    for (int k = 0; k < 200; ++k) {
      EXPECT_TRUE(shape(k / 20 % 2 == 0 ? 20.0 : -20.0));
      if (k >= 160) most = std::max(most, std::abs(torque() - 2.0));
    }
    return most;
  };
  EXPECT_LT(swing(), 3.0);
  EXPECT_TRUE(limits_ & Status::LIMIT_RATE);
  robot_ = made();
  robot_.joints[0].has_antagonist = false;
  robot_.joints[0].transmission = {};
  output_ = TorqueOutput(robot_);
  EXPECT_GT(swing(), 3.5) << "a rigid joint is only held back";
}

TEST_F(TorqueOutputTest, AllLimitsAreTold) {
  state_.preload[0] = 0.3;
  sent(19.9);
  state_.v_reported << 9.0;
  EXPECT_TRUE(shape(41.0));
  EXPECT_NEAR(torque(), 19.5, 1e-12) << "a step down: at 9 rad/s it cannot stop before its end";
  EXPECT_EQ(limits_, +Status::LIMIT_POSITION | +Status::LIMIT_TORQUE);
  state_.v_reported << 0.0;
  EXPECT_TRUE(shape(0.0));
  EXPECT_NEAR(torque(), 19.1, 1e-12);
  EXPECT_EQ(limits_, +Status::LIMIT_RATE);
}

TEST_F(TorqueOutputTest, ATorqueThatIsNoNumberIsNotSent) {
  state_.preload[0] = 0.3;
  sent(2.0);
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(shape(bad));
    EXPECT_EQ(torque(), 2.0);
  }
}

// Half a second along a cosine: 2 + 6 (1 + cos) / 2.
TEST_F(TorqueOutputTest, ASwitchIsBlended) {
  state_.preload[0] = 0.3;
  sent(8.0);
  output_.blend_next();
  EXPECT_FALSE(shape(std::nan(""))) << "and one that fails is not the switch";
  EXPECT_TRUE(shape(2.0));
  EXPECT_EQ(torque(), 8.0);
  EXPECT_EQ(limits_, +Status::LIMIT_RAMP);
  for (int i = 0; i < 250; ++i) shape(2.0);
  EXPECT_NEAR(torque(), 5.0, 1e-9);
  EXPECT_EQ(limits_, +Status::LIMIT_RAMP);
  for (int i = 0; i < 251; ++i) shape(2.0);
  EXPECT_NEAR(torque(), 2.0, 1e-12);
  EXPECT_EQ(limits_, 0);
  EXPECT_TRUE(shape(3.0));
  EXPECT_NEAR(torque(), 2.4, 1e-12) << "a step of the law itself is no switch";
  EXPECT_EQ(limits_, +Status::LIMIT_RATE);
}

TEST_F(TorqueOutputTest, ABlendDoesNotPushAJointThatYields) {
  state_.preload[0] = 0.3;
  sent(8.0);
  output_.blend_next();
  shape(2.0);
  state_.v_reported << 1.0;
  for (int i = 0; i < 30; ++i) shape(2.0);
  EXPECT_LT(torque(), 2.0 + 6.0 * std::exp(-0.9)) << "30 ms are its time constant";
}

TEST_F(TorqueOutputTest, StepsAreCountedFromWhatTheDrivesApply) {
  sent(5.0);
  state_.tau_applied << 5.4;
  output_.follow_drives(state_);
  EXPECT_EQ(torque(), 5.0) << "on its way";
  state_.tau_applied << -3.0;
  output_.follow_drives(state_);
  EXPECT_EQ(torque(), -3.0);
}

// An answer may arrive after the drives have been sent the torque before once more, and the next
// one be in time again. The gate compares with what left last; its step is 0.5 N m.
TEST_F(TorqueOutputTest, NoAnswerIsAStepTooLargeWhicheverCameLate) {
  constexpr int kCycles = 14;
  for (int late = 0; late < 1 << kCycles; ++late) {
    TorqueOutput output(robot_);
    double present = 0.0;
    double accepted = 0.0;
    const auto judge = [&](double tau) {
      ASSERT_LE(std::abs(tau - present), 0.5) << "of pattern " << late;
      accepted = tau;
    };
    for (int k = 0; k < kCycles; ++k) {
      present = accepted;
      if (k > 0 && (late >> (k - 1) & 1) != 0) judge(output.torque()[0]);
      state_.tau_applied << present;
      output.follow_drives(state_);
      output.shape(one(10.0), nullptr, state_, terms_, one(0.0), kT, &limits_);
      if ((late >> k & 1) == 0) judge(output.torque()[0]);
    }
  }
}

TEST_F(TorqueOutputTest, AStepFromWhatTheDrivesApplyIsTold) {
  sent(5.0);
  state_.tau_applied << 4.75;
  EXPECT_TRUE(shape_as_applied(5.1));
  EXPECT_EQ(torque(), 5.1);
  EXPECT_EQ(limits_, 0);
  state_.tau_applied << 4.6;
  EXPECT_TRUE(shape_as_applied(5.3));
  EXPECT_NEAR(torque(), 5.05, 1e-12);
  EXPECT_EQ(limits_, +Status::LIMIT_RATE);
  state_.tau_applied << 5.5;
  EXPECT_TRUE(shape_as_applied(4.7));
  EXPECT_NEAR(torque(), 5.05, 1e-12);
  sent(20.0);
  state_.tau_applied << 40.0;
  EXPECT_TRUE(shape_as_applied(19.8));
  EXPECT_NEAR(torque(), 19.8, 1e-12) << "no drive is sent more than the joint's torque";
}

TEST_F(TorqueOutputTest, StandbyGoesThereAtOnceOrInSteps) {
  EXPECT_EQ(Standby{}.torque, Standby::Torque::kZero) << "where nothing is chosen";
  stand_by(6.0, {});
  EXPECT_EQ(torque(), 6.0);
  EXPECT_EQ(limits_, 0);
  stand_by(0.0, {.in_steps = true});
  EXPECT_NEAR(torque(), 5.6, 1e-12);
  EXPECT_EQ(limits_, +Status::LIMIT_RATE);
}

TEST_F(TorqueOutputTest, StandbyKeepsOrReleasesThePreload) {
  state_.preload[0] = 0.3;
  state_.tau_preload_applied[0] = 21.0;  // of springs softer than robot.yaml's
  stand_by(0.0, {.preload = PreloadAtRest::kAsApplied});
  EXPECT_EQ(preload_torque(), 21.0);
  stand_by(0.0, {.in_steps = true});
  EXPECT_NEAR(preload_torque(), 20.6, 1e-12);
  stand_by(0.0, {});
  EXPECT_EQ(preload_torque(), 0.0);
}

// robot.yaml's preload of 0.3 rad unless the law wants another: 0.6 mrad a cycle, K_c = 180 N
// m/rad.
TEST_F(TorqueOutputTest, TheLawMayWantAnotherPreload) {
  state_.preload[0] = 0.3;
  state_.tau_preload_applied[0] = 36.0;
  sent(0.0);
  for (int i = 0; i < 20; ++i) shape(0.0);
  EXPECT_NEAR(preload_torque(), 36.0, 1e-9);
  EXPECT_EQ(limits_, 0);
  const VectorJ slack = one(0.0);
  shape(0.0, &slack);
  EXPECT_NEAR(preload_torque(), 400.0 * 0.2994 * 0.2994 - 180.0 * 0.0006, 1e-9);
  state_.preload[0] = 0.0;
  shape(0.0, &slack);
  EXPECT_EQ(limits_, +Status::LIMIT_RATE) << "180 N m/rad want 54 N m more";
}

}  // namespace
}  // namespace limber::controller::test_torque_output
