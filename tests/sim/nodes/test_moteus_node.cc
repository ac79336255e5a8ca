// The emulated moteus drive, byte by byte where bytes matter.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limber/scenario_event_t.hpp>
#include <numbers>
#include <string>

#include "drivers/protocols/moteus.h"
#include "sim/nodes/moteus_node.h"
#include "tests/sim/test_arms.h"

namespace limber::sim::test_moteus_node {
namespace {

using moteus::Mode;
using moteus::Register;

constexpr std::int64_t kMs = 1'000'000;
constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint32_t kToServo4 = 0x8004;

/// Servo 4: kp 40 and kd 4 N m per turn, peak 10 N m.
JointConfig servo4() {
  JointConfig joint = testing::joint_config(3, JointType::kRevolute, 0.0);
  joint.drive.protocol = DriveProtocol::kMoteus;
  joint.drive.command_id = kToServo4;
  joint.drive.reply_id = 0x400;
  joint.drive.counts_per_turn = std::exp2(32);
  joint.drive.peak_torque_Nm = 10.0;
  joint.drive.timeout_torque_Nm = 5.0;
  joint.drive.torque_constant_Nm_per_A = 0.5;
  joint.drive.range = {HUGE_VAL, HUGE_VAL, HUGE_VAL, 40.0 / kTurn, 4.0 / kTurn};
  return joint;
}

CanFrame frame(std::uint32_t id, const std::string& hex, bool fd = true) {
  CanFrame out;
  out.id = id;
  out.extended = id > kStandardIdMax;
  out.fd = out.bitrate_switch = fd;
  out.length = static_cast<std::uint8_t>(hex.size() / 2);
  for (std::size_t i = 0; i < out.length; ++i)
    out.data[i] = static_cast<std::uint8_t>(std::stoi(hex.substr(2 * i, 2), nullptr, 16));
  return out;
}

std::string hex(const CanFrame& frame) {
  std::string out;
  for (std::size_t i = 0; i < frame.length; ++i) {
    std::array<char, 3> text{};
    std::snprintf(text.data(), text.size(), "%02X", frame.data[i]);
    out += text.data();
  }
  return out;
}

class MoteusNodeTest : public ::testing::Test {
 protected:
  /// The answer's bytes, or "none".
  std::string send(const CanFrame& request) {
    if (!node_.receive(request, joint_, now_, &reply_)) return "none";
    return hex(reply_);
  }
  std::string send(const std::string& bytes) { return send(frame(kToServo4, bytes)); }
  void command(double position, double kp, double kd, double torque, double most = 8.0,
               double watchdog = 0.02) {
    send(moteus::encode_command({position, 0.0, torque, kp, kd, most, watchdog}, kToServo4));
  }
  double read(Register reg) {
    send(moteus::encode_read(reg, kToServo4));
    double value = kNan;
    EXPECT_TRUE(moteus::decode_register(reply_, reg, &value));
    return value;
  }
  void advance(std::int64_t ns) {
    now_ += ns;
    node_.update(joint_, now_);
  }
  void come_up(double torque = 0.0) {
    command(kNan, 0.0, 0.0, torque);
    advance(3 * kMs);
    ASSERT_EQ(node_.mode(), Mode::kPosition);
  }
  double torque_at(double q, double v) const { return node_.law().torque(q, v); }

