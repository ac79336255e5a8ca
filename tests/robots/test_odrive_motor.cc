// An ODrive motor in robot.yaml: its firmware gives the numbers of its endpoints.
#include <gtest/gtest.h>

#include "robots/loader/load_robot.h"
#include "robots/loader/protocols/drive_protocol.h"
#include "tests/support/mutation.h"
#include "tests/support/source_path.h"

namespace limber::test_odrive_motor {
namespace {

const std::string kArm = source_path("robots/desktop2r_odrive/");

LoadedRobot load(const std::string& from = "", const std::string& to = "") {
  std::string yaml = testing::read_text(kArm + "robot.yaml");
  const auto at = yaml.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  yaml.replace(at, from.size(), to);
  const testing::TemporaryFolder folder;
  folder.write("robot.urdf", testing::read_text(kArm + "robot.urdf"));
  folder.write("robot.yaml", yaml);
  return load_robot(folder.path());
}

std::string refusal(const std::string& from, const std::string& to) {
  return testing::complaint_of([&] { load(from, to); });
}

TEST(OdriveMotor, ANodeHasTheNextThirtyTwoIdentifiers) {
  const LoadedRobot robot = load();
  const DriveConfig& drive = robot.robot.joints[1].drive;
  EXPECT_EQ(drive.command_id, 0x4EU);
  EXPECT_EQ(drive.frames.command, 4);
  EXPECT_EQ(drive.frames.asked, (std::vector<std::uint32_t>{0x49, 0x43, 0x5C}));
  EXPECT_EQ(drive.reply(2), 0x5CU);
  EXPECT_EQ(drive.counts_per_turn, 8.0 * 16384.0);
  EXPECT_EQ(drive.firmware, 0x00060BU);
  EXPECT_EQ(drive.endpoints[1], 243);
  EXPECT_EQ(drive.protocol->address(drive), "node 2");
  for (std::uint32_t id = 0; id < 0x800; ++id) {
    EXPECT_EQ(uses_id(drive, id), id / 32 == 2) << id;
    EXPECT_EQ(accepts_id(drive, id), id / 32 == 63) << id;
  }
  EXPECT_NE(refusal("id: 2", "id: 1").find("is taken by shoulder"), std::string::npos);
  EXPECT_NE(refusal("id: 2", "id: 63").find("62"), std::string::npos);
  EXPECT_NE(refusal("id: 2", "id: 0").find("1 to 62"), std::string::npos);
}

TEST(OdriveMotor, AnotherFirmwareNeedsItsEndpoints) {
  EXPECT_NE(refusal("0.6.11", "0.6.10")
                .find("'endpoints' is missing: the numbers of firmware "
                      "0.6.10 are in its flat_endpoints.json"),
            std::string::npos);
  const std::string own =
      "0.6.10\n    endpoints: {current_state: 1, watchdog_timeout: 2, enable_watchdog: 3, "
      "encoder_msg_rate_ms: 4, control_mode: 5, input_mode: 6, vel_limit: 7}\n    #";
  const LoadedRobot robot = load("0.6.11", own);
  const DriveConfig& drive = robot.robot.joints[0].drive;
  EXPECT_EQ(drive.firmware, 0x00060AU);
  EXPECT_EQ(drive.endpoints, (std::array<std::uint16_t, 7>{1, 2, 3, 4, 5, 6, 7}));
  for (const char* wrong : {"0.5.6", "0.6.999", "0.6.1x", "0.6"})
    EXPECT_NE(refusal("0.6.11", wrong).find("is none of 0.6"), std::string::npos) << wrong;
}

}  // namespace
}  // namespace limber::test_odrive_motor
