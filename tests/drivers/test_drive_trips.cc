// Encoders, drive errors, motion beyond the limits: what trips, and what the drives are told.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/drivers/faulty_bus.h"
#include "tests/drivers/loaded_arm.h"

namespace limber::test_drive_trips {
namespace {

using loaded::kDamp;
using loaded::kFallback;
using loaded::kFault;
using loaded::kKd1;
using loaded::kKp50;
using loaded::kOff;
using loaded::kOn;
using loaded::kRequestOn;
using loaded::loaded_arm;
using loaded::torque_sent;
using testing::FakeArm;
using testing::raw_command;
using testing::test_robot;

TEST(EncoderTest, OneGlitchIsRejectedAStepIsAFault) {
  FakeArm arm = loaded_arm(2);
  arm.set_angle(0, 0.5);
  arm.cycle_with(kRequestOn);
  EXPECT_NEAR(arm.state->q[0], 0.0, 4e-4);
  EXPECT_EQ(arm.read_status().replies_invalid[0], 1);
  arm.set_angle(0, 0.0);
  arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kOn);
  arm.set_angle(0, 0.5);
  for (int i = 0; i < 3; ++i) arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kFallback);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_REPLY_INVALID + 0);
  EXPECT_EQ(arm.state->fault_joint, 0);
  EXPECT_EQ(arm.read_status().replies_lost[0], 0) << "they came";
  for (int i = 0; i < 200; ++i) arm.cycle_with(kRequestOn);
  EXPECT_EQ(raw_command(arm.motors[0].last()).kp, 0);  // never held at an angle it is not at
}

// Its angle is told again, so that the loss can be acknowledged; it is held there only after that.
TEST(EncoderTest, AStepIsReportedAndHeldOnceAcknowledged) {
  FakeArm arm = loaded_arm(2);
  arm.set_angle(0, 0.5);
  for (int i = 0; i < 300; ++i) arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kFallback);
  EXPECT_NEAR(arm.state->q[0], 0.5, 4e-4);
  EXPECT_NE(arm.state->joint_flags[0] & joint_state_t::JOINT_FRESH, 0);
  EXPECT_EQ(raw_command(arm.motors[0].last()).kp, 0);
  arm.cycle_with(joint_command_t::REQUEST_ACKNOWLEDGE);
  arm.half_cycle();
  for (int j = 0; j < 2; ++j) arm.command.tau[j] = arm.state->tau_applied[j];
  arm.command.request = kRequestOn;
  arm.answer_state();
  arm.half_cycle();
  EXPECT_EQ(arm.state->drive_state, kOn);
}

TEST(DriveErrorTest, EveryErrorHoldsTheOthersAndIsNotTalkedOver) {
  for (int error : {0, 2, 7, 8, 9, 0xA, 0xB, 0xC, 0xD, 0xE, 0xF}) {
    FakeArm arm = loaded_arm(2);
    arm.motors[1].error = error;
    arm.cycle_with(kRequestOn);
    EXPECT_EQ(arm.state->drive_state, kFallback) << error;
    EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_DRIVE_ERROR + 0);
    EXPECT_EQ(arm.state->fault_joint, 1);
    EXPECT_EQ((arm.state->joint_flags[1] & joint_state_t::JOINT_DRIVE_ERROR) != 0, error > 1);
    for (int i = 0; i < 300; ++i) arm.cycle_with(kRequestOn);
    EXPECT_EQ(arm.motors[1].last().id, 0x7FFU);
    EXPECT_EQ(raw_command(arm.motors[0].last()).kp, kKp50);
    EXPECT_EQ(arm.state->drive_state, kFallback);
  }
}

TEST(DriveErrorTest, WhenNoDriveIsEnabledAnyMoreThereIsNothingToHold) {
  FakeArm arm = loaded_arm(2);
  for (testing::FakeMotor& motor : arm.motors) motor.error = 0xD;
  arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kFault);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_DRIVE_ERROR + 0);
}

