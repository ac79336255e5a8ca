// Coming back: nothing resumes by itself, and never with a jump of the torque.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/drivers/fake_arm.h"

namespace limber::test_recovery {
namespace {

using testing::FakeArm;
using testing::raw_command;
using testing::test_robot;

constexpr int kKeep = joint_command_t::REQUEST_KEEP;
constexpr int kRequestOff = joint_command_t::REQUEST_OFF;
constexpr int kRequestOn = joint_command_t::REQUEST_ON;
constexpr int kAcknowledge = joint_command_t::REQUEST_ACKNOWLEDGE;
constexpr int kConfiguring = joint_state_t::DRIVE_CONFIGURING;
constexpr int kOff = joint_state_t::DRIVE_OFF;
constexpr int kOn = joint_state_t::DRIVE_ON;
constexpr int kFallback = joint_state_t::DRIVE_HOLD;
constexpr int kDamp = joint_state_t::DRIVE_DAMP;
constexpr int kFault = joint_state_t::DRIVE_FAULT;
constexpr int kAccepted = driver_status_t::VERDICT_ACCEPTED;
constexpr int kRate = driver_status_t::VERDICT_RATE;

/// Held at 0.1 rad with the spring of the drive pulling by about -2 N m, gravity 1 N m.
FakeArm held_arm() {
  FakeArm arm(test_robot(2));
  EXPECT_TRUE(arm.switch_on());
  arm.command.tau_gravity[0] = 1.0;
  for (int i = 0; i < 3; ++i) arm.cycle_with(kRequestOn);
  for (int i = 0; i < 110; ++i) arm.half_cycle();
  EXPECT_EQ(arm.state->drive_state, kFallback);
  for (int i = 0; i < 20; ++i) {
    arm.set_angle(0, 0.06 * (i + 1) / 20.0);
    arm.half_cycle();
  }
  arm.half_cycle();
  EXPECT_NEAR(arm.state->tau_applied[0], 1.0 - 50.0 * 0.06, 0.1);
  return arm;
}

TEST(RecoveryTest, AControllerThatComesBackIsNotFollowedWithoutAnAcknowledgement) {
  FakeArm arm = held_arm();
  for (int request : {kKeep, kRequestOn}) {
    for (int i = 0; i < 300; ++i) {
      arm.command.tau[0] = arm.state->tau_applied[0];
      EXPECT_EQ(arm.cycle_with(request), kAccepted);
      EXPECT_EQ(arm.state->drive_state, kFallback);
      EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_CONTROLLER_LOST + 0);
    }
  }
}

TEST(RecoveryTest, TakesOverFromTheTorquePresentAndFromNoOther) {
  for (int request : {kRequestOn, kAcknowledge}) {
    FakeArm arm = held_arm();
    arm.command.tau[0] = 5.0;  // the acknowledgement itself moves nothing, whatever it carries
    ASSERT_EQ(arm.cycle_with(kAcknowledge), kAccepted);
    arm.half_cycle();
    EXPECT_EQ(arm.state->drive_state, kFallback);
    EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_NONE + 0);
    const double present = arm.state->tau_applied[0];
    arm.command.request = static_cast<std::int8_t>(request);
    for (double off : {0.51, -0.51, 3.0}) {
      arm.command.tau[0] = present + off;
      EXPECT_EQ(arm.answer_state(), kRate);
    }
    arm.command.tau[0] = present + 0.49;
    EXPECT_EQ(arm.answer_state(), kAccepted);
    arm.half_cycle();
    EXPECT_EQ(arm.state->drive_state, kOn);
    const auto raw = raw_command(arm.motors[0].last());
    EXPECT_EQ(raw.kp, 0);
    EXPECT_EQ(raw.kd, 0);
    EXPECT_NEAR(arm.motors[0].torque_of(raw.t), present + 0.49, 5e-3);
    // And the next step counts from there.
    arm.command.tau[0] = present + 1.0;
    EXPECT_EQ(arm.answer_state(), kRate);
    arm.command.tau[0] = present + 0.98;
    EXPECT_EQ(arm.answer_state(), kAccepted);
  }
}

