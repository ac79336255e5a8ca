// The emulated drive, byte by byte where bytes matter. Frames of the MIT family as in the maker's
// manual.
#include <gtest/gtest.h>

#include <cmath>
#include <limber/scenario_event_t.hpp>
#include <string>

#include "sim/nodes/damiao_node.h"
#include "tests/sim/test_arms.h"

namespace limber::sim::test_damiao_node {
namespace {

using mit::DriveError;
using mit::Special;

constexpr std::int64_t kMs = 1'000'000;

/// Joint 3 of an arm: id 3, replies on 0x13, ranges of a DM4310.
JointConfig joint3() {
  JointConfig joint = testing::joint_config(2, JointType::kRevolute, 1.8e-3);
  joint.drive.counts_per_turn = 16384;
  joint.drive.short_circuit_damping_Nms = 0.4;
  joint.drive.peak_torque_Nm = 7.0;
  joint.drive.gear_ratio = 10.0;
  return joint;
}

CanFrame frame(std::uint32_t id, const std::string& hex, bool fd = false) {
  CanFrame out;
  out.id = id;
  out.fd = fd;
  out.bitrate_switch = fd;
  out.length = static_cast<std::uint8_t>(hex.size() / 2);
  for (std::size_t i = 0; i < out.length; ++i) {
    out.data[i] = static_cast<std::uint8_t>(std::stoi(hex.substr(2 * i, 2), nullptr, 16));
  }
  return out;
}

std::string hex(const CanFrame& frame) {
  std::string out;
  for (int i = 0; i < frame.length; ++i) {
    char text[3];
    std::snprintf(text, sizeof text, "%02X", frame.data[i]);
    out += text;
  }
  return out;
}

class Node : public ::testing::Test {
 protected:
  explicit Node(const JointConfig& joint = joint3()) : node_(joint, false) {}

  /// The answer's bytes, or "none".
  std::string send(const CanFrame& request) {
    if (!node_.receive(request, joint_, now_, &reply_)) return "none";
    return hex(reply_);
  }
  std::string send(Special special) { return send(mit::encode_special(special, 3, false)); }
  std::string send(const mit::Command& command) {
    CanFrame request;
    EXPECT_TRUE(mit::encode_command(command, joint3().drive.range, 3, false, mit::Quantiser::kRound,
                                    &request));
    return send(request);
  }
  void write(std::uint8_t reg, std::uint32_t value) {
    send(mit::encode_register_write(3, static_cast<mit::Register>(reg), value, false));
  }
  std::uint32_t read(std::uint8_t reg) {
    send(mit::encode_register_read(3, static_cast<mit::Register>(reg), false));
    std::uint32_t value = 0;
    EXPECT_TRUE(mit::decode_register(reply_, 3, 0x33, static_cast<mit::Register>(reg), &value));
    return value;
  }
  void advance(std::int64_t ns) {
    now_ += ns;
    node_.update(joint_, now_);
  }
  void enable_with_watchdog() {
    write(9, 400);  // 20 ms
    send(Special::kEnable);
  }

