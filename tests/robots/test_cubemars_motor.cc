// A CubeMars motor in robot.yaml: board and model give what no drive tells.
#include <gtest/gtest.h>

#include <cmath>

#include "robots/loader/load_robot.h"
#include "robots/loader/protocols/drive_protocol.h"
#include "tests/support/mutation.h"
#include "tests/support/source_path.h"

namespace limber::test_cubemars_motor {
namespace {

const std::string kArm = source_path("robots/desktop2r_ak/");
const std::string kOwnRange =
    "mit_range: {position_rad: 12.5, velocity_rad_per_s: 22.5, torque_Nm: 18, kp_Nm_per_rad: 500, "
    "kd_Nms_per_rad: 5}";

std::string changed(std::initializer_list<std::pair<std::string, std::string>> changes) {
  std::string yaml = testing::read_text(kArm + "robot.yaml");
  for (const auto& [from, to] : changes) {
    const auto at = yaml.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    yaml.replace(at, from.size(), to);
  }
  return yaml;
}

LoadedRobot load(const std::string& yaml) {
  const testing::TemporaryFolder folder;
  folder.write("robot.urdf", testing::read_text(kArm + "robot.urdf"));
  folder.write("robot.yaml", yaml);
  return load_robot(folder.path());
}

std::string refusal(std::initializer_list<std::pair<std::string, std::string>> changes) {
  return testing::complaint_of([&] { load(changed(changes)); });
}

TEST(CubemarsMotor, TwoReplyUnderOneIdentifier) {
  const LoadedRobot robot = load(changed({}));
  for (const JointConfig& joint : robot.robot.joints) {
    EXPECT_EQ(joint.drive.reply_id, 0U);
    EXPECT_EQ(joint.drive.board, 2);
    EXPECT_EQ(joint.drive.range.torque_Nm, 15.0);
    EXPECT_EQ(joint.drive.range.velocity_rad_per_s, 50.0);
    EXPECT_EQ(joint.drive.frames.replies, std::vector<int>{8});
    EXPECT_EQ(joint.drive.limit_temperature_degC, 90.0);
  }
  EXPECT_EQ(robot.robot.joints[1].drive.command_id, 2U);
  EXPECT_NE(refusal({{"id: 2", "id: 1"}}).find("is taken by shoulder"), std::string::npos);
  EXPECT_NE(refusal({{"id: 2", "id: 2\n    reply_id: 1"}}).find("is taken by shoulder"),
            std::string::npos);
  EXPECT_NE(refusal({{"id: 2", "id: 2\n    reply_id: 2"}}).find("must differ from id"),
            std::string::npos);
  EXPECT_NO_THROW(load(changed({{"id: 2", "id: 2\n    reply_id: 0x20"}})));
}

TEST(CubemarsMotor, TheRangesOfABoardThatIsNotListedAreGiven) {
  EXPECT_NE(refusal({{"board: V2", "board: V1"}})
                .find("'mit_range' is missing: the ranges of "
                      "AK60-6 with board V1"),
            std::string::npos);
  EXPECT_NE(refusal({{"model: AK60-6", "model: other"}}).find("'mit_range' is missing"),
            std::string::npos);
  const LoadedRobot robot =
      load(changed({{"board: V2", "board: V1\n    " + kOwnRange}, {"AK60-6 #", "other #"}}));
  const DriveConfig& drive = robot.robot.joints[0].drive;
  EXPECT_EQ(drive.range.velocity_rad_per_s, 22.5);
  EXPECT_EQ(drive.frames.replies, std::vector<int>{6});
  EXPECT_TRUE(std::isinf(drive.limit_temperature_degC)) << "a V1 reports none";
  EXPECT_NE(refusal({{"board: V2", "board: V1\n    limit_temperature_degC: 85\n    " + kOwnRange}})
                .find("report no temperature"),
            std::string::npos);
}

TEST(CubemarsMotor, ABoardV3HasLongIdentifiersAndOtherRanges) {
  const LoadedRobot robot = load(changed({{"board: V2", "board: V3"}, {"id: 2", "id: 0x68"}}));
  const DriveConfig& drive = robot.robot.joints[1].drive;
  EXPECT_EQ(drive.command_id, 0x868U);
  EXPECT_EQ(drive.reply_id, 0x2968U);
  EXPECT_EQ(drive.range.torque_Nm, 12.0);
  EXPECT_EQ(drive.protocol->address(drive), "motor 104");
  EXPECT_NE(refusal({{"board: V2", "board: V3"}, {"id: 2", "id: 2\n    reply_id: 3"}})
                .find("is not of boards V3"),
            std::string::npos);
}

TEST(CubemarsMotor, WhatACommandCannotCarryIsRefused) {
  EXPECT_NE(refusal({{"peak_torque_Nm: 9", "peak_torque_Nm: 16"}})
                .find("16 is more than the 15 that a command can carry (model AK60-6, board V2)"),
            std::string::npos);
}

}  // namespace
}  // namespace limber::test_cubemars_motor
