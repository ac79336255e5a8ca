// Causes survive: what drives warn of, and what they report of themselves that cannot be.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/drivers/fake_arm.h"

namespace limber::test_drive_causes {
namespace {

using testing::FakeArm;
using testing::raw_command;
using testing::test_robot;

constexpr int kKeep = joint_command_t::REQUEST_KEEP;

/// Cycles until the drives are no longer ON, or -1.
int cycles_until_off(FakeArm* arm, int most) {
  for (int i = 1; i <= most; ++i) {
    arm->cycle_with(kKeep);
    if (arm->state->drive_state != joint_state_t::DRIVE_ON) return i;
  }
  return -1;
}

TEST(DriveWarnings, TheWarmerOfTwoTemperaturesCountsWithHysteresis) {
  Robot robot = test_robot(2);
  for (JointConfig& joint : robot.joints) joint.drive.warning_temperature_degC = 80.0;
  FakeArm arm(robot);
  ASSERT_TRUE(arm.switch_on());
  const auto warned_at = [&](int mos, int rotor) {
    arm.motors[1].mos_degC = mos;
    arm.motors[1].rotor_degC = rotor;
    arm.cycle_with(kKeep);
    EXPECT_EQ(arm.state->temperature_degC[1], std::max(mos, rotor));
    EXPECT_EQ(arm.state->joint_flags[0] & joint_state_t::JOINT_WARNING, 0);
    return (arm.state->joint_flags[1] & joint_state_t::JOINT_WARNING) != 0;
  };
  EXPECT_FALSE(warned_at(60, 80));
  EXPECT_TRUE(warned_at(60, 81));
  EXPECT_EQ(
      arm.driver->warning_text(1, arm.driver->warning(1)),
      "joint2 (id 0x2): 81 degC, more than 80 (warning_temperature_degC): let it cool, or the "
      "drive will stop");
  EXPECT_TRUE(warned_at(78, 40));
  EXPECT_FALSE(warned_at(75, 40));
  EXPECT_EQ(arm.driver->warning_text(1, arm.driver->warning(1)),
            "joint2 (id 0x2): no warning any more");
  EXPECT_TRUE(warned_at(99, 40));
  EXPECT_EQ(arm.state->drive_state, +joint_state_t::DRIVE_ON);
}

TEST(DriveWarnings, WithoutALimitThereIsNone) {
  FakeArm arm(test_robot(1));
  ASSERT_TRUE(arm.switch_on());
  arm.motors[0].mos_degC = 200;
  arm.cycle_with(kKeep);
  EXPECT_FALSE(arm.driver->warning(0).any());
}

/// limit_temperature_degC 90, and 80 to warn of.
Robot robot_with_limits(int joints) {
  Robot robot = test_robot(joints);
  for (JointConfig& joint : robot.joints) {
    joint.drive.warning_temperature_degC = 80.0;
    joint.drive.limit_temperature_degC = 90.0;
  }
  return robot;
}
/// Its drives' own limit, register 2 of each, is 100 degC.
FakeArm arm_with_limits(int joints) {
  FakeArm arm(robot_with_limits(joints));
  for (testing::FakeMotor& motor : arm.motors) motor.set_float(2, 100.0);
  return arm;
}
void run(FakeArm* arm, int cycles) {
  for (int i = 0; i < cycles; ++i) arm->cycle_with(kKeep);
}

TEST(Heat, TenHotRepliesInARowStopTheArmWhichTheDrivesHold) {
  FakeArm arm = arm_with_limits(2);
  ASSERT_TRUE(arm.switch_on());
  arm.command.tau_gravity[1] = 0.3;
  arm.motors[1].rotor_degC = 91;
  EXPECT_EQ(cycles_until_off(&arm, 100), 10);
  EXPECT_EQ(arm.state->drive_state, +joint_state_t::DRIVE_HOLD);
  EXPECT_EQ(arm.state->fault, +joint_state_t::FAULT_TEMPERATURE);
  EXPECT_EQ(arm.state->fault_joint, 1);
  EXPECT_EQ(arm.driver->fault_detail(), 91);
  EXPECT_EQ(arm.driver->fault_text(arm.state->fault, 1, 91),
            "91 degC, limit 90 (limit_temperature_degC)");
  EXPECT_EQ(arm.driver->warning_text(1, arm.driver->warning(1)),
            "joint2 (id 0x2): 91 degC, more than 90 (limit_temperature_degC): not used again "
            "before it is down to 85");
  EXPECT_FALSE(arm.driver->warning(0).any());
  run(&arm, 200);  // 50 N m/rad of 500, 1 N m s/rad of 5, in 4095 counts
  for (const testing::FakeMotor& motor : arm.motors) {
    EXPECT_EQ(raw_command(motor.last()).kp, 410);
    EXPECT_EQ(raw_command(motor.last()).kd, 819);
  }
}

// A byte of the reply holds up to 255.
TEST(Heat, OneHeatHasOneTemperature) {
  FakeArm arm = arm_with_limits(2);
  ASSERT_TRUE(arm.switch_on());
  arm.motors[1].rotor_degC = 150;
  ASSERT_EQ(cycles_until_off(&arm, 100), 10);
  const std::string fault = arm.driver->fault_text(arm.state->fault, 1, arm.driver->fault_detail());
  EXPECT_EQ(fault, "150 degC, limit 90 (limit_temperature_degC)");
  const std::string warning = arm.driver->warning_text(1, arm.driver->warning(1));
  EXPECT_EQ(warning.find("joint2 (id 0x2): 150 degC, more than 90"), 0U) << warning;
}

TEST(Heat, OddReadingsAndTheLimitItselfAreNone) {
  FakeArm arm = arm_with_limits(1);
  ASSERT_TRUE(arm.switch_on());
  for (int second = 0; second < 3; ++second) {
    arm.motors[0].mos_degC = 255;
    run(&arm, 9);
    arm.motors[0].mos_degC = 90;
    run(&arm, 50);
    EXPECT_EQ(arm.state->drive_state, +joint_state_t::DRIVE_ON);
  }
}

TEST(Heat, AMissingReplyIsNeitherHotNorCool) {
  FakeArm arm = arm_with_limits(1);
  ASSERT_TRUE(arm.switch_on());
  arm.motors[0].mos_degC = 91;
  run(&arm, 9);
  arm.motors[0].silent = true;
  run(&arm, 2);
  EXPECT_EQ(arm.state->drive_state, +joint_state_t::DRIVE_ON);
  arm.motors[0].silent = false;
  run(&arm, 1);
  EXPECT_EQ(arm.state->fault, +joint_state_t::FAULT_TEMPERATURE);
}

TEST(Heat, IsAcknowledgedOnceItIsFiveKelvinBelow) {
  constexpr int kAcknowledge = joint_command_t::REQUEST_ACKNOWLEDGE;
  FakeArm arm = arm_with_limits(2);
  ASSERT_TRUE(arm.switch_on());
  arm.motors[1].mos_degC = 91;
  ASSERT_EQ(cycles_until_off(&arm, 100), 10);
  arm.motors[1].mos_degC = 86;
  EXPECT_FALSE(arm.run_until(joint_state_t::DRIVE_ON, kAcknowledge, 300));
  EXPECT_EQ(arm.state->fault, +joint_state_t::FAULT_TEMPERATURE);
  arm.motors[1].mos_degC = 85;
  EXPECT_TRUE(arm.run_until(joint_state_t::DRIVE_ON, kAcknowledge, 300));
  EXPECT_EQ(arm.state->fault, +joint_state_t::FAULT_NONE);
}

// The way to let it cool: released, and not enabled before.
TEST(Heat, AReleasedArmIsNotEnabledBefore) {
  FakeArm arm = arm_with_limits(2);
  ASSERT_TRUE(arm.switch_on());
  arm.motors[1].mos_degC = 91;
  ASSERT_EQ(cycles_until_off(&arm, 100), 10);
  ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_OFF, joint_command_t::REQUEST_OFF));
  EXPECT_FALSE(arm.run_until(joint_state_t::DRIVE_ON, joint_command_t::REQUEST_ON, 300));
  EXPECT_EQ(arm.motors[0].error, 0) << "none of them";
  arm.motors[1].mos_degC = 84;
  EXPECT_TRUE(arm.run_until(joint_state_t::DRIVE_ON, joint_command_t::REQUEST_ON, 300));
}

