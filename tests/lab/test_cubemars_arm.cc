// An arm on CubeMars drives, of each board: two that reply under one identifier.
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <tuple>
#include <utility>

#include "tests/lab/family_arm.h"

namespace limber::test_cubemars_arm {
namespace {

using testing::kActive;
using Arm = testing::FamilyArm;
using testing::yields;

/// As the loader reads it with another board; an AK60-6 of the other range (V3).
LoadedRobot of_board(int board) {
  LoadedRobot robot = load_robot("desktop2r_ak");
  for (JointConfig& joint : robot.robot.joints) {
    DriveConfig& drive = joint.drive;
    drive.board = board;
    drive.frames.replies = {board == 1 ? 6 : 8};
    if (board == 1) drive.limit_temperature_degC = std::numeric_limits<double>::infinity();
    if (board != 3) continue;
    drive.range = {12.56, 60.0, 12.0, 500.0, 5.0};
    drive.reply_id = 0x2900 | drive.command_id;
    drive.command_id |= 0x800;
  }
  return robot;
}

// 5 and 3 N over 300 N/m. A count of the angle is 0.38 mrad, or of a V3 1.75: at 0.65 m 1.1 mm.
TEST(CubemarsArm, YieldsAsOnDrivesOfAnotherFamily) {
  const auto [x_m, y_m] = yields(load_robot("desktop2r"));
  EXPECT_NEAR(x_m, 5.0 / 300.0, 4e-4);
  for (const int board : {1, 2, 3}) {
    const auto [ak_x_m, ak_y_m] = yields(of_board(board));
    const double most_m = board == 3 ? 1.2e-3 : 3e-4;
    EXPECT_NEAR(ak_x_m, x_m, most_m) << board;
    EXPECT_NEAR(ak_y_m, y_m, most_m) << board;
  }
}

TEST(CubemarsArm, AnotherBoardThanInRobotYamlIsRefused) {
  const LoadedRobot v1 = of_board(1);
  const LoadedRobot v2 = of_board(2);
  for (const auto& [believed, real, words] :
       {std::tuple{&v2, &v1, "6 bytes, those of a board V2 8"},
        {&v1, &v2, "8 bytes, those of a board V1 6"}}) {
    Arm arm(*believed, kActive, real);
    for (int cycle = 0; cycle < 10; ++cycle) arm.lab.step();
    EXPECT_EQ(arm.lab.state().fault, +joint_state_t::FAULT_CONFIGURATION);
    const std::string problem = arm.lab.driver().configuration_problem();
    EXPECT_NE(problem.find(words), std::string::npos) << problem;
  }
}

// A V1 tells no error: it is known by the torque that it does not make. The other one holds.
TEST(CubemarsArm, ADriveThatSwitchesItselfOffIsNoticedAndStaysOff) {
  for (const auto& [board, most_cycles] : {std::pair{1, 40}, {2, 2}}) {
    Arm arm(of_board(board), kActive +
                                 "  - {at_s: 1.5, fault: {kind: drive_error, joint: shoulder, "
                                 "for_s: 0.5}}\n"
                                 "  - {at_s: 3.0, mode: acknowledge}\n"
                                 "  - {at_s: 3.5, mode: idle}\n"
                                 "  - {at_s: 5.5, mode: hold}\n"
                                 "  - {at_s: 9.0, mode: active}\n");
    arm.run_to(1.5 + 1e-3 * most_cycles);
    EXPECT_EQ(arm.lab.state().drive_state, +joint_state_t::DRIVE_HOLD) << board;
    EXPECT_EQ(arm.lab.state().fault, +joint_state_t::FAULT_DRIVE_ERROR);
    EXPECT_EQ(arm.lab.state().fault_joint, 0);
    while (arm.lab.time_ns() < 3'000'000'000) {
      arm.lab.step();
      ASSERT_EQ(arm.lab.state().joint_flags[0] & joint_state_t::JOINT_ENABLED, 0);
      ASSERT_EQ(arm.lab.truth().tau_motor[0], 0.0);
    }
    arm.run_to(10.0);
    EXPECT_EQ(arm.lab.controller_status().mode, +controller_status_t::MODE_ACTIVE);
  }
}

}  // namespace
}  // namespace limber::test_cubemars_arm