TEST(RecoveryTest, KeepDoesNotTakeOver) {
  FakeArm arm = held_arm();
  arm.cycle_with(kAcknowledge);
  for (int i = 0; i < 50; ++i) {
    arm.half_cycle();
    arm.command.tau[0] = arm.state->tau_applied[0];
    arm.command.request = kKeep;
    EXPECT_EQ(arm.answer_state(), kAccepted);
  }
  EXPECT_EQ(arm.state->drive_state, kFallback);
}

TEST(RecoveryTest, SilenceAfterTheAcknowledgementTakesItBack) {
  FakeArm arm = held_arm();
  arm.cycle_with(kAcknowledge);
  for (int i = 0; i < 4; ++i) arm.half_cycle();
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_CONTROLLER_LOST + 0);
  arm.command.tau[0] = arm.state->tau_applied[0];
  arm.cycle_with(kRequestOn);
  arm.half_cycle();
  EXPECT_EQ(arm.state->drive_state, kFallback);
}

TEST(RecoveryTest, ARestartedControllerHasToWaitAndToAcknowledge) {
  FakeArm arm = held_arm();
  arm.command.controller = 99;
  int cycles = 0;
  while (arm.cycle_with(kRequestOn) != kAccepted && cycles < 400) {
    EXPECT_EQ(arm.state->drive_state, kFallback);
    ++cycles;
  }
  EXPECT_NEAR(cycles + 110 + 21, 250, 3);
  arm.cycle_with(kAcknowledge);
  arm.half_cycle();
  arm.command.tau[0] = arm.state->tau_applied[0];
  arm.command.request = kRequestOn;
  EXPECT_EQ(arm.answer_state(), kAccepted);
  arm.half_cycle();
  EXPECT_EQ(arm.state->drive_state, kOn);
}

TEST(RecoveryTest, AnAcknowledgementDoesNothingAsLongAsTheCauseIsThere) {
  enum Cause { kSilent, kDriveError, kOutside, kFast };
  for (Cause cause : {kSilent, kDriveError, kOutside, kFast}) {
    FakeArm arm = held_arm();
    if (cause == kSilent) arm.motors[1].silent = true;
    if (cause == kDriveError) arm.motors[1].error = 0xB;
    if (cause == kFast) arm.set_speed(1, 5.6);
    for (double q = 0.3; cause == kOutside && q < 2.1; q += 0.005) {
      arm.set_angle(1, q);
      arm.cycle_with(kKeep);
    }
    for (int i = 0; i < 10; ++i) {
      arm.cycle_with(kAcknowledge);
      EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_CONTROLLER_LOST + 0) << cause;  // the first
    }
    EXPECT_EQ(arm.state->drive_state, cause == kFast ? kDamp : kFallback);
  }
}

TEST(RecoveryTest, DampIsLeftLikeHold) {
  FakeArm arm(test_robot(2));
  ASSERT_TRUE(arm.switch_on());
  arm.set_speed(0, 5.6);
  for (int i = 0; i < 3; ++i) arm.cycle_with(kRequestOn);
  ASSERT_EQ(arm.state->drive_state, kDamp);
  arm.set_speed(0, 0.0);
  for (int i = 0; i < 5; ++i) arm.cycle_with(kRequestOn);
  ASSERT_EQ(arm.state->drive_state, kDamp);
  arm.cycle_with(kAcknowledge);
  arm.half_cycle();
  for (int j = 0; j < 2; ++j) arm.command.tau[j] = arm.state->tau_applied[j];
  arm.command.request = kRequestOn;
  EXPECT_EQ(arm.answer_state(), kAccepted);
  arm.half_cycle();
  EXPECT_EQ(arm.state->drive_state, kOn);
}

