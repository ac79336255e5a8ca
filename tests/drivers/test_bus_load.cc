// Predicted bus loads against sums of hand-computed frame times.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "common/config_error.h"
#include "drivers/bus_load.h"
#include "drivers/protocols/cia402_pdos.h"
#include "drivers/protocols/limber_ft.h"
#include "drivers/protocols/mit.h"
#include "drivers/protocols/moteus.h"
#include "drivers/protocols/robotous_rft.h"
#include "robots/loader/load_robot.h"
#include "robots/loader/protocols/drive_protocol.h"
#include "tests/support/source_path.h"

namespace limber::test_bus_load {
namespace {

/// Classic, 8 bytes, 11-bit identifiers: 135 bits each at 1 Mbit/s.
constexpr double kSettings_s = 2 * 135e-6 / 20;

Robot seven_joints(bool fd) {
  Robot robot;
  robot.buses.push_back({"arm", "virtual:default", fd, 1'000'000, 5'000'000});
  robot.joints.resize(7);
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    robot.joints[i].drive.protocol = &protocol_named("damiao_mit");
    robot.joints[i].drive.command_id = static_cast<std::uint32_t>(i + 1);
    robot.joints[i].drive.reply_id = static_cast<std::uint32_t>(i + 0x11);
  }
  return robot;
}

// Of settings one request and one answer are on the wire every 20 cycles: 113.2 us in FD frames.
TEST(BusLoad, SevenJointsOnOneFdBusFitOneKilohertz) {
  const Robot robot = seven_joints(true);
  EXPECT_NEAR(predicted_bus_load(robot, 0), 0.7924 + 0.1132 / 20, 1e-9);
  // 60 us in a native adapter, at the most; the driver waits for nine tenths of the period.
  EXPECT_NEAR(predicted_end_s(robot, 0), 60e-6 + 792.4e-6, 1e-9);
  EXPECT_NEAR(highest_rate_hz(robot, 0), 0.9 / 852.4e-6, 0.5);
  EXPECT_LT(expected_bus_load(robot, 0), predicted_bus_load(robot, 0));
}

TEST(BusLoad, SevenJointsOnOneClassicBusDoNot) {
  const Robot robot = seven_joints(false);
  EXPECT_NEAR(predicted_bus_load(robot, 0), 1.89 + kSettings_s * 1000, 1e-9);
  EXPECT_NEAR(highest_rate_hz(robot, 0), 0.9 / (60e-6 + 1890e-6), 0.5);
  EXPECT_THROW(checked_bus_load(robot, 0), ConfigError);
}

// 29-bit command of 48 bytes, 57 us + 519 / 5 us; 11-bit reply of 32, 34 us + 358 / 5 us. Their
// settings are not read again.
TEST(BusLoad, ThreeMoteusDrivesFillABusAtOneKilohertz) {
  Robot robot = seven_joints(true);
  robot.joints.resize(3);
  for (JointConfig& joint : robot.joints) {
    joint.drive.protocol = &protocol_named("moteus");
    joint.drive.command_id |= 0x8000U;
    joint.drive.frames = {48, {32}};
  }
  EXPECT_NEAR(predicted_bus_load(robot, 0), 3 * (160.8e-6 + 105.6e-6) * 1000, 1e-9);
}

// FD, 11-bit identifier: 34 us and, of 4 bytes, 5 + 32 + 9 + 4 + 23 = 73 bits at 5 Mbit/s; of 24,
// 5 + 192 + 49 + 4 + 28 = 278. A SYNC is a classic frame without data, 55 bits at 1 Mbit/s.
TEST(BusLoad, CanopenDrivesShareOneSync) {
  Robot robot = seven_joints(true);
  robot.joints.resize(2);
  for (JointConfig& joint : robot.joints) {
    joint.drive.protocol = &protocol_named("cia402");
    joint.drive.command_id = 0x203;
    joint.drive.reply_id = 0x183;
    joint.drive.frames = {4, {24}};
  }
  const double drive_s = 34e-6 + 73 / 5e6 + 34e-6 + 278 / 5e6;
  EXPECT_NEAR(predicted_bus_load(robot, 0), (2 * drive_s + 55e-6 + kSettings_s) * 1000, 1e-9);
  // Nobody answers before the SYNC, and everybody 50 us after it; 60 us are the adapter's.
  EXPECT_NEAR(predicted_end_s(robot, 0), 60e-6 + 2 * drive_s + 55e-6 + 50e-6, 1e-9);
}

// Classic, 11-bit identifier, n bytes: 47 + 8 n + floor((33 + 8 n) / 4) bits at 1 Mbit/s. Command
// of 4: 95; status and position, 6: 115; velocity and torque, 6: 115, with a current, 8: 135; the
// link's side, 8: 135. SYNC: 55. The second joint has a torque sensor and a link encoder.
TEST(BusLoad, CanopenDrivesOnAClassicBusAnswerInSeveralFrames) {
  Robot robot = seven_joints(false);
  robot.joints.resize(2);
  robot.joints[1].link_encoder.present = true;
  robot.joints[1].torque_sensor.present = true;
  for (JointConfig& joint : robot.joints) {
    joint.drive.protocol = &protocol_named("cia402");
    joint.drive.command_id = 0x203;
    joint.drive.reply_id = 0x183;
    joint.drive.frames = protocol_named("cia402").frames(joint, false);
  }
  const double first_s = 95e-6 + 115e-6 + 115e-6;
  const double second_s = 95e-6 + 115e-6 + 135e-6 + 135e-6;
  EXPECT_NEAR(predicted_bus_load(robot, 0), (first_s + second_s + 55e-6 + kSettings_s) * 1000,
              1e-9);
}

// Classic, 11 bits: a command of 4 bytes 95 bits, three requests without data 55 each, three
// replies of 8 bytes 135 each.
TEST(BusLoad, EachPartOfAStateMayHaveARequestOfItsOwn) {
  Robot robot = seven_joints(false);
  robot.joints.resize(1);
  robot.joints[0].drive.protocol = &protocol_named("odrive");
  robot.joints[0].drive.command_id = 0x2E;
  robot.joints[0].drive.frames = protocol_named("odrive").frames(robot.joints[0], false);
  EXPECT_NEAR(predicted_bus_load(robot, 0), 0.665 + kSettings_s * 1000, 1e-9);
  EXPECT_NEAR(predicted_end_s(robot, 0), 60e-6 + 665e-6, 1e-9);
  EXPECT_NEAR(least_round_trip_s(robot, 0), 40e-6 + 0.8 * (55e-6 + 135e-6), 1e-9);
}

// A single motor's reply finds the wire free after the drive's delay of 50 us.
TEST(BusLoad, AReplyComesAfterTheDrivesDelay) {
  Robot robot = seven_joints(false);
  robot.joints.resize(1);
  EXPECT_NEAR(predicted_end_s(robot, 0), 60e-6 + 2 * 135e-6 + 50e-6, 1e-9);
  robot.buses[0].adapter = CanAdapter::kUsb;
  EXPECT_NEAR(predicted_end_s(robot, 0), 325e-6 + 2 * 135e-6 + 50e-6, 1e-9);
  EXPECT_LT(least_round_trip_s(robot, 0), 175e-6 + 2 * 111e-6 + 50e-6) << "without any stuff bit";
}

// Its line is slower than the bus: 30 and 16 bytes of ten bits at 921,600 baud.
TEST(BusLoad, ASerialAdaptersRecordsFollowOneAnother) {
  Robot robot = seven_joints(false);
  robot.buses[0].adapter = CanAdapter::kDamiaoSerial;
  const double byte_s = 10.0 / 921'600;
  EXPECT_NEAR(predicted_end_s(robot, 0), 2500e-6 + 7 * 30 * byte_s + 7 * 16 * byte_s, 1e-9);
}

// The longest classic frame, 29-bit identifier and eight bytes, has 67 + 64 + 29 = 160 bits.
TEST(BusLoad, TheWindowLeavesRoomForAFrameOfAnotherDevice) {
  Robot robot = seven_joints(false);
  robot.joints.resize(2);
  EXPECT_NEAR(reply_window_s(robot), predicted_end_s(robot, 0) + 160e-6, 1e-9);
  robot.rate_hz = 200.0;  // a twentieth of the period is longer, and 0.6 of it the least
  EXPECT_NEAR(reply_window_s(robot), 0.6 / 200.0, 1e-9);
  EXPECT_NEAR(reply_window_s(seven_joints(true)), kLatestReply / 1000.0, 1e-9);
}

// For wires that the prediction does not know.
TEST(BusLoad, AWindowThatIsGivenIsTheWindowAndLeavesTheControllerItsShare) {
  Robot robot = seven_joints(false);
  robot.joints.resize(2);
  robot.buses[0].reply_window_s = 0.3e-3;
  EXPECT_EQ(reply_window_s(robot), 0.3e-3);
  robot.buses[0].reply_window_s = 0.85e-3;
  EXPECT_EQ(reply_window_s(robot), 0.85e-3);
  EXPECT_NO_THROW(checked_bus_load(robot, 0));
  robot.buses[0].reply_window_s = 0.91e-3;
  try {
    checked_bus_load(robot, 0);
    ADD_FAILURE() << "0.91 of the period";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("reply_window_s: is 0.00091"), std::string::npos)
        << error.what();
  }
}

