// An arm on ODrive axes, which make no stiffness of their own.
#include <gtest/gtest.h>

#include <string>

#include "drivers/protocols/odrive.h"
#include "tests/lab/family_arm.h"

namespace limber::test_odrive_arm {
namespace {

using testing::kActive;
using Arm = testing::FamilyArm;
using testing::yields;

TEST(OdriveArm, YieldsAsOnDrivesOfAnotherFamily) {
  const auto [x_m, y_m] = yields(load_robot("desktop2r"));
  const auto [odrive_x_m, odrive_y_m] = yields(load_robot("desktop2r_odrive"));
  EXPECT_NEAR(odrive_x_m, x_m, 3e-4);
  EXPECT_NEAR(odrive_y_m, y_m, 3e-4);
}

TEST(OdriveArm, AnotherFirmwareIsRefusedByName) {
  const LoadedRobot real = load_robot("desktop2r_odrive");
  LoadedRobot believed = load_robot("desktop2r_odrive");
  for (JointConfig& joint : believed.robot.joints) joint.drive.firmware = 0x00060A;
  const Scenario scenario;
  Lab lab(believed, scenario, LabOptions{&real, {}, {}});
  for (int cycle = 0; cycle < 10; ++cycle) lab.step();
  EXPECT_EQ(lab.state().fault, +joint_state_t::FAULT_CONFIGURATION);
  const std::string problem = lab.driver().configuration_problem();
  EXPECT_NE(problem.find("shoulder (node 1): firmware 0.6.11"), std::string::npos) << problem;
}

// Its errors come with each state; that it is enabled again tells its heartbeat.
TEST(OdriveArm, ADriveThatDisarmsIsNoticedAndComesBack) {
  Arm arm(load_robot("desktop2r_odrive"),
          kActive +
              "  - {at_s: 1.5, fault: {kind: drive_error, joint: shoulder, for_s: 0.5}}\n"
              "  - {at_s: 3.0, mode: acknowledge}\n"
              "  - {at_s: 3.5, mode: idle}\n"
              "  - {at_s: 5.5, mode: hold}\n"
              "  - {at_s: 9.0, mode: active}\n");
  arm.run_to(1.5 + 2 * 2e-3);
  EXPECT_EQ(arm.lab.state().drive_state, +joint_state_t::DRIVE_HOLD);
  EXPECT_EQ(arm.lab.state().fault, +joint_state_t::FAULT_DRIVE_ERROR);
  EXPECT_EQ(arm.lab.state().fault_joint, 0);
  arm.run_to(10.0);
  EXPECT_EQ(arm.lab.controller_status().mode, +controller_status_t::MODE_ACTIVE);
}

// Of each drive the seven settings that the start-up reads, one of both every 20 cycles, and the
// wrong one twice.
TEST(OdriveArm, AWatchdogThatIsSwitchedOffPastTheBusIsRead) {
  Arm arm(load_robot("desktop2r_odrive"), kActive);
  arm.run_to(2.0);
  ASSERT_EQ(arm.lab.state().drive_state, +joint_state_t::DRIVE_ON);
  arm.lab.simulator().tell_past_the_bus(
      1, odrive::encode(2, odrive::Message::kWriteEndpoint, std::uint8_t{1}, std::uint16_t{244},
                        std::uint8_t{0}, std::uint8_t{0}));
  arm.run_to(2.0 + 2e-3 * 20 * 2 * (7 + 2));
  EXPECT_EQ(arm.lab.state().fault, +joint_state_t::FAULT_DRIVE_ERROR);
  EXPECT_EQ(arm.lab.state().fault_joint, 1);
  const ArmDriver& driver = arm.lab.driver();
  const std::string text =
      driver.fault_text(joint_state_t::FAULT_DRIVE_ERROR, 1, driver.fault_detail());
  EXPECT_NE(text.find("enable_watchdog is 0, expected 1"), std::string::npos) << text;
}

}  // namespace
}  // namespace limber::test_odrive_arm
