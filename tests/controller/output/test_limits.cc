// Joint limits and torque blend, each alone.
#include <gtest/gtest.h>

#include <cmath>
#include <limber/controller_status_t.hpp>
#include <limits>

#include "controller/output/joint_limits.h"
#include "controller/output/torque_blend.h"
#include "tests/controller/arms.h"

namespace limber::controller::test_limits {
namespace {

using Status = controller_status_t;

// Two joints: limits -1..2 rad, 10 rad/s, 20 N m, 500 N m/s (0.5 N m a millisecond).
class Limits : public ::testing::Test {
 protected:
  Limits() : robot(limber::testing::planar_arm(limber::testing::kDesktop)), state(2), terms(2) {
    for (JointConfig& joint : robot.robot.joints) {
      joint.position_min = -1.0;
      joint.position_max = 2.0;
      joint.velocity_limit = 10.0;
      joint.torque_limit_Nm = 20.0;
      joint.torque_rate_limit_Nm_per_s = 500.0;
    }
    state.period_s = 1e-3;
    terms.g << 3.0, -1.0;
    terms.M_total.diagonal() << 0.5, 0.1;
  }
  JointLimits limits() const { return JointLimits(robot.robot); }
  /// Walls added, then power and position; the LIMIT_* bits that acted.
  std::int32_t shape(const JointLimits& l, VectorJ* tau) const {
    const VectorJ walls = l.walls(state, terms.M_total);
    *tau += walls;
    return l.shape(state, terms, walls, tau);
  }
  static VectorJ both(double a, double b) { return (VectorJ(2) << a, b).finished(); }