TEST(RecoveryTest, SwitchingOffAfterAFaultChecksEverythingAnew) {
  FakeArm arm = held_arm();
  arm.motors[1].error = 0xD;
  arm.motors[1].registers[9] = 0;  // it was reset: its watchdog is off
  for (int i = 0; i < 5; ++i) arm.cycle_with(kRequestOn);
  arm.cycle_with(kRequestOff);
  arm.cycle_with(kKeep);
  EXPECT_EQ(arm.state->drive_state, kConfiguring);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_NONE + 0);
  ASSERT_TRUE(arm.run_until(kOff, kKeep, 20));
  EXPECT_EQ(arm.motors[1].registers[9], 400U);
  EXPECT_TRUE(arm.run_until(kOn, kRequestOn, 20));
  EXPECT_EQ(arm.motors[1].error, 1);
}

// Held by the others it was moved further than any motor turns in the cycles that are bridged.
TEST(RecoveryTest, ADriveThatWasLostAndComesBackElsewhereIsHeardAgain) {
  FakeArm arm(test_robot(2));
  ASSERT_TRUE(arm.switch_on());
  arm.motors[0].silent = true;
  for (int i = 0; i < 20; ++i) arm.cycle_with(kRequestOn);
  ASSERT_EQ(arm.state->drive_state, kFallback);
  arm.motors[0].silent = false;
  arm.set_angle(0, 0.5);
  for (int i = 0; i < 100; ++i) arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kFallback) << "not without an acknowledgement";
  EXPECT_EQ(arm.state->age_cycles[0], 0);
  EXPECT_NEAR(arm.state->q[0], 0.5, 4e-4);
  // From here on it is watched again: nothing turns by 1 rad in a millisecond.
  arm.set_angle(0, 1.5);
  arm.cycle_with(kRequestOn);
  EXPECT_NEAR(arm.state->q[0], 0.5, 4e-4);
  arm.set_angle(0, 0.5);
  arm.cycle_with(kRequestOn);
  arm.cycle_with(kAcknowledge);
  arm.half_cycle();
  for (int j = 0; j < 2; ++j) arm.command.tau[j] = arm.state->tau_applied[j];
  arm.command.request = kRequestOn;
  EXPECT_EQ(arm.answer_state(), kAccepted);
  arm.half_cycle();
  EXPECT_EQ(arm.state->drive_state, kOn);
}

TEST(RecoveryTest, AfterAFaultTheArmStartsFromTheBeginning) {
  FakeArm arm(test_robot(2));
  ASSERT_TRUE(arm.switch_on());
  for (testing::FakeMotor& motor : arm.motors) motor.silent = true;
  for (int i = 0; i < 20; ++i) arm.cycle_with(kRequestOn);
  ASSERT_EQ(arm.state->drive_state, kFault);
  for (testing::FakeMotor& motor : arm.motors) motor.silent = false;
  arm.set_angle(0, 1.0);  // the arm was moved meanwhile
  for (int request : {kKeep, kRequestOn, kRequestOff}) {
    for (int i = 0; i < 20; ++i) arm.cycle_with(request);
    EXPECT_EQ(arm.state->drive_state, kFault);
  }
  EXPECT_EQ(arm.motors[0].error, 0);
  // A controller acknowledges only what is fresh again.
  EXPECT_EQ(arm.state->age_cycles[0], 0);
  EXPECT_NEAR(arm.state->q[0], 1.0, 4e-4);
  arm.cycle_with(kAcknowledge);
  ASSERT_TRUE(arm.run_until(kOff, kKeep, 20));
  arm.cycle_with(kKeep);
  EXPECT_NEAR(arm.state->q[0], 1.0, 4e-4);
  EXPECT_TRUE(arm.run_until(kOn, kRequestOn, 20));
}

}  // namespace
}  // namespace limber::test_recovery
