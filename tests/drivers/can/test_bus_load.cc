// Frame lengths against the standard's worst cases and against frames whose length other people's
// tools report.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>

#include "drivers/can/bus_load.h"

namespace limber {
namespace {

constexpr double kClassic = 1e6;
constexpr double kFast = 5e6;

CanFrame parse(const std::string& candump) {
  CanFrame frame;
  const auto hash = candump.find('#');
  frame.id = static_cast<std::uint32_t>(std::stoul(candump.substr(0, hash), nullptr, 16));
  frame.extended = hash > 3;
  for (std::size_t i = hash + 1; i + 1 < candump.size(); i += 2) {
    frame.data[frame.length++] =
        static_cast<std::uint8_t>(std::stoul(candump.substr(i, 2), nullptr, 16));
  }
  return frame;
}

double classic_bits(int bytes, bool extended) {
  return worst_frame_time_s(bytes, extended, false, kClassic, kFast) * kClassic;
}
double fd_microseconds(int bytes, bool extended) {
  return worst_frame_time_s(bytes, extended, true, kClassic, kFast) * 1e6;
}

TEST(WorstFrameTime, Classic) {
  constexpr std::array kBits = {55, 65, 75, 85, 95, 105, 115, 125, 135};
  for (int n = 0; n <= 8; ++n)
    EXPECT_NEAR(classic_bits(n, false), kBits[static_cast<std::size_t>(n)], 1e-9);
  EXPECT_NEAR(classic_bits(8, true), 160, 1e-9);
  EXPECT_NEAR(worst_frame_time_s(8, false, false, 500e3, kFast), 270e-6, 1e-12);
}

TEST(WorstFrameTime, Fd) {
  constexpr std::array kBytes = {8, 12, 16, 20, 24, 32, 48, 64};
  constexpr std::array kStandard_us = {57, 65, 73, 82, 90, 106, 138, 170};
  constexpr std::array kExtended_us = {80, 88, 96, 105, 113, 129, 161, 193};
  for (std::size_t i = 0; i < kBytes.size(); ++i) {
    EXPECT_EQ(std::lround(fd_microseconds(kBytes[i], false)), kStandard_us[i]) << kBytes[i];
    EXPECT_EQ(std::lround(fd_microseconds(kBytes[i], true)), kExtended_us[i]) << kBytes[i];
  }
  EXPECT_EQ(fd_microseconds(9, false), fd_microseconds(12, false)) << "FD frames come in steps";
}

// Lengths as reported by canbusload -e.
TEST(FrameTime, OfRealClassicFrames) {
  EXPECT_EQ(classic_frame_bits(parse("001#7FFF7FF0000007FF")), 126);
  EXPECT_EQ(classic_frame_bits(parse("011#1180007FF7FF231F")), 121);
  EXPECT_NEAR(classic_frame_bits(parse("04E#0000A03F")), 86, 1);
  EXPECT_NEAR(frame_time_s(parse("001#7FFF7FF0000007FF"), 500e3, kFast), 252e-6, 1e-12);
}

TEST(FrameTime, ARemoteFrameCarriesNoData) {
  CanFrame frame = parse("123#0102030405060708");
  frame.remote = true;
  EXPECT_GE(classic_frame_bits(frame), 47);
  EXPECT_LE(classic_frame_bits(frame), 55);
}

TEST(FrameTime, AnErrorMessageIsNoFrameOnTheBus) {
  CanFrame frame = parse("040#0000000000000000");
  frame.error = true;
  EXPECT_EQ(frame_time_s(frame, kClassic, kFast), 0.0);
}

TEST(FrameTime, LiesBetweenNoStuffingAndTheWorstCase) {
  std::mt19937 random(1);
  double sum = 0.0;
  constexpr int kFrames = 20'000;
  for (int i = 0; i < kFrames; ++i) {
    CanFrame frame;
    frame.extended = (i & 1) != 0;
    frame.id = random() & (frame.extended ? kExtendedIdMax : kStandardIdMax);
    frame.length = 8;
    for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random());
    const int bits = classic_frame_bits(frame);
    ASSERT_GE(bits, frame.extended ? 131 : 111);
    ASSERT_LE(bits, frame.extended ? 160 : 135);
    if (!frame.extended) sum += bits;
    frame.fd = frame.bitrate_switch = true;
    ASSERT_LE(frame_time_s(frame, kClassic, kFast),
              worst_frame_time_s(8, frame.extended, true, kClassic, kFast) + 1e-12);
    ASSERT_GE(frame_time_s(frame, kClassic, kFast),
              (frame.extended ? 49e-6 + 19e-6 : 49e-6) - 0.5e-6);
  }
  EXPECT_NEAR(sum / (kFrames / 2), 115, 1) << "average of random 8-byte frames";
}

// Runs of equal bits are the worst case where stuffing is known by hand: alternating data needs
// none.
TEST(FrameTime, FdStuffingByHand) {
  CanFrame frame = parse("555#AAAAAAAAAAAAAAAA");
  frame.fd = frame.bitrate_switch = true;
  // 0 10101010101 0 0 1 0 1 | 0 1000 1010... : no five equal bits, so 17 + 13 slow and 5 + 64 + 4 +
  // 23 fast ones.
  EXPECT_NEAR(frame_time_s(frame, kClassic, kFast), 30e-6 + 96.0 / 5e6, 1e-12);
  frame.data.fill(0);
  // Fast bits: 0 1000 and 64 zeros, so 67 zeros in a row. Every five of them are followed by a
  // stuff bit, which is a one and starts the count anew: 13.
  EXPECT_NEAR(frame_time_s(frame, kClassic, kFast), 30e-6 + (96.0 + 13) / 5e6, 1e-12);
  for (std::size_t i = 0; i < 8; ++i) frame.data[i] = i == 0 ? 0xF8 : 0x78;
  // Five ones, a stuff bit 0; it and the four zeros that follow are five, a stuff bit 1; and so on,
  // fourteen times more.
  EXPECT_NEAR(frame_time_s(frame, kClassic, kFast), 30e-6 + (96.0 + 15) / 5e6, 1e-12);
  frame.data.fill(0);
  frame.bitrate_switch =
      false;  // the switch bit becomes 0 and joins the error state bit: no run of five
  EXPECT_NEAR(frame_time_s(frame, kClassic, kFast), (30 + 96.0 + 13) / 1e6, 1e-12);
}

Robot seven_joints(bool fd) {
  Robot robot;
  robot.buses.push_back({"arm", "virtual:default", fd, 1'000'000, 5'000'000});
  robot.joints.resize(7);
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    robot.joints[i].drive.command_id = static_cast<std::uint32_t>(i + 1);
    robot.joints[i].drive.reply_id = static_cast<std::uint32_t>(i + 0x11);
  }
  return robot;
}

