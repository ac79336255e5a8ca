// FALLBACK of one joint: the held torque, the angle it is held at, and where the spring gives way.
#include <gtest/gtest.h>

#include "drivers/drive/fallback.h"
#include "tests/drivers/drive/damiao_reply.h"

namespace limber::test_fallback {
namespace {

using testing::answer;

constexpr double kAngleCount = 25.0 / 65535.0;

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
    EXPECT_DOUBLE_EQ(fallback.command(link, true, true).tau, tau);
  fallback.start(-1.0, 0.0);
  EXPECT_DOUBLE_EQ(fallback.command(link, true, true).tau, -0.5) << "begins anew";
}

TEST_F(FallbackTest, DampsWhileItSettlesAndWhereTheAngleIsNotTrusted) {
  fallback.start(0.0, 0.0);
  for (const auto& [settling, trusted] : {std::pair(true, true), std::pair(false, false)}) {
    const JointCommand command = fallback.command(link, settling, trusted);
    EXPECT_DOUBLE_EQ(command.theta, link.theta());
    EXPECT_EQ(command.kp, 0.0);
    EXPECT_EQ(command.kd, 1.0);
  }
}

TEST_F(FallbackTest, HoldsWhereTheJointWasWhenItHadSettled) {
  fallback.start(0.0, 0.0);
  fallback.command(link, true, true);
  at(0.6);
  EXPECT_NEAR(fallback.command(link, false, true).theta, 0.6, kAngleCount);
  at(0.65);
  const JointCommand command = fallback.command(link, false, true);
  EXPECT_NEAR(command.theta, 0.6, kAngleCount);
  EXPECT_EQ(command.kp, 50.0);
  EXPECT_EQ(command.kd, 1.0);
}

TEST_F(FallbackTest, HoldsAtAnotherAngleAfterRepliesWereLostAndWhenItBeginsAgain) {
  fallback.start(0.0, 0.0);
  EXPECT_NEAR(fallback.command(link, false, true).theta, 0.5, kAngleCount);
  at(0.55);
  fallback.command(link, false, false);
  EXPECT_NEAR(fallback.command(link, false, true).theta, 0.55, kAngleCount);
  at(0.6);
  fallback.start(0.0, 0.0);
  EXPECT_NEAR(fallback.command(link, false, true).theta, 0.6, kAngleCount);
}

// Torque limit 8 N m: holding 6, the spring of 50 N m/rad may add 2 N m, 0.04 rad; holding 8,
// nothing.
TEST_F(FallbackTest, GivesWayAtTheTorqueLimit) {
  for (const auto& [held, reach] :
       {std::pair(6.0, 0.04), std::pair(-6.0, 0.04), std::pair(8.0, 0.0), std::pair(9.0, 0.0)}) {
    at(0.5);
    fallback.start(held, held);
    fallback.command(link, false, true);
    at(0.7);
    EXPECT_NEAR(fallback.command(link, false, true).theta, link.theta() - reach, 1e-12) << held;
    at(0.3);
    EXPECT_NEAR(fallback.command(link, false, true).theta, link.theta() + reach, 1e-12) << held;
  }
}

TEST_F(FallbackTest, ASoftSpringGivesWayAsWell) {
  JointConfig soft = joint(0.8);
  soft.torque_limit_Nm = 0.4;  // 0.5 rad
  JointLink soft_link(soft, true, 1e-3, 2);
  answer(&soft_link, {testing::kEnabled, 0.0, 0.0, 0.0});
  fallback.start(0.0, 0.0);
  fallback.command(soft_link, false, true);
  answer(&soft_link, {testing::kEnabled, 2.0, 0.0, 0.0});
  EXPECT_NEAR(fallback.command(soft_link, false, true).theta, soft_link.theta() - 0.5, 1e-12);
}

TEST_F(FallbackTest, DampIsTheDriversDampingAlone) {
  const JointCommand command = damp(link);
  EXPECT_DOUBLE_EQ(command.theta, link.theta());
  EXPECT_EQ(command.kp, 0.0);
  EXPECT_EQ(command.kd, 1.0);
  EXPECT_EQ(command.tau, 0.0);
}

}  // namespace
}  // namespace limber::test_fallback