  LoadedRobot robot;
  ArmState state;
  ArmTerms terms;
};

TEST_F(Limits, InTheMiddleNothingActs) {
  JointLimits l = limits();
  l.set_previous(both(5.0, -5.0));
  VectorJ tau = both(5.3, -5.3);
  EXPECT_EQ(shape(l, &tau) | l.clamp(1e-3, &tau), 0);
  EXPECT_EQ(tau, both(5.3, -5.3));
  EXPECT_EQ(l.previous(), tau);
}

TEST_F(Limits, PowerIsLimitedAsAWhole) {
  robot.robot.power_limit_W = 20.0;
  const JointLimits l = limits();
  state.v_reported << 4.0, -2.0;  // the weight takes 3 * 4 + 1 * 2 = 14 W
  VectorJ tau = both(9.0, -4.0);  // 6 N m and -3 N m beyond the weight: 30 W more
  EXPECT_EQ(shape(l, &tau), +Status::LIMIT_POWER);
  EXPECT_NEAR(tau.dot(state.v_reported), 20.0, 1e-12);
  EXPECT_NEAR((tau[0] - 3.0) / (tau[1] + 1.0), -2.0, 1e-12) << "one factor for all joints";
  VectorJ braking = both(-9.0, 4.0);
  EXPECT_EQ(shape(l, &braking), 0);
  EXPECT_EQ(braking, both(-9.0, 4.0)) << "taking energy out is not limited";
}

TEST_F(Limits, RateKeepsToFourFifthsOfTheGatesStep) {
  JointLimits l = limits();
  VectorJ tau = both(19.0, -19.0);
  EXPECT_EQ(l.clamp(1e-3, &tau), +Status::LIMIT_RATE);
  EXPECT_NEAR(tau[0], 0.4, 1e-15);
  EXPECT_NEAR(tau[1], -0.4, 1e-15);
  tau = both(19.0, 0.4);
  l.clamp(2e-3, &tau);
  EXPECT_NEAR(tau[0], 1.2, 1e-15);
  EXPECT_NEAR(tau[1], 0.4, 1e-15) << "exactly one step of 2 ms";
}

TEST_F(Limits, TorqueIsClamped) {
  JointLimits l = limits();
  l.set_previous(both(20.0, -25.0));
  EXPECT_EQ(l.previous(), both(20.0, -20.0));
  VectorJ tau = both(20.1, -30.0);
  EXPECT_EQ(l.clamp(1e-3, &tau), +Status::LIMIT_TORQUE);
  EXPECT_EQ(tau, both(20.0, -20.0));
}

TEST_F(Limits, WallsPushBackWithASpringAndADamper) {
  terms.g.setZero();
  const JointLimits l = limits();
  const auto wall = [&](double q, double v) {
    state.q << q, 0.0;
    state.v_reported << v, 0.0;
    VectorJ tau = both(0.0, 0.0);
    const int acted = shape(l, &tau);
    EXPECT_EQ(acted != 0, tau[0] != 0.0);
    EXPECT_EQ(tau[1], 0.0);
    return tau[0];
  };
  EXPECT_EQ(wall(1.9, 1.0), 0.0);
  EXPECT_NEAR(wall(1.95, 0.0), -5.0, 1e-12);
  EXPECT_NEAR(wall(2.0, 0.0), -10.0, 1e-12) << "half the torque limit at the limit";
  EXPECT_NEAR(wall(-1.0, 0.0), 10.0, 1e-12);
  const double D = 2.0 * 0.7 * std::sqrt(100.0 * 0.5);
  EXPECT_NEAR(wall(2.0, 1.0), -10.0 - D, 1e-12);
  EXPECT_NEAR(wall(2.0, -1.0), -10.0, 1e-12) << "leaving is not braked";
  EXPECT_NEAR(wall(1.9 + 1e-6, 2.0), 0.0, 1e-3) << "no edge";
  terms.M_total(0, 0) = 0.002;
  state.period_s = 1e-3;
  EXPECT_NEAR(wall(2.0, 0.0), -0.1 * 45.0, 1e-12) << "a light joint: (0.15 / 1 ms)^2 0.002 kg m^2";
}

// The wall of 0.1 rad pushes with 100 N m/rad; from its middle on the rest of what pushes outwards
// fades, the weight is carried to the end.
TEST_F(Limits, NoLawHoldsAJointAgainstItsEnd) {
  const JointLimits l = limits();
  const auto left = [&](double q, double demand) {
    state.q << q, 0.0;
    VectorJ tau = both(demand, 0.0);
    shape(l, &tau);
    return tau[0];
  };
  EXPECT_NEAR(left(1.94, 3.0 + 8.0), 3.0 + 8.0 - 4.0, 1e-12);
  EXPECT_NEAR(left(1.975, 3.0 + 8.0), 3.0 + 4.0 - 7.5, 1e-12) << "half way through the inner half";
  EXPECT_NEAR(left(2.0, 3.0 + 20.0), 3.0 - 10.0, 1e-12);
  EXPECT_NEAR(left(2.01, 3.0 + 20.0), 3.0 - 11.0, 1e-12);
  EXPECT_NEAR(left(-1.0, 3.0 - 20.0), 3.0 + 10.0, 1e-12);
  EXPECT_NEAR(left(2.0, 3.0 - 5.0), 3.0 - 5.0 - 10.0, 1e-12) << "what pushes inwards stays";
}

TEST_F(Limits, ContinuousJointsHaveNoWalls) {
  for (JointConfig& joint : robot.robot.joints) {
    joint.position_min = -std::numeric_limits<double>::infinity();
    joint.position_max = std::numeric_limits<double>::infinity();
  }
  const JointLimits l = limits();
  state.q << 1e3, -1e3;
  VectorJ tau = both(1.0, 1.0);
  EXPECT_EQ(shape(l, &tau), 0);
  EXPECT_EQ(tau, both(1.0, 1.0));
}

TEST_F(Limits, NoticesADriverThatDoesNotFollow) {
  JointLimits l = limits();
  l.set_previous(both(5.0, 5.0));
  EXPECT_FALSE(l.far_from_previous(both(5.4, 4.6), 1e-3));
  EXPECT_TRUE(l.far_from_previous(both(5.0, 4.4), 1e-3));
}

TEST(TorqueBlend, StartsAtTheTorqueBeforeAndEndsAtTheLaw) {
  TorqueBlend blend(1);
  const VectorJ rest = VectorJ::Zero(1);
  const auto blended = [&](double law) {
    VectorJ tau = VectorJ::Constant(1, law);
    blend.add_to(&tau);
    return tau[0];
  };
  EXPECT_EQ(blended(4.0), 4.0) << "nothing to blend";
  blend.start(VectorJ::Constant(1, 10.0), VectorJ::Constant(1, 4.0));
  EXPECT_EQ(blended(4.0), 10.0);
  blend.advance(0.125, rest);
  EXPECT_NEAR(blended(4.0), 4.0 + 6.0 * (0.5 + 0.5 * std::sqrt(0.5)), 1e-12);
  blend.advance(0.125, rest);
  EXPECT_NEAR(blended(5.0), 8.0, 1e-12) << "the law is in force all along";
  blend.advance(0.25, rest);
  EXPECT_FALSE(blend.active());
  EXPECT_EQ(blended(4.0), 4.0);
}

TEST(TorqueBlend, DoesNotGoOnPushingAJointThatYields) {
  TorqueBlend blend(2);
  blend.start(VectorJ::Constant(2, 10.0), VectorJ::Zero(2));
  const VectorJ v = (VectorJ(2) << 1.0, -1.0).finished();
  for (int i = 0; i < 30; ++i) blend.advance(1e-3, v);
  VectorJ tau = VectorJ::Zero(2);
  blend.add_to(&tau);
  EXPECT_NEAR(tau[0], std::exp(-1.0) * tau[1], 1e-9);
  EXPECT_GT(tau[1], 9.8);
}

}  // namespace
}  // namespace limber::controller::test_limits
