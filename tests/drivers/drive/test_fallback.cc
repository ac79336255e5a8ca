// FALLBACK of one joint: the held torque, the angle it is held at, and where the spring gives way.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drivers/drive/fallback.h"
#include "tests/drivers/drive/damiao_reply.h"

namespace limber::test_fallback {
namespace {

using testing::answer;

constexpr double kAngleCount = 25.0 / 65535.0;
constexpr double kSpeedCount = 60.0 / 4095.0;  // nothing is told as 0: half of it

class FallbackTest : public ::testing::Test {
 protected:
  FallbackTest() : link(joint(), true, 1e-3, 2) { at(0.5); }
  static JointConfig joint(double kp = 50.0) {
    JointConfig made = testing::test_robot(1).joints[0];
    made.drive.hold_kp_Nm_per_rad = kp;
    return made;
  }
  void at(double angle_rad) { answer(&link, {testing::kEnabled, angle_rad, 0.0, 0.0}); }

  JointLink link;
  Fallback fallback{0.5};
};

TEST_F(FallbackTest, GoesFromThePresentTorqueToTheHeldOneInSteps) {
  fallback.start(6.0, 4.25);
  for (double tau : {5.5, 5.0, 4.5, 4.25, 4.25})
    EXPECT_NEAR(fallback.hold(link, true, {}).tau, tau, kSpeedCount);
  fallback.start(-1.0, 0.0);
  EXPECT_NEAR(fallback.hold(link, true, {}).tau, -0.5, kSpeedCount) << "begins anew";
}

TEST_F(FallbackTest, DampsWhileItSettlesAndWhereTheAngleIsNotTrusted) {
  fallback.start(0.0, 0.0);
  for (const auto& [settling, trusted] : {std::pair(true, true), std::pair(false, false)}) {
    const JointCommand command = fallback.hold(link, settling, {.angle = trusted});
    EXPECT_DOUBLE_EQ(command.theta, link.theta());
    EXPECT_EQ(command.kp, 0.0);
    EXPECT_EQ(command.kd, 1.0);
  }
}

TEST_F(FallbackTest, HoldsWhereTheJointWasWhenItHadSettled) {
  fallback.start(0.0, 0.0);
  fallback.hold(link, true, {});
  at(0.6);
  EXPECT_NEAR(fallback.hold(link, false, {}).theta, 0.6, kAngleCount);
  at(0.65);
  const JointCommand command = fallback.hold(link, false, {});
  EXPECT_NEAR(command.theta, 0.6, kAngleCount);
  EXPECT_EQ(command.kp, 50.0);
  EXPECT_EQ(command.kd, 1.0);
}

TEST_F(FallbackTest, HoldsAtAnotherAngleAfterRepliesWereLostAndWhenItBeginsAgain) {
  fallback.start(0.0, 0.0);
  EXPECT_NEAR(fallback.hold(link, false, {}).theta, 0.5, kAngleCount);
  at(0.55);
  fallback.hold(link, false, {.angle = false});
  EXPECT_NEAR(fallback.hold(link, false, {}).theta, 0.55, kAngleCount);
  at(0.6);
  fallback.start(0.0, 0.0);
  EXPECT_NEAR(fallback.hold(link, false, {}).theta, 0.6, kAngleCount);
}

// Torque limit 8 N m: holding 6, the spring of 50 N m/rad may add 2 N m, 0.04 rad; holding 8,
// nothing.
TEST_F(FallbackTest, GivesWayAtTheTorqueLimit) {
  for (const auto& [held, reach] :
       {std::pair(6.0, 0.04), std::pair(-6.0, 0.04), std::pair(8.0, 0.0), std::pair(9.0, 0.0)}) {
    at(0.5);
    fallback.start(held, held);
    fallback.hold(link, false, {});
    at(0.7);
    EXPECT_NEAR(fallback.hold(link, false, {}).theta, link.theta() - reach, 1e-12) << held;
    at(0.3);
    EXPECT_NEAR(fallback.hold(link, false, {}).theta, link.theta() + reach, 1e-12) << held;
  }
}

TEST_F(FallbackTest, ASoftSpringGivesWayAsWell) {
  JointConfig soft = joint(0.8);
  soft.torque_limit_Nm = 0.4;  // 0.5 rad
  JointLink soft_link(soft, true, 1e-3, 2);
  answer(&soft_link, {testing::kEnabled, 0.0, 0.0, 0.0});
  fallback.start(0.0, 0.0);
  fallback.hold(soft_link, false, {});
  answer(&soft_link, {testing::kEnabled, 2.0, 0.0, 0.0});
  EXPECT_NEAR(fallback.hold(soft_link, false, {}).theta, soft_link.theta() - 0.5, 1e-12);
}

TEST_F(FallbackTest, DampIsTheDriversDampingOnceTheTorqueHasGone) {
  fallback.start(1.0, 0.0);
  for (double tau : {0.5, 0.0, 0.0}) {
    const JointCommand command = fallback.damp(link);
    EXPECT_DOUBLE_EQ(command.theta, link.theta());
    EXPECT_EQ(command.kp, 0.0);
    EXPECT_EQ(command.kd, 1.0);
    EXPECT_NEAR(command.tau, tau, kSpeedCount);
  }
}

// By the drive's own law, tau + kp (theta - angle) - kd speed.
double made(const JointCommand& command, const JointLink& link) {
  return command.tau + command.kp * (command.theta - link.theta()) - command.kd * link.theta_dot();
}

// Limit 8 N m, step 0.5 N m, damping 1 N m s/rad.
TEST_F(FallbackTest, StaysWithinLimitAndRateWhateverTheSpeed) {
  for (const double present : {-8.0, 0.0, 3.0, 8.0}) {
    for (const double speed : {-20.0, -9.0, -0.4, 0.3, 6.0, 20.0}) {
      for (const bool damps : {false, true}) {
        fallback.start(present, damps ? 0.0 : 7.0);
        double before = present;
        for (int cycle = 0; cycle < 60; ++cycle) {
          answer(&link, {testing::kEnabled, 0.5, speed, 0.0});
          const JointCommand command = damps ? fallback.damp(link) : fallback.hold(link, true, {});
          const double now = made(command, link);
          ASSERT_LE(std::abs(now), 8.0 + 1e-12) << present << " " << speed;
          ASSERT_LE(std::abs(now - before), 0.5 + 1e-12) << present << " " << speed;
          ASSERT_GE(command.kd, 0.0);
          ASSERT_LE(command.kd, 1.0);
          before = now;
        }
        const double wanted = (damps ? 0.0 : 7.0) - link.theta_dot();
        EXPECT_NEAR(before, std::clamp(wanted, -8.0, 8.0), 1e-12) << "in the end";
      }
    }
  }
}

TEST_F(FallbackTest, WithoutAVelocityNothingIsDamped) {
  fallback.start(2.0, 2.0);
  answer(&link, {testing::kEnabled, 0.5, 10.0, 0.0});
  const JointCommand command = fallback.hold(link, false, {.angle = false, .velocity = false});
  EXPECT_EQ(command.kd, 0.0);
  EXPECT_EQ(command.tau, 2.0);
}

}  // namespace
}  // namespace limber::test_fallback
