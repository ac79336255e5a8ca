// An arm that is on and carries a load, for the tests of watchdogs and fallbacks.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "tests/drivers/fake_arm.h"

namespace limber::loaded {

inline constexpr int kRequestOn = joint_command_t::REQUEST_ON;
inline constexpr int kOff = joint_state_t::DRIVE_OFF;
inline constexpr int kOn = joint_state_t::DRIVE_ON;
inline constexpr int kFallback = joint_state_t::DRIVE_HOLD;
inline constexpr int kDamp = joint_state_t::DRIVE_DAMP;
inline constexpr int kFault = joint_state_t::DRIVE_FAULT;

inline constexpr int kKp50 = 410;  // of 500 N m/rad in 4095
inline constexpr int kKd1 = 819;   // of 5 N m s/rad in 4095

using testing::FakeArm;
using testing::raw_command;
using testing::test_robot;

inline double torque_sent(const FakeArm& arm, std::size_t motor) {
  return arm.robot.joints[motor].drive.sign *
         arm.motors[motor].torque_of(raw_command(arm.motors[motor].last()).t);
}

inline std::string text_of_fault(const FakeArm& arm) {
  return arm.driver->fault_text(arm.state->fault, arm.state->fault_joint,
                                arm.driver->fault_detail());
}

/// On, with 0.4 N m of which 0.3 hold gravity, on every joint.
inline FakeArm loaded_arm(int joints, int buses = 1) {
  FakeArm arm(test_robot(joints, buses));
  EXPECT_TRUE(arm.switch_on());
  for (int i = 0; i < joints; ++i) {
    arm.command.tau[i] = 0.4;
    arm.command.tau_gravity[i] = 0.3;
  }
  for (int i = 0; i < 5; ++i) EXPECT_EQ(arm.cycle_with(kRequestOn), 0);
  return arm;
}

}  // namespace limber::loaded