// A tenth of a second, and 20 cycles at least: three here would be too few for all steps.
TEST(EnablingTest, LastsAsLongAsTheDrivesMayTakeAndNoCycleLonger) {
  for (const auto& [rate_hz, most] : {std::pair{1000.0, 100}, {30.0, 20}}) {
    Robot robot = test_robot(2);
    robot.rate_hz = rate_hz;
    FakeArm arm(robot);
    ASSERT_TRUE(arm.run_until(kOff, joint_command_t::REQUEST_KEEP));
    arm.motors[0].obedient = false;
    ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_ENABLING, kRequestOn));
    int cycles = 1;
    for (; arm.state->drive_state == joint_state_t::DRIVE_ENABLING && cycles < 1000; ++cycles)
      arm.cycle_with(kRequestOn);
    EXPECT_EQ(arm.state->drive_state, kFault);
    EXPECT_EQ(cycles, most) << rate_hz << " Hz";
    EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_DRIVE_ERROR + 0);
    EXPECT_EQ(arm.state->fault_joint, 0);
    EXPECT_EQ(arm.driver->fault_text(arm.state->fault, 0, arm.driver->fault_detail()),
              "did not enable in time (its state is disabled, without an error)");
  }
}

// While they brake as well: the state is told as it is, and a fault begins the start-up anew.
TEST(DriveErrorTest, WhenNoDriveIsEnabledInDampTheArmIsInFault) {
  FakeArm arm = loaded_arm(2);
  arm.set_speed(0, 5.6);
  for (int i = 0; i < 3; ++i) arm.cycle_with(kRequestOn);
  ASSERT_EQ(arm.state->drive_state, kDamp);
  for (testing::FakeMotor& motor : arm.motors) motor.error = 0;
  arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kFault);
}

TEST(EncoderTest, AnArmThatIsOffMaySwing) {
  FakeArm arm(test_robot(2));
  ASSERT_TRUE(arm.run_until(kOff, joint_command_t::REQUEST_KEEP));
  for (int i = 0; i < 100; ++i) {
    const double q = 0.1 * (i % 20);  // 100 rad/s, and back at once
    arm.set_angle(0, q);
    arm.cycle_with(joint_command_t::REQUEST_KEEP);
    EXPECT_NEAR(arm.state->q[0], q, 4e-4);
    EXPECT_EQ(arm.state->drive_state, kOff);
  }
  EXPECT_EQ(arm.read_status().replies_invalid[0], 0);
}

TEST(MotionTest, OutsideTheLimitsHolds) {
  FakeArm arm = loaded_arm(1);
  arm.set_speed(0, 5.0);
  for (double q = 0.0; q < 2.0195; q += 0.005) {
    arm.set_angle(0, q);
    arm.cycle_with(kRequestOn);
    ASSERT_EQ(arm.state->drive_state, kOn) << q;
  }
  arm.set_angle(0, 2.021);
  arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kFallback);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_POSITION + 0);
  EXPECT_NE(arm.state->joint_flags[0] & joint_state_t::JOINT_OUT_OF_RANGE, 0);
}

TEST(MotionTest, ThreeCyclesAbove110PercentOfTheVelocityBrake) {
  for (double v : {5.45, -5.45, 5.55, -5.55}) {  // limit 5 rad/s
    FakeArm arm = loaded_arm(2);
    arm.set_speed(1, v);
    for (int i = 0; i < 2; ++i) {
      arm.cycle_with(kRequestOn);
      EXPECT_EQ(arm.state->drive_state, kOn);
    }
    arm.cycle_with(kRequestOn);
    EXPECT_EQ(arm.state->drive_state, std::abs(v) > 5.5 ? kDamp : kOn);
  }
}

TEST(MotionTest, DampIsDampingAndNothingElse) {
  FakeArm arm = loaded_arm(2);
  arm.set_speed(1, 5.6);
  for (int i = 0; i < 3; ++i) arm.cycle_with(kRequestOn);
  arm.set_speed(1, 0.0);
  // 0.4 N m are gone at the torque's rate, 0.5 N m each cycle
  for (int i = 0; i < 2; ++i) arm.cycle_with(kRequestOn);
  for (int i = 0; i < 300; ++i) {
    arm.cycle_with(kRequestOn);
    for (std::size_t j = 0; j < 2; ++j) {
      const auto raw = raw_command(arm.motors[j].last());
      EXPECT_EQ(raw.kp, 0);
      EXPECT_EQ(raw.kd, kKd1);
      EXPECT_NEAR(torque_sent(arm, j), 0.0, 5e-3) << i;
    }
  }
  EXPECT_EQ(arm.state->drive_state, kDamp);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_VELOCITY + 0);
  EXPECT_EQ(arm.state->fault_joint, 1);
}

}  // namespace
}  // namespace limber::test_drive_trips