TEST(Heat, OfTwoMotorsTheHotterCounts) {
  Robot robot = robot_with_limits(1);
  testing::add_second_motor(&robot.joints[0]);
  FakeArm arm(robot);
  for (testing::FakeMotor& motor : arm.motors) motor.set_float(2, 100.0);
  ASSERT_TRUE(arm.switch_on());
  arm.motors[1].mos_degC = 95;
  EXPECT_EQ(cycles_until_off(&arm, 100), 10);
  EXPECT_EQ(arm.state->fault_joint, 0);
  EXPECT_EQ(arm.driver->fault_detail(), 95);
}

TEST(Heat, ADriveThatLetsGoBeforeIsRefused) {
  for (const double own : {100.0, 90.0, 85.0, std::nan("")}) {
    FakeArm arm = arm_with_limits(2);
    arm.motors[1].set_float(2, own);
    EXPECT_EQ(arm.run_until(joint_state_t::DRIVE_OFF, kKeep), own > 90.0) << own;
    if (own > 90.0) continue;
    EXPECT_EQ(arm.state->fault, +joint_state_t::FAULT_CONFIGURATION);
    EXPECT_EQ(arm.state->fault_joint, 1);
  }
}

// 4 rad/s at rest: -0.5 s ln(1 - (0.08 + 0.07 * 4) / (4 * 0.5)).
TEST(Feedback, AVelocityWithoutMotionStopsTheArmWithTheReason) {
  FakeArm arm(test_robot(2));
  ASSERT_TRUE(arm.switch_on());
  arm.set_speed(1, 4.0);
  EXPECT_NEAR(cycles_until_off(&arm, 1000), 99, 3);
  EXPECT_EQ(arm.state->drive_state, +joint_state_t::DRIVE_HOLD);
  EXPECT_EQ(arm.state->fault, +joint_state_t::FAULT_FEEDBACK);
  EXPECT_EQ(arm.state->fault_joint, 1);
  EXPECT_EQ(arm.driver->fault_text(arm.state->fault, 1, arm.driver->fault_detail()),
            "the velocity does not fit the positions; check the encoder and the drive's scaling");
  // The drive would damp by that velocity: 4 N m of drive.
  arm.cycle_with(kKeep);
  EXPECT_EQ(raw_command(arm.motors[0].last()).kd, 819);
  EXPECT_EQ(raw_command(arm.motors[1].last()).kd, 0);
}

