// The controller is gone: what is bridged, and what the drives are then told.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/drive/rest_torque.h"
#include "tests/drivers/loaded_arm.h"

namespace limber::test_controller_lost {
namespace {

using loaded::kFallback;
using loaded::kKd1;
using loaded::kKp50;
using loaded::kOn;
using loaded::kRequestOn;
using loaded::loaded_arm;
using loaded::text_of_fault;
using loaded::torque_sent;
using testing::FakeArm;
using testing::raw_command;

TEST(ControllerLostTest, TwoCyclesAreBridgedTheThirdHolds) {
  FakeArm arm = loaded_arm(2);
  arm.half_cycle();  // sends the last torque that was accepted
  for (int missing = 1; missing <= 2; ++missing) {
    arm.half_cycle();
    EXPECT_EQ(arm.state->drive_state, kOn);
    EXPECT_NEAR(torque_sent(arm, 0), 0.4, 5e-3);
    EXPECT_EQ(raw_command(arm.motors[0].last()).kd, 0);
  }
  arm.half_cycle();
  EXPECT_EQ(arm.state->drive_state, kFallback);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_CONTROLLER_LOST + 0);
  EXPECT_EQ(arm.read_status().commands_missing, 3);
}

TEST(ControllerLostTest, GravityAndDampingThenThePositionReached) {
  FakeArm arm = loaded_arm(2);
  for (int i = 0; i < 4; ++i) arm.half_cycle();
  ASSERT_EQ(arm.state->drive_state, kFallback);
  arm.set_speed(0, 1.0);
  for (int cycle = 1; cycle <= 100; ++cycle) {  // that was the first of them
    for (std::size_t j = 0; j < 2; ++j) {
      const auto raw = raw_command(arm.motors[j].last());
      EXPECT_EQ(raw.kp, 0) << cycle;
      if (cycle > 3 || j == 1) {
        EXPECT_EQ(raw.kd, kKd1) << cycle;  // 1 N m in steps of 0.5 N m
      }
      EXPECT_NEAR(torque_sent(arm, j), 0.3, 5e-3);
    }
    arm.set_angle(0, 0.1 * cycle / 100.0);  // sinks a little meanwhile
    arm.half_cycle();
  }
  arm.set_speed(0, 0.0);
  for (int cycle = 0; cycle < 500; ++cycle) {
    const auto raw = raw_command(arm.motors[0].last());
    EXPECT_EQ(raw.kp, kKp50);
    EXPECT_EQ(raw.kd, kKd1);
    EXPECT_NEAR(-12.5 + raw.p * 25.0 / 65535.0, 0.099, 1e-3);  // where it was when damping ended
    EXPECT_NEAR(torque_sent(arm, 0), 0.3, 5e-3);
    arm.half_cycle();
  }
  // The other joint counts the other way round from 0.3 rad.
  EXPECT_NEAR(-12.5 + raw_command(arm.motors[1].last()).p * 25.0 / 65535.0, 0.0, 5e-4);
  EXPECT_EQ(arm.state->drive_state, kFallback);
}

/// Rests for 0.3 s at 0.4 N m, while the gravity torque becomes wrong by 0.9 of the limit.
FakeArm resting_arm(double speed) {
  FakeArm arm = loaded_arm(1);
  arm.set_speed(0, speed);
  const double wrong = -0.9 * arm.robot.joints[0].torque_limit_Nm;
  for (int i = 0; i < 300; ++i) {
    arm.command.tau_gravity[0] = std::max(arm.command.tau_gravity[0] - 0.1, wrong);
    EXPECT_EQ(arm.cycle_with(kRequestOn), 0);
  }
  EXPECT_EQ(arm.command.tau_gravity[0], wrong);
  return arm;
}

TEST(ControllerLostTest, ARestingJointKeepsWhatKeptItThere) {
  FakeArm arm = resting_arm(0.0);
  for (int i = 0; i < 600; ++i) {
    arm.half_cycle();
    ASSERT_NEAR(torque_sent(arm, 0), 0.4, 5e-3) << i;
  }
  EXPECT_EQ(arm.state->drive_state, kFallback);
}

TEST(ControllerLostTest, AMovingJointGoesToTheGravityTorque) {
  FakeArm arm = resting_arm(0.1);
  for (int i = 0; i < 100; ++i) arm.half_cycle();
  EXPECT_NEAR(torque_sent(arm, 0), arm.command.tau_gravity[0], 1e-2);
}

// A controller that is there, and asks for the hold, may have its reason in the joint.
TEST(ControllerLostTest, AHoldOnRequestGoesToTheGravityTorque) {
  FakeArm arm = resting_arm(0.0);
  EXPECT_EQ(arm.cycle_with(joint_command_t::REQUEST_HOLD), 0);
  for (int i = 0; i < 100; ++i) arm.cycle_with(joint_command_t::REQUEST_KEEP);
  EXPECT_NEAR(torque_sent(arm, 0), arm.command.tau_gravity[0], 1e-2);
}

// Meanwhile the joint may have been given, or rid of, a payload.
TEST(ControllerLostTest, WhatKeptItBeforeTheDrivesHeldIsForgotten) {
  FakeArm arm = resting_arm(0.0);
  for (int i = 0; i < 20; ++i) arm.half_cycle();
  ASSERT_EQ(arm.state->drive_state, kFallback);
  arm.command.tau[0] = 0.4;
  arm.command.tau_gravity[0] = 0.1;
  for (int i = 0; i < 50 && arm.state->drive_state != kOn; ++i) {
    arm.cycle_with(i == 0 ? joint_command_t::REQUEST_ACKNOWLEDGE : kRequestOn);
  }
  ASSERT_EQ(arm.state->drive_state, kOn);
  for (int i = 0; i < 150; ++i) arm.cycle_with(kRequestOn);  // less than a rest takes
  for (int i = 0; i < 90; ++i) arm.half_cycle();
  EXPECT_NEAR(torque_sent(arm, 0), 0.1, 1e-2);
}

TEST(RestTorqueTest, IsTheMeanOfAFifthOfASecondOfRest) {
  RestTorque rest(10.0, 1000.0);
  for (int i = 0; i < 200; ++i) {
    EXPECT_FALSE(rest.known());
    rest.add(i % 2 == 0 ? 3.1 : 2.9, 0.0);
  }
  EXPECT_TRUE(rest.known());
  EXPECT_NEAR(rest.mean(), 3.0, 1e-3);
}

TEST(RestTorqueTest, MotionAndASteppedTorqueEndIt) {
  for (const auto& [torque, speed] : {std::pair{3.0, 0.06}, {3.6, 0.0}, {std::nan(""), 0.0}}) {
    RestTorque rest(10.0, 1000.0);
    for (int i = 0; i < 400; ++i) rest.add(3.0, 0.0);
    ASSERT_TRUE(rest.known());
    rest.add(torque, speed);
    EXPECT_FALSE(rest.known()) << torque << " " << speed;
    for (int i = 0; i < 201; ++i) rest.add(3.0, 0.0);
    EXPECT_TRUE(rest.known()) << torque << " " << speed;
  }
}

TEST(ControllerLostTest, AnAnswerInTimeResetsTheCount) {
  FakeArm arm = loaded_arm(1);
  for (int i = 0; i < 200; ++i) {
    arm.half_cycle();
    arm.half_cycle();
    arm.half_cycle();
    ASSERT_EQ(arm.answer_state(), 0);
    ASSERT_EQ(arm.state->drive_state, kOn);
  }
}

TEST(HoldTest, SpringGivesWayAtTheTorqueLimit) {
  FakeArm arm = loaded_arm(1);
  for (int i = 0; i < 110; ++i) arm.half_cycle();
  // Pushed by 1 rad: 50 N m/rad would be 50 N m; with 0.3 of gravity 7.7 are left: 0.154 rad.
  arm.set_speed(0, 0.2);
  for (int i = 0; i < 5000; ++i) {
    arm.set_angle(0, 1.0 * i / 5000.0);
    arm.half_cycle();
    EXPECT_LE(std::abs(arm.state->tau_applied[0]), 8.0 + 0.5);  // damping, and a cycle's motion
  }
  arm.half_cycle();
  const auto raw = raw_command(arm.motors[0].last());
  EXPECT_NEAR(-12.5 + raw.p * 25.0 / 65535.0, 0.9998 - 7.7 / 50.0, 1e-3);
}

TEST(OverrunTest, TheLongestIsTold) {
  FakeArm arm = loaded_arm(2);
  arm.driver->report_overruns(212'300'000);
  arm.cycle_with(kRequestOn);
  ASSERT_EQ(arm.state->fault, joint_state_t::FAULT_OVERRUN + 0);
  EXPECT_EQ(text_of_fault(arm), "limber-driver stood still, or took, 212 ms in a cycle of 1 ms");
}

}  // namespace
}  // namespace limber::test_controller_lost