TEST(BusLoad, BothMotorsOfAPairCountWhereTheyAre) {
  Robot robot = seven_joints(false);
  robot.joints.resize(2);
  robot.buses.push_back(robot.buses[0]);
  for (std::size_t i = 0; i < 2; ++i) {
    robot.joints[i].has_antagonist = true;
    robot.joints[i].antagonist = robot.joints[i].drive;
    robot.joints[i].antagonist.bus = static_cast<int>(i);
  }
  EXPECT_NEAR(predicted_bus_load(robot, 0), (3 * 270e-6 + kSettings_s) * 1000, 1e-9);
  EXPECT_NEAR(predicted_bus_load(robot, 1), (1 * 270e-6 + kSettings_s) * 1000, 1e-9);
}

TEST(BusLoad, CountsOnlyTheBusItself) {
  Robot robot = seven_joints(false);
  robot.buses.push_back(robot.buses[0]);
  for (std::size_t i = 0; i < 3; ++i) robot.joints[i].drive.bus = 1;
  EXPECT_NEAR(predicted_bus_load(robot, 0), (4 * 270e-6 + kSettings_s) * 1000, 1e-9);
  EXPECT_NEAR(predicted_bus_load(robot, 1), (3 * 270e-6 + kSettings_s) * 1000, 1e-9);
  robot.buses.push_back(robot.buses[0]);
  EXPECT_EQ(predicted_bus_load(robot, 2), 0.0);
  EXPECT_TRUE(std::isinf(highest_rate_hz(robot, 2)));
}