TEST(Feedback, IsAcknowledgedOnceItFitsAgain) {
  FakeArm arm(test_robot(1));
  ASSERT_TRUE(arm.switch_on());
  arm.set_speed(0, 4.0);
  ASSERT_GT(cycles_until_off(&arm, 1000), 0);
  EXPECT_FALSE(arm.run_until(joint_state_t::DRIVE_ON, joint_command_t::REQUEST_ACKNOWLEDGE, 500));
  arm.set_speed(0, 0.0);
  EXPECT_TRUE(arm.run_until(joint_state_t::DRIVE_ON, joint_command_t::REQUEST_ACKNOWLEDGE, 2000));
}

TEST(Feedback, AMotionThatFitsIsNone) {
  FakeArm arm(test_robot(2));
  arm.set_angle(1, 0.0);
  ASSERT_TRUE(arm.switch_on());
  for (int i = 0; i < 2000; ++i) {
    const double t = 1e-3 * i;
    arm.set_angle(1, 0.9 * std::sin(5.0 * t));
    arm.set_speed(1, 4.5 * std::cos(5.0 * t));
    arm.cycle_with(kKeep);
    ASSERT_EQ(arm.state->drive_state, +joint_state_t::DRIVE_ON) << i;
  }
}

TEST(Feedback, ATorqueThatNobodyCommandedStopsTheArm) {
  FakeArm arm(test_robot(1));
  ASSERT_TRUE(arm.switch_on());
  arm.motors[0].torque = 4.5;  // more than half of 8 N m
  EXPECT_NEAR(cycles_until_off(&arm, 1000), 101, 3);
  EXPECT_EQ(arm.state->fault, +joint_state_t::FAULT_FEEDBACK);
  EXPECT_EQ(arm.driver->fault_detail(), 3);
}

TEST(StartPose, OutsideTheLimitsIsToldWithTheCure) {
  FakeArm arm(test_robot(2));
  arm.set_angle(1, 2.5);
  ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_OFF, kKeep));
  const std::vector<std::string> lines = arm.driver->configuration_warnings();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0],
            "joint2: at 2.5, outside its limits -2 to 2: the drives cannot be enabled; move it by "
            "hand, or correct its offset_rad and sign");
}

TEST(StartPose, TheAnglesThatASingleTurnMayStandForAreTold) {
  Robot robot = test_robot(2);
  JointConfig& joint = robot.joints[1];
  joint.position_max = -(joint.position_min = -4.0);
  joint.drive.single_turn = true;
  FakeArm arm(robot);
  arm.set_angle(1, 3.0);
  ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_OFF, kKeep));
  const std::vector<std::string> lines = arm.driver->configuration_warnings();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].find("joint2: reads 3, and may be at 3 or -3.283, both within its limits -4 "
                          "to 4: the drives cannot be enabled"),
            0U)
      << lines[0];
}

}  // namespace
}  // namespace limber::test_drive_causes
