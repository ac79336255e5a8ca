// An arm on CubeMars drives, of each board: two that reply under one identifier.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "controller/laws/registry.h"
#include "lab/lab.h"
#include "tests/support/mutation.h"

namespace limber::test_cubemars_arm {
namespace {

const std::string kActive =
    "  - {at_s: 0.3, mode: hold}\n"
    "  - {at_s: 0.8, mode: active}\n";

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

struct Arm {
  Arm(const LoadedRobot& given, const std::string& timeline, const LoadedRobot* real = nullptr)
      : robot(given),
        path(folder.write("scenario.yaml",
                          "format: limber-scenario/1\nrobot: " + given.robot.name +
                              "\nmode: lockstep\nduration_s: 20\nseed: 7\n"
                              "integrator: reference\nfriction: false\ntimeline:\n" +
                              timeline)),
        scenario(load_scenario(path, robot, &controller::law_catalog())),
        lab(robot, scenario, LabOptions{real, {}, {}}) {}

  void run_to(double time_s) {
    while (lab.time_ns() < static_cast<std::int64_t>(std::llround(time_s * 1e9))) lab.step();
  }

  testing::TemporaryFolder folder;
  LoadedRobot robot;
  std::string path;
  Scenario scenario;
  Lab lab;
};

/// Of the tip, m.
std::pair<double, double> yields(const LoadedRobot& robot) {
  Arm arm(robot, kActive +
                     "  - {at_s: 1.0, gains: {law: cartesian_impedance, K_x_translation_N_per_m: "
                     "300, K_x_rotation_Nm_per_rad: 0, damping_ratio: 0.7, ramp_s: 0.2}}\n"
                     "  - {at_s: 2.0, push: {force_N: [5, 3, 0], ramp_s: 0.2, for_s: 3}}\n");
  arm.run_to(1.9);
  const sim_truth_t before = arm.lab.truth();
  arm.run_to(4.5);
  EXPECT_EQ(arm.lab.controller_status().mode, +controller_status_t::MODE_ACTIVE);
  const driver_status_t& status = arm.lab.driver_status();
  for (int j = 0; j < 2; ++j) {
    EXPECT_EQ(status.replies_lost[j], 0);
    EXPECT_EQ(status.replies_invalid[j], 0);
  }
  EXPECT_EQ(status.frames_foreign[0], 0);
  const sim_truth_t& now = arm.lab.truth();
  return {now.p_BT[0] - before.p_BT[0], now.p_BT[1] - before.p_BT[1]};
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