TEST(BusLoad, SevenJointsOnOneFdBusFitOneKilohertz) {
  const Robot robot = seven_joints(true);
  EXPECT_NEAR(predicted_bus_load(robot, 0), 0.792, 0.0005);
  EXPECT_NEAR(highest_safe_rate_hz(robot, 0), 1010, 0.5);
  EXPECT_NEAR(highest_safe_rate_hz(robot, 0, 1.0), 1262, 0.5);
}

TEST(BusLoad, SevenJointsOnOneClassicBusDoNot) {
  const Robot robot = seven_joints(false);
  EXPECT_NEAR(predicted_bus_load(robot, 0), 1.89, 1e-9);
  EXPECT_NEAR(highest_safe_rate_hz(robot, 0), 423, 0.5);
}

// 29-bit command of 48 bytes, 57 us + 519 / 5 us; 11-bit reply of 32, 34 us + 358 / 5 us.
TEST(BusLoad, ThreeMoteusDrivesFillABusAtOneKilohertz) {
  Robot robot = seven_joints(true);
  robot.joints.resize(3);
  for (JointConfig& joint : robot.joints) {
    joint.drive.command_id |= 0x8000U;
    joint.drive.command_bytes = 48;
    joint.drive.reply_bytes = 32;
  }
  EXPECT_NEAR(predicted_bus_load(robot, 0), 3 * (160.8e-6 + 105.6e-6) * 1000, 1e-9);
}

// FD, 11-bit identifier: 34 us and, of 4 bytes, 5 + 32 + 9 + 4 + 23 = 73 bits at 5 Mbit/s; of 24,
// 5 + 192 + 49 + 4 + 28 = 278. A SYNC is a classic frame without data, 55 bits at 1 Mbit/s.
TEST(BusLoad, CanopenDrivesShareOneSync) {
  Robot robot = seven_joints(true);
  robot.joints.resize(2);
  for (JointConfig& joint : robot.joints) {
    joint.drive.protocol = DriveProtocol::kCia402;
    joint.drive.command_id = 0x203;
    joint.drive.reply_id = 0x183;
    joint.drive.command_bytes = 4;
    joint.drive.reply_bytes = 24;
  }
  const double drive_s = 34e-6 + 73 / 5e6 + 34e-6 + 278 / 5e6;
  EXPECT_NEAR(predicted_bus_load(robot, 0), (2 * drive_s + 55e-6) * 1000, 1e-9);
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
  EXPECT_NEAR(predicted_bus_load(robot, 0), 3 * 270e-6 * 1000, 1e-9);
  EXPECT_NEAR(predicted_bus_load(robot, 1), 1 * 270e-6 * 1000, 1e-9);
}

TEST(BusLoad, CountsOnlyTheBusItself) {
  Robot robot = seven_joints(false);
  robot.buses.push_back(robot.buses[0]);
  for (std::size_t i = 0; i < 3; ++i) robot.joints[i].drive.bus = 1;
  EXPECT_NEAR(predicted_bus_load(robot, 0), 4 * 270e-6 * 1000, 1e-9);
  EXPECT_NEAR(predicted_bus_load(robot, 1), 3 * 270e-6 * 1000, 1e-9);
  robot.buses.push_back(robot.buses[0]);
  EXPECT_EQ(predicted_bus_load(robot, 2), 0.0);
  EXPECT_TRUE(std::isinf(highest_safe_rate_hz(robot, 2)));
}

}  // namespace
}  // namespace limber
