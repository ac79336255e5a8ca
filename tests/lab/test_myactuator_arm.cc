// An arm on MyActuator drives, with Damiao drives in its wrist on the same bus, and either
// firmware.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "robots/loader/protocols/drive_protocol.h"
#include "tests/lab/family_arm.h"

namespace limber::test_myactuator_arm {
namespace {

using testing::kActive;
using Status = controller_status_t;

/// By the scenarios' own integrator.
struct Arm : testing::FamilyArm {
  Arm(const LoadedRobot& given, const std::string& timeline, const LoadedRobot* real = nullptr)
      : FamilyArm(given, timeline, real, "ode") {}
};

bool is_myactuator(const JointConfig& joint) { return joint.drive.protocol->word == "myactuator"; }

LoadedRobot axol() { return load_robot("axol"); }

LoadedRobot axol_of_v42() {
  LoadedRobot robot = axol();
  for (JointConfig& joint : robot.robot.joints) {
    if (!is_myactuator(joint)) continue;
    joint.drive.range = {12.5, 45.0, 24.0, 500.0, 5.0};
    joint.drive.peak_torque_Nm = std::min(joint.drive.peak_torque_Nm, 24.0);
    joint.torque_limit_Nm = std::min(joint.torque_limit_Nm, 24.0);
  }
  return robot;
}

TEST(MyactuatorArm, HoldsAndSoftensWithEitherFirmware) {
  for (const LoadedRobot& robot : {axol(), axol_of_v42()}) {
    for (const double stiffness_N_per_m : {600.0, 300.0}) {
      Arm arm(robot, kActive +
                         "  - {at_s: 1.0, gains: {law: cartesian_impedance, "
                         "K_x_translation_N_per_m: " +
                         std::to_string(stiffness_N_per_m) +
                         ", ramp_s: 0.2}}\n"
                         "  - {at_s: 2.0, push: {force_N: [15, 0, 0], ramp_s: 0.2, for_s: 3}}\n");
      arm.run_to(1.9);
      const double before_m = arm.lab.truth().p_BT[0];
      arm.run_to(4.5);
      const double moved_m = arm.lab.truth().p_BT[0] - before_m;
      EXPECT_NEAR(moved_m, 15.0 / stiffness_N_per_m, 0.03 * 15.0 / stiffness_N_per_m)
          << robot.robot.joints[0].drive.range.torque_Nm;
      EXPECT_EQ(arm.mode(), +Status::MODE_ACTIVE);
    }
  }
}

TEST(MyactuatorArm, RangesOfAnotherFirmwareThanTheDrivesAreRefused) {
  const LoadedRobot before = axol_of_v42();
  const LoadedRobot later = axol();
  for (const auto& [believed, real, words] :
       {std::tuple{&later, &before, "is of 2025070202, robot.yaml has firmware: V4.4"},
        {&before, &later, "is of 2026042402, robot.yaml has firmware: V4.2"}}) {
    Arm arm(*believed, kActive, real);
    for (int cycle = 0; cycle < 10; ++cycle) arm.lab.step();
    EXPECT_EQ(arm.lab.state().fault, +joint_state_t::FAULT_CONFIGURATION);
    const std::string problem = arm.lab.driver().configuration_problem();
    EXPECT_NE(problem.find("shoulder_1"), std::string::npos) << problem;
    EXPECT_NE(problem.find(words), std::string::npos) << problem;
  }
}

// The drive hears nothing for 0.1 s, five time-outs: it lets go, and would go on at the second
// command. The others hold the arm; after an acknowledgement it works again.
TEST(MyactuatorArm, ADriveThatTimedOutStaysOffUntilItIsAcknowledged) {
  for (const LoadedRobot& robot : {axol(), axol_of_v42()}) {
    Arm arm(robot, kActive +
                       "  - {at_s: 1.5, fault: {kind: drop_commands, joint: shoulder_2, "
                       "for_s: 0.1}}\n"
                       "  - {at_s: 3.0, mode: acknowledge}\n"
                       "  - {at_s: 3.5, mode: idle}\n"
                       "  - {at_s: 5.5, mode: hold}\n"
                       "  - {at_s: 9.0, mode: active}\n");
    arm.run_to(1.53);
    EXPECT_EQ(arm.lab.state().drive_state, +joint_state_t::DRIVE_HOLD);
    EXPECT_EQ(arm.lab.state().fault, +joint_state_t::FAULT_DRIVE_ERROR);
    EXPECT_EQ(arm.lab.state().fault_joint, 1);
    while (arm.lab.time_ns() < 3'000'000'000) {
      arm.lab.step();
      ASSERT_EQ(arm.lab.state().joint_flags[1] & joint_state_t::JOINT_ENABLED, 0);
      ASSERT_NE(arm.lab.state().joint_flags[0] & joint_state_t::JOINT_ENABLED, 0) << "it holds";
      ASSERT_LE(arm.lab.truth().tau_motor[1] * arm.lab.truth().v[1], 1e-9) << "it brakes at most";
    }
    arm.run_to(10.0);
    EXPECT_EQ(arm.mode(), +Status::MODE_ACTIVE);
  }
}

TEST(MyactuatorArm, OneBusCarriesTwoFamilies) {
  Arm arm(axol(), kActive);
  const auto& joints = arm.robot.robot.joints;
  EXPECT_EQ(std::ranges::count_if(joints, is_myactuator), 5);
  EXPECT_EQ(joints[0].drive.bus, joints[6].drive.bus);
  arm.run_to(3.0);
  const driver_status_t& status = arm.lab.driver_status();
  for (int j = 0; j < 7; ++j) {
    EXPECT_EQ(status.replies_lost[j], 0) << j;
    EXPECT_EQ(status.replies_invalid[j], 0) << j;
  }
  EXPECT_EQ(status.frames_foreign[0], 0);
}

}  // namespace
}  // namespace limber::test_myactuator_arm