Robot with_tip_sensor(TipSensorProtocol protocol, bool fd) {
  Robot robot = seven_joints(true);
  robot.buses.push_back({"tip", "virtual:tip", fd, 1'000'000, 5'000'000});
  robot.has_tip_sensor = true;
  robot.tip_sensor.protocol = protocol;
  robot.tip_sensor.bus = 1;
  return robot;
}

// Classic: three frames of 8 bytes, 47 + 64 + floor(97 / 4) = 135 bits each at 1 Mbit/s.
TEST(BusLoad, RobotousSensorOnAClassicBus) {
  const Robot robot = with_tip_sensor(TipSensorProtocol::kRobotousRft, false);
  EXPECT_NEAR(predicted_bus_load(robot, 1), 3 * 135e-6 * 1000.0, 1e-12);
}

// FD: 17 + 4 + 13 bits at 1 Mbit/s each; at 5 Mbit/s 2 bytes: 5 + 16 + 5 + 4 + 23 bits, with 5 =
// floor(37 / 4) - 4 stuff bits; 32 bytes: 5 + 256 + 65 + 4 + 28, with 65 = floor(277 / 4) - 4.
TEST(BusLoad, LimberSensorOnAnFdBus) {
  const Robot robot = with_tip_sensor(TipSensorProtocol::kLimberFt, true);
  EXPECT_NEAR(predicted_bus_load(robot, 1), 1000.0 * (2 * 34e-6 + (53 + 358) / 5e6), 1e-12);
}

// The traits give the lengths as numbers; the frames are the protocols'.
TEST(BusLoad, BytesOfTheTraitsAreThoseOfTheFrames) {
  for (unsigned bits = 0; bits < 8; ++bits) {
    const cia402::StateLayout layout = {(bits & 1U) != 0, (bits & 2U) != 0, (bits & 4U) != 0};
    JointConfig joint;
    joint.link_encoder.present = layout.link_encoder;
    joint.torque_sensor.present = layout.torque_sensor;
    const FrameSizes sizes = protocol_named("cia402").frames(joint, layout.fd);
    EXPECT_EQ(sizes.command, cia402::encode_command({}, 0x201, layout.fd).length);
    std::vector<int> replies;
    for (int k = 0; k < cia402::tpdos_of(layout); ++k) {
      const auto objects = cia402::state_objects(layout, k);
      replies.push_back(cia402::encode_state({}, objects, 0x181, layout.fd).length);
    }
    EXPECT_EQ(sizes.replies, replies) << bits;
    if (!layout.fd) {
      EXPECT_EQ(canopen::tpdo_id(1, 5), canopen::tpdo_id(0, 5) + sizes.reply_step);
    }
  }
  EXPECT_EQ(protocol_named("damiao_mit").frames({}, true).command,
            mit::encode_state_request(1, true).length);
  EXPECT_EQ(protocol_named("moteus").frames({}, true).command,
            moteus::encode_command({}, 0x8001).length);
  EXPECT_EQ(traits_of(TipSensorProtocol::kLimberFt).request_bytes,
            limber_ft::encode_request(1, 0).length);
  EXPECT_EQ(traits_of(TipSensorProtocol::kRobotousRft).request_bytes,
            robotous_rft::encode_request(1).length);
}

// With every frame at its longest, and the usual load is less.
TEST(BusLoad, EveryBusOfEveryShippedRobotIsUsedToFourFifthsAtMost) {
  int buses = 0;
  for (const auto& folder : std::filesystem::directory_iterator(source_path("robots"))) {
    if (!exists(folder.path() / "robot.yaml")) continue;
    const Robot robot = load_robot(folder.path()).robot;
    for (int bus = 0; bus < static_cast<int>(robot.buses.size()); ++bus, ++buses)
      EXPECT_LT(predicted_bus_load(robot, bus), 0.80) << robot.name << " " << bus;
  }
  EXPECT_GE(buses, 18);
}

}  // namespace
}  // namespace limber::test_bus_load