  MoteusNode node_{servo4()};
  JointReading joint_;
  std::int64_t now_ = 0;
  CanFrame reply_;
};

TEST_F(MoteusNodeTest, StopIsAnsweredWithTheState) {
  joint_ = {0.1 * kTurn, 0.0, 0.1 * kTurn, 0.0, 0.85};
  // 0.1 turns is 0x3DCCCCCD, but the encoder floors by less than a float tells; 0.85 N m, 48 V in
  // half volts, 30 degC, no fault.
  EXPECT_EQ(send("01000011001F01130D505050"),
            "2100002F01"
            "CDCCCC3D"
            "00000000"
            "9A99593F"
            "230D601E005050");
  EXPECT_EQ(reply_.id, 0x400U);
  EXPECT_FALSE(reply_.extended);
  EXPECT_TRUE(reply_.fd && reply_.bitrate_switch);
}

TEST_F(MoteusNodeTest, WorkedCommandIsObeyed) {
  send(
      "01000A0C0520CDCCCC3D000000009A99593FCDCC4C3ECDCCCC3D0D270AD7A33C11001F01130D"
      "50505050505050505050");
  advance(3 * kMs);
  ASSERT_EQ(node_.mode(), Mode::kPosition);
  // 40 * 0.2 * (0.1 - 0.05) turns - 4 * 0.1 * 0.2 turns/s + 0.85 N m
  EXPECT_NEAR(torque_at(0.05 * kTurn, 0.2 * kTurn), 0.4 - 0.08 + 0.85, 1e-6);
}

TEST_F(MoteusNodeTest, TorqueOnlyInInt16) {
  send(
      "01000A0406200080000055000000"
      "0000C800140400130D50");
  advance(3 * kMs);
  EXPECT_NEAR(torque_at(3.0, 5.0), 0.85, 1e-9);
  EXPECT_EQ(node_.law().limit, 2.0);
}

TEST_F(MoteusNodeTest, IntegerAnswers) {
  joint_ = {0.1 * kTurn + 1e-9, -0.025 * kTurn - 1e-9, 0.1 * kTurn + 1e-9, -0.025 * kTurn - 1e-9,
            0.8501};
  EXPECT_EQ(send("140400130D"),
            "240400"
            "0000E8039CFF5500"
            "230D601E00");
}

TEST_F(MoteusNodeTest, AnswersBeforeTheFrameTakesEffect) {
  moteus::State state;
  const auto mode_said = [&](const CanFrame& request) {
    send(request);
    EXPECT_TRUE(moteus::decode_state(reply_, &state));
    return state.mode;
  };
  EXPECT_EQ(mode_said(moteus::encode_command({}, kToServo4)), Mode::kStopped);
  EXPECT_EQ(mode_said(moteus::encode_stop(kToServo4)), Mode::kEnabling);
  EXPECT_EQ(mode_said(moteus::encode_state_request(kToServo4)), Mode::kStopped);
}

TEST_F(MoteusNodeTest, ComesUpThroughModes2To4) {
  command(kNan, 0.0, 0.0, 1.0);
  for (int mode : {2, 3, 4, 10}) {
    EXPECT_EQ(static_cast<int>(node_.mode()), mode);
    EXPECT_EQ(torque_at(0.0, 0.0), mode == 10 ? 1.0 : 0.0);
    advance(kMs);
  }
}

TEST_F(MoteusNodeTest, SilentOnFramesOfOthers) {
  EXPECT_EQ(send(frame(0x8005, "1100")), "none");
  EXPECT_EQ(send(frame(0x18004, "1100")), "none");  // another prefix
  EXPECT_EQ(send(frame(0x1FFFFFF0, "0000000000000000")), "none");
  EXPECT_EQ(send(frame(0x0004, "01000A")), "none");  // heard, but no answer wanted
  EXPECT_EQ(node_.mode(), Mode::kEnabling);
  CanFrame remote = frame(kToServo4, "1100");
  remote.remote = true;
  EXPECT_EQ(send(remote), "none");
}

TEST_F(MoteusNodeTest, BroadcastAndOtherHostsAreAnswered) {
  EXPECT_EQ(send(frame(0x807F, "1100")), "210000");
  EXPECT_EQ(send(frame(0x8304, "1100")), "210000");
  EXPECT_EQ(reply_.id, 0x403U);
  EXPECT_EQ(send(""), "");  // an empty frame has an empty answer
}

TEST_F(MoteusNodeTest, ClassicFramesAreAnsweredSoIfTheyFit) {
  EXPECT_EQ(send(frame(kToServo4, "1100", false)), "210000");
  EXPECT_FALSE(reply_.fd);
  EXPECT_EQ(send(frame(kToServo4, "1F01", false)).size(), 32U);
  EXPECT_TRUE(reply_.fd);
  EXPECT_FALSE(reply_.bitrate_switch);
}

TEST_F(MoteusNodeTest, UnknownAndReadOnlyRegistersAreErrors) {
  EXPECT_EQ(send("11401100"), "314001210000");
  EXPECT_EQ(send("1F001100"),
            "2F00"
            "00000000"
            "00000000"
            "00000000"
            "210000505050");
  EXPECT_EQ(send("134F"), "314F01");  // a row with an unknown register fails as a whole
  EXPECT_EQ(send("014001"), "304001");
  EXPECT_EQ(send("010101"), "300102");
  EXPECT_EQ(send("110060FF1100"), "210000");  // what follows the unknown opcode is lost
}

TEST_F(MoteusNodeTest, EveryRegisterInEveryFormat) {
  const Register all[] = {Register::kMode,
                          Register::kPosition,
                          Register::kVelocity,
                          Register::kTorque,
                          Register::kCurrentQ,
                          Register::kCurrentD,
                          Register::kAbsolutePosition,
                          Register::kMotorTemperature,
                          Register::kTrajectoryComplete,
                          Register::kHomeState,
                          Register::kVoltage,
                          Register::kTemperature,
                          Register::kFault,
                          Register::kCommandVelocity,
                          Register::kCommandKpScale,
                          Register::kTorqueP,
                          Register::kTorqueI,
                          Register::kTorqueD,
                          Register::kTorqueFeedForward,
                          Register::kTorqueTotal,
                          Register::kMilliseconds,
                          Register::kModel,
                          Register::kFirmware,
                          Register::kRegisterMap,
                          Register::kId};
  joint_ = {0.5, 0.25, 0.5, 0.25, 1.5};
  for (Register reg : all) {
    for (int type = 0; type < 4; ++type) {
      moteus::FrameWriter request(kToServo4);
      request.read(static_cast<moteus::Type>(type), static_cast<std::uint16_t>(reg), 1);
      send(request.frame());
      double value = kNan;
      EXPECT_TRUE(moteus::decode_register(reply_, reg, &value)) << static_cast<int>(reg);
      EXPECT_FALSE(std::isnan(value)) << static_cast<int>(reg);
    }
  }
  EXPECT_EQ(read(Register::kRegisterMap), 5.0);
  EXPECT_EQ(read(Register::kId), 4.0);
  EXPECT_EQ(read(Register::kCurrentQ), 3.0);  // 1.5 N m at 0.5 N m/A
}

TEST_F(MoteusNodeTest, WritingTheModeResetsTheCommand) {
  come_up(2.0);
  EXPECT_EQ(torque_at(0.0, 0.0), 2.0);
  send("01000A");  // omitted values are defaults: scales 1, no torque, hold where it is
  EXPECT_EQ(torque_at(0.0, 0.0), 0.0);
  EXPECT_NEAR(torque_at(-0.01 * kTurn, 0.0), 0.4, 1e-9);
  EXPECT_EQ(node_.law().limit, 10.0);
}

TEST_F(MoteusNodeTest, WithoutAModeNothingIsCommanded) {
  come_up(2.0);
  send("0D2200004040");  // 3 N m into the feed-forward register
  EXPECT_EQ(torque_at(0.0, 0.0), 2.0);
}

TEST_F(MoteusNodeTest, DampingIsHeldToTheScaleOfTheSpring) {
  come_up();
  for (double kp : {0.0, 0.2, 0.5}) {
    command(0.0, kp, 0.3, 0.0);
    EXPECT_NEAR(torque_at(0.0, kTurn), -4.0 * std::min(kp, 0.3), 1e-6) << kp;
  }
}

TEST_F(MoteusNodeTest, TorqueStaysWithinTheCommandsMostAndThePeak) {
  come_up();
  for (double most : {2.0, 50.0, kNan}) {
    const double limit = most == 2.0 ? 2.0 : 10.0;
    for (double wanted : {1e3, -1e3, HUGE_VAL, 3e38}) {
      command(kNan, 0.0, 0.0, wanted, most);
      const double torque = torque_at(0.3, 1.0);
      EXPECT_LE(std::abs(torque), limit);
      EXPECT_FALSE(std::isnan(torque));
    }
    command(1e30, 1.0, 1.0, 0.0, most);
    EXPECT_EQ(torque_at(0.3, 1.0), limit);
  }
}

TEST_F(MoteusNodeTest, TheWatchdogLatchesAndBrakes) {
  come_up(1.0);
  advance(16 * kMs + kMs / 2);  // 19.5 ms since the command
  EXPECT_EQ(node_.mode(), Mode::kPosition);
  advance(kMs);
  EXPECT_EQ(node_.mode(), Mode::kTimeout);
  EXPECT_NEAR(torque_at(0.5, 0.5 * kTurn), -2.0, 1e-9);  // kd 4 N m per turn/s
  EXPECT_EQ(torque_at(0.5, 100.0 * kTurn), -5.0);
  command(kNan, 0.0, 0.0, 1.0);
  EXPECT_EQ(node_.mode(), Mode::kTimeout);
  send("010000");
  EXPECT_EQ(node_.mode(), Mode::kStopped);
  come_up(1.0);
  EXPECT_EQ(torque_at(0.0, 0.0), 1.0);
}

TEST_F(MoteusNodeTest, QueriesDoNotFeedTheWatchdog) {
  come_up();
  for (int i = 0; i < 18; ++i) {
    advance(kMs);
    send("1100");
  }
  EXPECT_EQ(node_.mode(), Mode::kTimeout);
}

TEST_F(MoteusNodeTest, WatchdogZeroIsTheConfiguredAndNanNone) {
  command(kNan, 0.0, 0.0, 0.0, 8.0, 0.0);
  advance(100 * kMs);
  EXPECT_EQ(node_.mode(), Mode::kPosition);
  advance(kMs);
  EXPECT_EQ(node_.mode(), Mode::kTimeout);
  send("010000");
  command(kNan, 0.0, 0.0, 0.0, 8.0, kNan);
  advance(3600'000 * kMs);
  EXPECT_EQ(node_.mode(), Mode::kPosition);
}

TEST_F(MoteusNodeTest, TimeOutWithoutReactionLetsGo) {
  JointConfig joint = servo4();
  joint.drive.watchdog_reaction = NodeWatchdogReaction::kOff;
  node_ = MoteusNode(joint);
  come_up(1.0);
  advance(30 * kMs);
  EXPECT_EQ(node_.mode(), Mode::kTimeout);
  EXPECT_EQ(torque_at(0.5, 10.0), 0.0);
}

TEST_F(MoteusNodeTest, SignAndOffset) {
  JointConfig joint = servo4();
  joint.drive.sign = -1.0;
  joint.drive.offset_rad = 0.25 * kTurn;
  node_ = MoteusNode(joint);
  joint_ = {0.05 * kTurn, 0.5 * kTurn, 0.05 * kTurn, 0.5 * kTurn, 1.5};
  EXPECT_NEAR(read(Register::kPosition), 0.2, 1.1e-5);
  EXPECT_NEAR(read(Register::kVelocity), -0.5, 1.1e-5);
  EXPECT_NEAR(read(Register::kTorque), -1.5, 1.1e-3);
  come_up();
  command(0.2, 1.0, 0.0, 0.5);
  // 0.01 turns further on the joint is 0.01 back at the drive: +0.4 there, -0.4 here.
  EXPECT_NEAR(torque_at(0.06 * kTurn, 0.0), -0.4 - 0.5, 1e-5);
}

TEST_F(MoteusNodeTest, EncoderFloorsToItsBits) {
  for (int bits : {8, 14, 24, 32}) {
    JointConfig joint = servo4();
    joint.drive.counts_per_turn = std::exp2(bits);
    node_ = MoteusNode(joint);
    const double count = std::ldexp(1.0, -bits);
    for (double turns : {0.3, -0.3, 0.123456}) {
      joint_.theta = turns * kTurn;
      moteus::State state;
      send(moteus::encode_state_request(kToServo4));
      ASSERT_TRUE(moteus::decode_state(reply_, &state));
      const double rounding = 2e-8;  // of float32
      EXPECT_LE(state.position_turns, turns + rounding);
      EXPECT_GE(state.position_turns, turns - count - rounding);
    }
  }
}

TEST_F(MoteusNodeTest, SetOutputMovesTheZero) {
  joint_.theta = 0.3 * kTurn;
  send(std::string("0EB00202") + "00000040");  // no such thing as two values at the end: refused
  EXPECT_NEAR(read(Register::kPosition), 0.3, 1.1e-5);
  send("0DB10200000040");  // exactly 2 turns
  EXPECT_NEAR(read(Register::kPosition), 2.0, 1.1e-5);
  send("0DB00200000000");  // whole turns only, as near to 0 as it gets
  EXPECT_NEAR(read(Register::kPosition), 0.0, 1.1e-5);
  come_up();
  command(0.1, 1.0, 0.0, 0.0);
  EXPECT_NEAR(torque_at(0.3 * kTurn, 0.0), 4.0, 1e-5);
}

TEST_F(MoteusNodeTest, DriveErrorLatchesItsFault) {
  come_up(1.0);
  node_.inject(scenario_event_t::FAULT_DRIVE_ERROR, joint_, now_ + 10 * kMs);
  EXPECT_EQ(node_.mode(), Mode::kFault);
  EXPECT_EQ(read(Register::kFault), 33.0);
  EXPECT_EQ(torque_at(1.0, 1.0), 0.0);
  send("010000");
  EXPECT_EQ(node_.mode(), Mode::kFault);
  advance(11 * kMs);
  EXPECT_EQ(node_.mode(), Mode::kFault);
  send("010000");
  EXPECT_EQ(node_.mode(), Mode::kStopped);
  EXPECT_EQ(read(Register::kFault), 0.0);
}

TEST_F(MoteusNodeTest, OtherFaults) {
  come_up(1.0);
  node_.inject(scenario_event_t::FAULT_SILENT, joint_, now_ + 5 * kMs);
  command(kNan, 0.0, 0.0, 2.0);
  EXPECT_EQ(send("1100"), "none");
  EXPECT_EQ(torque_at(0.0, 0.0), 2.0);
  advance(6 * kMs);
  EXPECT_EQ(send("1100"), "21000A");

  node_.inject(scenario_event_t::FAULT_FROZEN_ENCODER, joint_, now_ + 5 * kMs);
  joint_ = {0.1 * kTurn, 1.0, 0.1 * kTurn, 1.0, 0.0};
  EXPECT_EQ(read(Register::kPosition), 0.0);
  EXPECT_EQ(read(Register::kVelocity), 0.0);
  command(0.01, 1.0, 1.0, 0.0);
  EXPECT_NEAR(torque_at(joint_.theta, joint_.theta_dot), 0.4, 1e-6);
  advance(6 * kMs);
  EXPECT_NEAR(read(Register::kPosition), 0.1, 1.1e-5);

  command(kNan, 0.0, 0.0, 1.0);
  node_.inject(scenario_event_t::FAULT_DROP_COMMANDS, joint_, now_ + 30 * kMs);
  for (int i = 0; i < 20; ++i) {
    command(kNan, 0.0, 0.0, 3.0);
    EXPECT_EQ(torque_at(0.0, 0.0), 1.0);
    EXPECT_EQ(send("1100"), "21000A");
    advance(kMs);
  }
  advance(kMs);
  EXPECT_EQ(node_.mode(), Mode::kTimeout);
  node_.clear_faults();
  send("010000");
  EXPECT_EQ(node_.mode(), Mode::kStopped);
}

}  // namespace
}  // namespace limber::sim::test_moteus_node