  DamiaoNode node_;
  JointReading joint_;
  std::int64_t now_ = 0;
  CanFrame reply_;
};

TEST_F(Node, AnswersWithStateInItsFields) {
  // p: 0.75 rad is 1955.7 encoder steps, floored 1955 steps = 0.749735; (0.749735 + 12.5) 65535 /
  // 25 = 34732.8 -> 0x87AC. v: (-0.5 + 30) 4095 / 60 = 2013.4 -> 0x7DD. t: (1.8 + 10) 4095 / 20 =
  // 2416.05 -> 0x970. 30 degC twice.
  joint_ = {0.75, -0.5, 0.75, -0.5, 1.8};
  EXPECT_EQ(send(Special::kEnable), "0387AC7DD9701E1E");  // state before: disabled
  EXPECT_EQ(reply_.id, 0x13u);
  EXPECT_EQ(send(frame(3, "7FFF7FF000000800")), "1387AC7DD9701E1E");
}

TEST_F(Node, AnswersBeforeTheFrameTakesEffect) {
  EXPECT_EQ(send(Special::kEnable)[0], '0');
  EXPECT_EQ(send(Special::kDisable)[0], '1');
  EXPECT_EQ(send(Special::kEnable)[0], '0');
  EXPECT_EQ(node_.state(), DriveError::kEnabled);
}

TEST_F(Node, AnswersInTheFormatOfTheRequest) {
  send(frame(3, "FFFFFFFFFFFFFFFC", true));
  EXPECT_TRUE(reply_.fd);
  EXPECT_TRUE(reply_.bitrate_switch);
  send(frame(0x7FF, "0300331700000000", true));
  EXPECT_TRUE(reply_.fd);
  send(frame(3, "FFFFFFFFFFFFFFFC"));
  EXPECT_FALSE(reply_.fd);
  EXPECT_FALSE(reply_.bitrate_switch);
}

TEST_F(Node, IsSilentOnFramesOfOthers) {
  EXPECT_EQ(send(frame(4, "7FFF7FF000000800")), "none");
  EXPECT_EQ(send(frame(0x13, "7FFF7FF000000800")), "none");
  EXPECT_EQ(send(frame(0x7FF, "0400331700000000")), "none");
  EXPECT_EQ(send(frame(3, "7FFF7FF0000008")), "none");
  EXPECT_EQ(send(frame(0x103, "7FFF7FF000000800")), "none");  // position mode is not active
  CanFrame strange = frame(3, "7FFF7FF000000800");
  strange.extended = true;
  EXPECT_EQ(send(strange), "none");
  strange.extended = false;
  strange.remote = true;
  EXPECT_EQ(send(strange), "none");
  strange.remote = false;
  strange.error = true;
  EXPECT_EQ(send(strange), "none");
}

TEST_F(Node, TakesSpecialFramesOnTheIdsOfOtherModes) {
  EXPECT_NE(send(frame(0x303, "FFFFFFFFFFFFFFFC")), "none");
  EXPECT_EQ(node_.state(), DriveError::kEnabled);
}

TEST_F(Node, CommandBecomesTorqueLaw) {
  send(Special::kEnable);
  // The worked frame: p 1.0, v -2.0, kp 60, kd 1.5, t 2.5, truncated fields 35388 1911 491 1228
  // 2559.
  send(frame(3, "8A3C7771EB4CC9FF"));
  const DriveLaw law = node_.law();
  EXPECT_NEAR(law.q_des, 35388 * 25.0 / 65535 - 12.5, 1e-12);
  EXPECT_NEAR(law.v_des, 1911 * 60.0 / 4095 - 30.0, 1e-12);
  EXPECT_NEAR(law.kp, 491 * 500.0 / 4095, 1e-12);
  EXPECT_NEAR(law.kd, 1228 * 5.0 / 4095, 1e-12);
  EXPECT_NEAR(law.tau_ff, 2559 * 20.0 / 4095 - 10.0, 1e-12);
  EXPECT_NEAR(law.torque(0.98, 0.0), 59.95 * (0.9998 - 0.98) - 1.499 * 2.0 + 2.498, 1e-2);
  EXPECT_EQ(law.torque(-5.0, 0.0), 7.0);  // the drive's peak, below the range of 10
  EXPECT_EQ(law.passive_damping, 0.0);
}

TEST_F(Node, CommandsWhileDisabledChangeNothing) {
  EXPECT_NE(send(mit::Command{0.0, 0.0, 0.0, 0.0, 5.0}), "none");
  EXPECT_EQ(node_.law().torque(0.0, 0.0), 0.0);
  send(Special::kEnable);
  EXPECT_EQ(node_.law().torque(0.0, 0.0), 0.0);
}

TEST_F(Node, DisablingForgetsTheCommand) {
  send(Special::kEnable);
  send(mit::Command{0.0, 0.0, 0.0, 0.0, 5.0});
  EXPECT_NEAR(node_.law().torque(0.0, 0.0), 5.0, 0.003);
  send(Special::kDisable);
  EXPECT_EQ(node_.law().torque(0.0, 0.0), 0.0);
  send(Special::kEnable);
  EXPECT_EQ(node_.law().torque(0.0, 0.0), 0.0);
}

TEST_F(Node, RegisterFramesOfTheManual) {
  EXPECT_EQ(send(frame(0x7FF, "0300331700000000")), "0300331700002041");  // TMAX 10.0
  EXPECT_EQ(reply_.id, 0x13u);
  EXPECT_EQ(send(frame(0x7FF, "0300550990010000")), "0300550990010000");  // TIMEOUT 400
  EXPECT_EQ(node_.registers().timeout_ns(), 20 * kMs);
  EXPECT_EQ(send(frame(0x7FF, "0300CC0000000000")).substr(0, 2), "03");  // a state reply
}

TEST_F(Node, RegistersTellWhatTheRobotFileSays) {
  EXPECT_EQ(read(9), 0u);  // no watchdog until somebody asks for one
  EXPECT_EQ(read(10), 1u);
  EXPECT_EQ(read(7), 0x13u);
  EXPECT_EQ(read(8), 3u);
  EXPECT_EQ(mit::bits_float(read(20)), 10.0f);
  EXPECT_EQ(mit::bits_float(read(21)), 12.5f);
  EXPECT_EQ(mit::bits_float(read(22)), 30.0f);
  EXPECT_NEAR(mit::bits_float(read(12)), 1.8e-5f, 1e-10f);
  joint_.theta = 1.0;
  EXPECT_NEAR(mit::bits_float(read(81)), 1.0f, 4e-4f);
  EXPECT_NEAR(mit::bits_float(read(80)), 10.0f, 4e-3f);
  EXPECT_EQ(read(200), 0u);
}

TEST_F(Node, RegistersRefuseWhatMakesNoSense) {
  write(20, mit::float_bits(5.0f));  // read-only
  EXPECT_EQ(mit::bits_float(read(20)), 10.0f);
  for (const float bad : {0.0f, -1.0f, std::nanf(""), INFINITY}) {
    write(23, mit::float_bits(bad));
    EXPECT_EQ(mit::bits_float(read(23)), 10.0f);
  }
  write(10, 0);
  write(10, 5);
  EXPECT_EQ(read(10), 1u);
  const struct {
    std::uint8_t reg;
    float value;
  } outside[] = {{0, 9.9F},  {2, 79.0F}, {3, 0.0F},  {3, 1.1F},  {5, 1.0F},   {6, -1.0F},
                 {24, 99.F}, {25, -1.F}, {30, 1.1F}, {31, 0.9F}, {32, 501.F}, {81, 1.0F}};
  for (const auto& [reg, value] : outside) {
    const std::uint32_t before = read(reg);
    write(reg, mit::float_bits(value));
    EXPECT_EQ(read(reg), before) << int{reg};
  }
  write(25, mit::float_bits(0.5F));
  EXPECT_EQ(mit::bits_float(read(25)), 0.5F);
  for (const std::uint32_t bad : {0x7FFu, 0x800u, 0xFFFFFFFFu}) write(7, bad);
  EXPECT_EQ(read(7), 0x13u);
  for (const std::uint32_t bad : {0u, 0x100u}) write(8, bad);
  EXPECT_EQ(read(8), 3u);
  write(35, 4);
}

TEST_F(Node, AtAnotherBitRateItNeitherHearsNorAnswers) {
  EXPECT_EQ(read(35), 4u);  // 1 Mbit/s
  write(35, 10);            // no code of the manual
  EXPECT_EQ(send(frame(0x7FF, "0300552304000000")), "0300552304000000");
  EXPECT_EQ(send(frame(0x7FF, "0300552303000000")), "0300552303000000");  // 500 kbit/s
  EXPECT_EQ(send(frame(0x7FF, "0300332300000000")), "none");
  EXPECT_EQ(send(frame(3, "FFFFFFFFFFFFFFFC")), "none");
}

TEST_F(Node, NewIdentifiersHoldFromTheNextFrameOn) {
  EXPECT_EQ(send(frame(0x7FF, "0300550721000000")), "0300550721000000");  // MST_ID 0x21
  EXPECT_EQ(reply_.id, 0x13u);
  EXPECT_EQ(send(frame(0x7FF, "0300550805000000")), "0300550805000000");  // ESC_ID 5
  EXPECT_EQ(reply_.id, 0x21u);
  EXPECT_EQ(send(frame(3, "FFFFFFFFFFFFFFFC")), "none");
  EXPECT_EQ(send(frame(0x7FF, "0300330800000000")), "none");
  EXPECT_EQ(send(frame(5, "FFFFFFFFFFFFFFFC")).substr(0, 2), "05");
  EXPECT_EQ(reply_.id, 0x21u);
  EXPECT_EQ(send(frame(0x7FF, "0500330800000000")), "0500330805000000");
  EXPECT_NE(send(frame(0x105, "FFFFFFFFFFFFFFFD")), "none");
}

// The manual has the flash written at rest only; what it answers otherwise it does not have.
TEST_F(Node, RegistersAreStoredAtRest) {
  EXPECT_EQ(send(frame(0x7FF, "0300AA0100000000")), "0300AA0100000000");
  send(Special::kEnable);
  EXPECT_EQ(send(frame(0x7FF, "0300AA0100000000")), "0300AA0000000000");
}

TEST_F(Node, ADifferentTorqueRangeScalesTorque) {
  send(Special::kEnable);
  write(23, mit::float_bits(20.0f));
  send(mit::Command{0.0, 0.0, 0.0, 0.0, 2.0});  // packed for 10
  EXPECT_NEAR(node_.law().torque(0.0, 0.0), 4.0, 0.01);
}

TEST_F(Node, OtherControlModesIgnoreMitCommands) {
  send(Special::kEnable);
  send(mit::Command{0.0, 0.0, 0.0, 0.0, 2.0});
  write(10, 3);
  EXPECT_EQ(node_.law().torque(0.0, 0.0), 0.0);
  EXPECT_NE(send(mit::Command{0.0, 0.0, 0.0, 0.0, 2.0}), "none");
  EXPECT_EQ(node_.law().torque(0.0, 0.0), 0.0);
}

class ServoModes : public Node {
 protected:
  void enable_in(std::uint32_t mode) {
    write(10, mode);
    send(Special::kEnable);
  }
  double wanted() const { return node_.law().q_des; }
};

// 0.5 rad, at most 2 rad/s: 0000003F, 00000040.
TEST_F(ServoModes, PositionVelocityGoesThereAtTheCommandedSpeed) {
  enable_in(2);
  EXPECT_EQ(node_.law().torque(1.0, 1.0), 0.0);  // nothing is commanded yet
  EXPECT_EQ(send(frame(0x103, "0000003F00000040"))[0], '1');
  EXPECT_EQ(send(frame(0x103, "0000003F000000")), "none");  // too short
  for (int ms = 1; ms <= 300; ++ms) {
    joint_.theta = wanted();  // follows
    advance(kMs);
    EXPECT_NEAR(wanted(), std::min(0.002 * ms, 0.5), 2.5e-3) << ms;
    EXPECT_LE(std::abs(node_.law().v_des), 2.0);
  }
  EXPECT_NEAR(wanted(), 0.5, 1e-9);
  EXPECT_EQ(node_.law().v_des, 0.0);
  EXPECT_EQ(node_.law().limit, 7.0);
}

TEST_F(ServoModes, ASetpointInFrontOfAnObstacleDoesNotWindUpAndGoesOnLater) {
  enable_in(2);
  send(frame(0x103, "0000003F00000040"));
  for (int ms = 0; ms < 1000; ++ms) advance(kMs);
  EXPECT_NEAR(node_.law().torque(0.0, 0.0), 7.0, 0.1);
  EXPECT_NEAR(wanted(), 7.0 / 500.0, 4e-4);
  for (int ms = 0; ms < 1000; ++ms) {
    joint_.theta = wanted();
    advance(kMs);
  }
  EXPECT_NEAR(wanted(), 0.5, 1e-9);
}

TEST_F(ServoModes, VelocityWithFourBytesOrEight) {
  for (const char* bytes : {"000000BF", "000000BF00000000"}) {  // -0.5 rad/s
    node_ = DamiaoNode(joint3(), false);
    joint_ = {};
    enable_in(3);
    EXPECT_NE(send(frame(0x203, bytes)), "none");
    for (int ms = 0; ms < 200; ++ms) {
      joint_.theta = wanted();
      advance(kMs);
    }
    EXPECT_NEAR(wanted(), -0.1, 2e-3);
    EXPECT_EQ(node_.law().v_des, -0.5);
  }
}

TEST_F(ServoModes, TheAccelerationRegisterIsHonoured) {
  write(4, mit::float_bits(10.0F));
  enable_in(3);
  send(frame(0x203, "0000803F"));  // 1 rad/s
  for (int ms = 0; ms < 50; ++ms) advance(kMs);
  EXPECT_NEAR(node_.law().v_des, 0.5, 1e-9);
}

// Position 0.5, 2.00 rad/s, a quarter of the torque: C800, C409.
TEST_F(ServoModes, ForcePositionLimitsTheTorque) {
  enable_in(4);
  send(frame(0x303, "0000003FC800C409"));
  for (int ms = 0; ms < 500; ++ms) advance(kMs);
  EXPECT_NEAR(node_.law().limit, 7.0 / 4.0, 1e-9);
  EXPECT_NEAR(node_.law().torque(0.0, 0.0), 1.75, 1e-9);
}

TEST_F(ServoModes, WhatIsNoNumberIsAnsweredAndNotObeyed) {
  enable_in(2);
  for (const char* bad : {"0000C07F00000040", "0000003F0000C07F", "0000003F000080BF",
                          "0000807F00000040", "0000003F0000807F"}) {
    EXPECT_NE(send(frame(0x103, bad)), "none");
    advance(kMs);
    EXPECT_EQ(node_.law().torque(1.0, 1.0), 0.0) << bad;
  }
}

TEST_F(ServoModes, CommandsOfOtherModesAreIgnored) {
  enable_in(2);
  EXPECT_EQ(send(frame(0x203, "0000803F")), "none");
  EXPECT_EQ(send(frame(0x303, "0000003FC800C409")), "none");
  EXPECT_EQ(send(frame(0x403, "0000003FC800C409")), "none");
  advance(kMs);
  EXPECT_EQ(node_.law().torque(1.0, 1.0), 0.0);
}

TEST_F(ServoModes, AnotherModeOrDisablingForgetsTheSetpoint) {
  for (const bool by_mode : {true, false}) {
    enable_in(2);
    send(frame(0x103, "0000003F00000040"));
    advance(kMs);
    EXPECT_NE(node_.law().kp, 0.0);
    if (by_mode) {
      write(10, 3);
    } else {
      send(Special::kDisable);
      send(Special::kEnable);
    }
    advance(kMs);
    EXPECT_EQ(node_.law().kp, 0.0);
    send(Special::kDisable);
  }
}

TEST_F(ServoModes, SetpointsFeedTheWatchdog) {
  write(9, 400);
  enable_in(2);
  for (int i = 0; i < 10; ++i) {
    advance(15 * kMs);
    send(frame(0x103, "0000003F00000040"));
  }
  EXPECT_EQ(node_.state(), DriveError::kEnabled);
  advance(21 * kMs);
  EXPECT_EQ(node_.state(), DriveError::kCommunicationLost);
  EXPECT_EQ(node_.law().kp, 0.0);
}

TEST_F(Node, WatchdogLatchesCommunicationLost) {
  enable_with_watchdog();
  send(mit::Command{0.0, 0.0, 0.0, 0.0, 2.0});
  advance(20 * kMs);
  EXPECT_EQ(node_.state(), DriveError::kEnabled);
  advance(1);
  EXPECT_EQ(node_.state(), DriveError::kCommunicationLost);
  EXPECT_EQ(node_.law().torque(0.0, 0.0), 0.0);
  EXPECT_EQ(node_.law().passive_damping, 0.4);  // phases shorted

  EXPECT_EQ(send(mit::Command{0.0, 0.0, 0.0, 0.0, 2.0})[0], 'D');
  EXPECT_EQ(node_.law().torque(0.0, 0.0), 0.0);
  send(Special::kEnable);
  EXPECT_EQ(node_.state(), DriveError::kCommunicationLost);
  send(Special::kDisable);
  EXPECT_EQ(node_.state(), DriveError::kCommunicationLost);
  send(Special::kClearError);
  EXPECT_EQ(node_.state(), DriveError::kDisabled);
  EXPECT_EQ(node_.law().passive_damping, 0.0);
  send(Special::kEnable);
  EXPECT_EQ(node_.state(), DriveError::kEnabled);
}

TEST_F(Node, WatchdogIsFedByEachFrameForTheNodeAndNoOther) {
  enable_with_watchdog();
  for (int k = 0; k < 10; ++k) {
    advance(15 * kMs);
    send(frame(0x7FF, "0300CC0000000000"));
  }
  EXPECT_EQ(node_.state(), DriveError::kEnabled);
  for (int k = 0; k < 2; ++k) {
    advance(15 * kMs);
    send(frame(4, "7FFF7FF000000800"));
    send(frame(0x7FF, "0400CC0000000000"));
    send(frame(3, "7FFF"));
  }
  EXPECT_EQ(node_.state(), DriveError::kCommunicationLost);
}

TEST_F(Node, WithoutTimeoutTheWatchdogSleeps) {
  send(Special::kEnable);
  advance(3600'000 * kMs);
  EXPECT_EQ(node_.state(), DriveError::kEnabled);
}

TEST_F(Node, DisabledDriveIsNotWatched) {
  write(9, 400);
  advance(1000 * kMs);
  EXPECT_EQ(node_.state(), DriveError::kDisabled);
}

TEST(DamiaoNode, WatchdogReactionOffLeavesTheJointFree) {
  JointConfig joint = joint3();
  joint.drive.watchdog_reaction = NodeWatchdogReaction::kOff;
  DamiaoNode node(joint, false);
  CanFrame reply;
  node.receive(mit::encode_register_write(3, mit::Register::kTimeout, 20, false), {}, 0, &reply);
  node.receive(mit::encode_special(Special::kEnable, 3, false), {}, 0, &reply);
  node.update({}, 2 * kMs);
  EXPECT_EQ(node.state(), DriveError::kCommunicationLost);
  EXPECT_EQ(node.law().passive_damping, 0.0);
}

TEST(DamiaoNode, SignAndOffsetStayInTheDrive) {
  JointConfig joint = joint3();
  joint.drive.sign = -1.0;
  joint.drive.offset_rad = 0.25;
  DamiaoNode node(joint, false);
  CanFrame frame;
  CanFrame reply;
  node.receive(mit::encode_special(Special::kEnable, 3, false), {}, 0, &reply);
  // Joint at 0.5, 1.0 rad/s, 2 N m: the drive sees -0.5 + 0.25, -1.0 rad/s, -2 N m.
  const JointReading reading{0.5, 1.0, 0.5, 1.0, 2.0};
  ASSERT_TRUE(mit::encode_command({-0.35, 1.0, 100.0, 2.0, -1.0}, joint.drive.range, 3, false,
                                  mit::Quantiser::kRound, &frame));
  ASSERT_TRUE(node.receive(frame, reading, 0, &reply));
  mit::Reply state;
  ASSERT_TRUE(mit::decode_reply(reply, joint.drive.range, &state));
  EXPECT_NEAR(state.position_rad, -0.25, 8e-4);
  EXPECT_NEAR(state.velocity_rad_per_s, -1.0, 0.015);
  EXPECT_NEAR(state.torque_Nm, -2.0, 0.005);
  // The law in joint coordinates: joint angle wanted is -(-0.35 - 0.25) = 0.6.
  const DriveLaw law = node.law();
  EXPECT_NEAR(law.q_des, 0.6, 4e-4);
  EXPECT_NEAR(law.v_des, -1.0, 0.01);
  EXPECT_NEAR(law.tau_ff, 1.0, 0.004);
  EXPECT_GT(law.kp, 0.0);
}

TEST_F(Node, PositionIsFlooredToEncoderSteps) {
  const double step = 2.0 * M_PI / 16384;
  for (const double q : {0.1, -0.1, 2.7, -3.0}) {
    joint_.theta = q;
    send(Special::kDisable);
    mit::Reply state;
    ASSERT_TRUE(mit::decode_reply(reply_, joint3().drive.range, &state));
    const double floored = std::floor(q / step) * step;
    EXPECT_LE(state.position_rad, floored + 1e-12);
    EXPECT_GT(state.position_rad, floored - 25.0 / 65535);
  }
}

TEST_F(Node, SetZeroWorksAtRestOnly) {
  joint_.theta = 0.7;
  send(Special::kSetZero);
  send(Special::kEnable);
  mit::Reply state;
  ASSERT_TRUE(mit::decode_reply(reply_, joint3().drive.range, &state));
  EXPECT_NEAR(state.position_rad, 0.0, 4e-4);
  send(mit::Command{0.1, 0.0, 10.0, 0.0, 0.0});
  EXPECT_NEAR(node_.law().q_des, 0.8, 1e-3);
  joint_.theta = 0.9;
  send(Special::kSetZero);  // enabled: answered, not obeyed
  send(Special::kEnable);
  ASSERT_TRUE(mit::decode_reply(reply_, joint3().drive.range, &state));
  EXPECT_NEAR(state.position_rad, 0.2, 8e-4);
}

TEST_F(Node, SilentNodeObeysWithoutAnswering) {
  enable_with_watchdog();
  node_.inject(scenario_event_t::FAULT_SILENT, joint_, now_ + 5 * kMs);
  EXPECT_EQ(send(mit::Command{0.0, 0.0, 0.0, 0.0, 2.0}), "none");
  EXPECT_EQ(send(frame(0x7FF, "0300331700000000")), "none");
  EXPECT_NEAR(node_.law().tau_ff, 2.0, 0.003);
  advance(5 * kMs);
  EXPECT_NE(send(mit::Command{0.0, 0.0, 0.0, 0.0, 2.0}), "none");
}

// Its last two bytes: power stage and winding, degC; usually 30 = 1Eh.
TEST(HotNode, ReportsAKelvinMoreThanItsLimit) {
  JointConfig joint = joint3();
  joint.drive.limit_temperature_degC = 90.0;
  DamiaoNode node(joint, false);
  CanFrame reply;
  const auto temperatures = [&](std::int64_t now_ns) {
    EXPECT_TRUE(node.receive(mit::encode_state_request(3, false), {}, now_ns, &reply));
    return hex(reply).substr(12);
  };
  EXPECT_EQ(temperatures(0), "1E1E");
  node.inject(scenario_event_t::FAULT_HOT, {}, 5 * kMs);
  EXPECT_EQ(temperatures(4 * kMs), "5B5B");
  EXPECT_EQ(node.state(), mit::DriveError::kDisabled) << "no error of its own";
  EXPECT_EQ(temperatures(5 * kMs), "1E1E");
}

TEST_F(Node, WithoutALimitItIsNotHot) {
  node_.inject(scenario_event_t::FAULT_HOT, joint_, INT64_MAX);
  EXPECT_EQ(send(mit::encode_state_request(3, false)).substr(12), "1E1E");
}

TEST_F(Node, FrozenEncoderFreezesTheDrivesOwnLoopToo) {
  joint_ = {0.5, 0.2, 0.5, 0.2, 0.0};
  send(Special::kEnable);
  send(mit::Command{0.6, 0.0, 20.0, 1.0, 0.0});
  node_.inject(scenario_event_t::FAULT_FROZEN_ENCODER, joint_, now_ + 5 * kMs);
  joint_ = {0.9, 3.0, 0.9, 3.0, 0.0};
  send(mit::Command{0.6, 0.0, 20.0, 1.0, 0.0});
  mit::Reply state;
  ASSERT_TRUE(mit::decode_reply(reply_, joint3().drive.range, &state));
  EXPECT_NEAR(state.position_rad, 0.5, 8e-4);
  EXPECT_NEAR(state.velocity_rad_per_s, 0.0, 0.015);
  EXPECT_NEAR(node_.law().torque(0.9, 3.0), 20.0 * 0.1, 0.05);
  advance(5 * kMs);
  EXPECT_NEAR(node_.law().torque(0.9, 0.0), 20.0 * -0.3, 0.05);
}

TEST_F(Node, DriveErrorLeavesEnabledModeAndHoldsUntilItIsOverAndCleared) {
  enable_with_watchdog();
  send(mit::Command{0.0, 0.0, 0.0, 0.0, 2.0});
  node_.inject(scenario_event_t::FAULT_DRIVE_ERROR, joint_, now_ + 5 * kMs);
  EXPECT_EQ(node_.law().torque(0.0, 0.0), 0.0);
  EXPECT_EQ(send(Special::kClearError)[0], 'A');
  EXPECT_EQ(send(Special::kEnable)[0], 'A');
  advance(6 * kMs);
  EXPECT_EQ(send(Special::kEnable)[0], 'A');  // latched
  send(Special::kClearError);
  EXPECT_EQ(send(Special::kEnable)[0], '0');
  EXPECT_EQ(node_.state(), DriveError::kEnabled);
}

TEST_F(Node, DroppedCommandsAreAnsweredAndStarveTheWatchdog) {
  enable_with_watchdog();
  send(mit::Command{0.0, 0.0, 0.0, 0.0, 2.0});
  node_.inject(scenario_event_t::FAULT_DROP_COMMANDS, joint_, INT64_MAX);
  for (int k = 0; k < 21; ++k) {
    EXPECT_NE(send(mit::Command{0.0, 0.0, 0.0, 0.0, -2.0}), "none");
    if (k < 20) {
      EXPECT_NEAR(node_.law().tau_ff, 2.0, 0.003);
    }
    advance(kMs);
  }
  EXPECT_EQ(node_.state(), DriveError::kCommunicationLost);
  node_.clear_faults();
  send(Special::kClearError);
  EXPECT_EQ(node_.state(), DriveError::kDisabled);
}

}  // namespace
}  // namespace limber::sim::test_damiao_node
