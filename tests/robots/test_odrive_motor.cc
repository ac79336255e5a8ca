// An ODrive motor in robot.yaml: its firmware gives the numbers of its endpoints.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "robots/loader/load_robot.h"
#include "robots/loader/protocols/drive_protocol.h"
#include "tests/support/mutation.h"
#include "tests/support/source_path.h"

namespace limber::test_odrive_motor {
namespace {

const std::string kArm = source_path("robots/desktop2r_odrive/");

using Changes = std::vector<std::pair<std::string, std::string>>;

LoadedRobot load(const Changes& changes = {}) {
  std::string yaml = testing::read_text(kArm + "robot.yaml");
  for (const auto& [from, to] : changes) {
    const auto at = yaml.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    yaml.replace(at, from.size(), to);
  }
  const testing::TemporaryFolder folder;
  folder.write("robot.urdf", testing::read_text(kArm + "robot.urdf"));
  folder.write("robot.yaml", yaml);
  return load_robot(folder.path());
}

std::string refusal(const std::string& from, const std::string& to) {
  return testing::complaint_of([&] { load({{from, to}}); });
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

// The shoulder's motor of another family, which `keys` are.
LoadedRobot mixed(const std::string& keys, const std::string& ids, int node) {
  return load(
      {{"joints:\n  shoulder:\n    motor: d5065\n    bus: arm\n    id: 1\n",
        "  other:\n    gear_ratio: 10\n    rotor_inertia_kgm2: 1.8e-5\n    peak_torque_Nm: 7\n"
        "    rotor_torque_constant_Nm_per_A: 0.0945\n    phase_resistance_ohm: 0.85\n" +
            keys + "joints:\n  shoulder:\n    motor: other\n    bus: arm\n" + ids},
       {"id: 2\n", "id: " + std::to_string(node) + "\n"}});
}

// Identifiers from 7E0h on are orders to every axis, and 7FFh puts it into its boot loader.
TEST(OdriveMotor, ABusIsNotSharedWithFramesThatAreOrdersToEveryAxis) {
  const std::string keys =
      "    protocol: damiao_mit\n    encoder_bits: 14\n    mit_range: {position_rad: 12.5, "
      "velocity_rad_per_s: 30, torque_Nm: 10, kp_Nm_per_rad: 500, kd_Nms_per_rad: 5}\n";
  const std::string text =
      testing::complaint_of([&] { mixed(keys, "    id: 1\n    reply_id: 17\n", 2); });
  EXPECT_NE(text.find("frames 7FFh, by which settings of Damiao drives are read, are orders to "
                      "every ODrive drive on the same bus (shoulder): a bus for each"),
            std::string::npos)
      << text;
}

// SYNC is 80h, which is node 4's first identifier.
TEST(OdriveMotor, ANodeWhoseIdentifiersAnotherFamilySendsIsRefused) {
  const std::string keys = "    protocol: cia402\n    rated_torque_Nm: 2\n    encoder_bits: 14\n";
  const std::string text = testing::complaint_of([&] { mixed(keys, "    id: 1\n", 4); });
  EXPECT_NE(text.find("4: one of its identifiers is taken by shoulder on the same bus"),
            std::string::npos)
      << text;
  EXPECT_NO_THROW(mixed(keys, "    id: 1\n", 2));
}

TEST(OdriveMotor, AnotherFirmwareNeedsItsEndpoints) {
  EXPECT_NE(refusal("0.6.11", "0.6.10")
                .find("'endpoints' is missing: the numbers of firmware "
                      "0.6.10 are in its flat_endpoints.json"),
            std::string::npos);
  const std::string own =
      "0.6.10\n    endpoints: {current_state: 1, watchdog_timeout: 2, enable_watchdog: 3, "
      "encoder_msg_rate_ms: 4, control_mode: 5, input_mode: 6, vel_limit: 7}\n    #";
  const LoadedRobot robot = load({{"0.6.11", own}});
  const DriveConfig& drive = robot.robot.joints[0].drive;
  EXPECT_EQ(drive.firmware, 0x00060AU);
  EXPECT_EQ(drive.endpoints, (std::array<std::uint16_t, 7>{1, 2, 3, 4, 5, 6, 7}));
  for (const char* wrong : {"0.5.6", "0.6.999", "0.6.1x", "0.6"})
    EXPECT_NE(refusal("0.6.11", wrong).find("is none of 0.6"), std::string::npos) << wrong;
}

}  // namespace
}  // namespace limber::test_odrive_motor
