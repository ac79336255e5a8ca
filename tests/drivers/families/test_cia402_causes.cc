// What CANopen drives tell beside their state: warnings, emergencies, a target that is ignored.
#include <gtest/gtest.h>

#include "tests/drivers/families/fake_cia402.h"

namespace limber::test_cia402_causes {
namespace {

using testing::cia402_robot;
using testing::Cia402Arm;

constexpr int kKeep = joint_command_t::REQUEST_KEEP;
constexpr int kWarningBit = 0x0080;
constexpr int kIgnoring = 0x0237;  // operation enabled, bit 12 zero

bool warned(const Cia402Arm& arm, int joint) {
  return (arm.state->joint_flags[joint] & joint_state_t::JOINT_WARNING) != 0;
}
std::string warning_text(const Cia402Arm& arm, int motor) {
  return arm.driver->warning_text(motor, arm.driver->warning(motor));
}

TEST(Cia402Warnings, Bit7IsTold) {
  Cia402Arm arm;
  ASSERT_TRUE(arm.switch_on());
  EXPECT_FALSE(warned(arm, 1));
  arm.motors[1].set_status(testing::kOperationEnabled | kWarningBit);
  arm.cycle_with(kKeep);
  EXPECT_TRUE(warned(arm, 1));
  EXPECT_FALSE(warned(arm, 0));
  EXPECT_EQ(warning_text(arm, 1), "joint2 (node 4): the drive warns (statusword, bit 7)");
  EXPECT_EQ(arm.state->drive_state, +joint_state_t::DRIVE_ON);
}

// Node 3: identifier 083; code 4310h, temperature bit; then code 0.
TEST(Cia402Warnings, AnEmergencyWithoutAFaultIsToldUntilItIsTakenBack) {
  Cia402Arm arm;
  ASSERT_TRUE(arm.switch_on());
  arm.motor_ends[0]->send(testing::parse("083#1043080000000000"));
  arm.cycle_with(kKeep);
  EXPECT_TRUE(warned(arm, 0));
  EXPECT_EQ(warning_text(arm, 0), "joint1 (node 3): emergency 4310h: drive too hot");
  EXPECT_EQ(arm.state->drive_state, +joint_state_t::DRIVE_ON);
  arm.motor_ends[0]->send(testing::parse("083#0000000000000000"));
  arm.cycle_with(kKeep);
  EXPECT_FALSE(warned(arm, 0));
}

TEST(Cia402Faults, TheEmergencyIsPartOfTheReason) {
  Cia402Arm arm;
  ASSERT_TRUE(arm.switch_on());
  arm.motor_ends[0]->send(testing::parse("084#1023030000000000"));
  arm.motors[1].set_status(testing::kFault);
  arm.cycle_with(kKeep);
  EXPECT_EQ(arm.state->fault, +joint_state_t::FAULT_DRIVE_ERROR);
  EXPECT_EQ(arm.driver->fault_text(arm.state->fault, 1, arm.driver->fault_detail()),
            "fault (statusword 0218h), emergency 2310h: over-current");
  EXPECT_FALSE(warned(arm, 1));
  // The fault is reset; this drive does not take its emergency back.
  ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_OFF, joint_command_t::REQUEST_OFF));
  ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_ON, joint_command_t::REQUEST_ON));
  EXPECT_FALSE(warned(arm, 1));
}

TEST(Cia402Faults, ATargetThatIsIgnoredStopsTheArmAfterThreeStates) {
  Cia402Arm arm;
  ASSERT_TRUE(arm.switch_on());
  arm.motors[0].set_status(kIgnoring);
  for (int i = 0; i < 2; ++i) {
    arm.cycle_with(kKeep);
    EXPECT_EQ(arm.state->drive_state, +joint_state_t::DRIVE_ON);
  }
  arm.cycle_with(kKeep);
  EXPECT_EQ(arm.state->drive_state, +joint_state_t::DRIVE_HOLD);
  EXPECT_EQ(arm.state->fault, +joint_state_t::FAULT_DRIVE_ERROR);
  EXPECT_EQ(arm.state->fault_joint, 0);
  EXPECT_NE(arm.state->joint_flags[0] & joint_state_t::JOINT_DRIVE_ERROR, 0);
  EXPECT_EQ(arm.driver->fault_text(arm.state->fault, 0, arm.driver->fault_detail()),
            "operation enabled (statusword 0237h), but ignores its target (bit 12 is 0): halt, "
            "another mode, or a limit");
  // It still has power: it is commanded, and switched off like the others.
  arm.cycle_with(kKeep);
  EXPECT_EQ(arm.motors[0].controlword(), 0x0F);
  EXPECT_FALSE(arm.run_until(joint_state_t::DRIVE_ON, joint_command_t::REQUEST_ACKNOWLEDGE, 20));
  arm.motors[0].set_status(testing::kOperationEnabled);
  EXPECT_TRUE(arm.run_until(joint_state_t::DRIVE_ON, joint_command_t::REQUEST_ACKNOWLEDGE, 20));
}

// A brake may have to open first: enabled is who follows.
TEST(Cia402Enable, WaitsForTheDriveToFollow) {
  Cia402Arm arm;
  ASSERT_TRUE(arm.start());
  arm.motors[0].when_enabled = kIgnoring;
  EXPECT_FALSE(arm.run_until(joint_state_t::DRIVE_ON, joint_command_t::REQUEST_ON, 500));
  EXPECT_EQ(arm.state->drive_state, +joint_state_t::DRIVE_ENABLING);
  arm.motors[0].set_status(testing::kOperationEnabled);
  EXPECT_TRUE(arm.run_until(joint_state_t::DRIVE_ON, joint_command_t::REQUEST_ON, 5));
}

/// The fault that one frame of somebody else makes while the arm is ON.
int fault_of(const std::string& frame) {
  Cia402Arm arm;
  EXPECT_TRUE(arm.switch_on());
  arm.motor_ends[0]->send(testing::parse(frame));
  arm.cycle_with(kKeep);
  return arm.state->fault;
}

// Nodes 3 and 4.
TEST(Cia402Orders, WhatCommandsOrWritesIsForeign) {
  for (const char* frame : {
           "203#0F000000",          // RPDO1
           "504#00",                // RPDO4
           "603#2F60600008000000",  // mode := 8
           "604#C260600001000000",  // a block
           "000#8003",              // pre-operational
           "000#0200",              // stop, all nodes
           "080#",                  // SYNC
       })
    EXPECT_EQ(fault_of(frame), +joint_state_t::FAULT_FOREIGN_COMMAND) << frame;
  for (const char* frame : {
           "603#4060600000000000",  // reads
           "605#2F60600008000000",  // another node
           "000#0107",              // likewise
           "207#0F000000",          // likewise
           "100#000000000000",      // TIME
       })
    EXPECT_EQ(fault_of(frame), +joint_state_t::FAULT_NONE) << frame;
}

}  // namespace
}  // namespace limber::test_cia402_causes
