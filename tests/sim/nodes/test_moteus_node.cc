// The emulated moteus drive, byte by byte where bytes matter.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limber/scenario_event_t.hpp>
#include <numbers>
#include <string>

#include "drivers/protocols/moteus.h"
#include "robots/loader/protocols/drive_protocol.h"
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
  joint.drive.protocol = &protocol_named("moteus");
  joint.drive.command_id = kToServo4;
  joint.drive.reply_id = 0x400;
  joint.drive.counts_per_turn = std::exp2(32);
  joint.drive.peak_torque_Nm = 10.0;
  joint.drive.limit_temperature_degC = 65.0;
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
  EXPECT_EQ(send("0240010211001F01"), send("11001F01").substr(0, 34) + "30400130410150");  // last
  EXPECT_EQ(send("010101"), "300102");
  EXPECT_EQ(send("110060FF1100"), "210000");  // what follows the unknown opcode is lost
}

// What a mode other than those emulated would do is unknown: the drive lets go, and tells so.
TEST_F(MoteusNodeTest, ModesThatAreNotEmulatedAreAFault) {
  for (int mode : {1, 2, 5, 6, 7, 8, 9, 11, 13, 14}) {
    node_ = MoteusNode(servo4());
    come_up(1.0);
    CanFrame request = frame(kToServo4, "010000");
    request.data[2] = static_cast<std::uint8_t>(mode);
    send(request);
    EXPECT_EQ(node_.mode(), Mode::kFault) << mode;
    EXPECT_EQ(read(Register::kFault), 36.0);
    EXPECT_EQ(torque_at(1.0, 1.0), 0.0);
    send("010000");
    EXPECT_EQ(node_.mode(), Mode::kStopped);
  }
  EXPECT_EQ(send("010010"), "300001");  // 16: no such mode
  EXPECT_EQ(send("010080"), "300001");
  EXPECT_EQ(node_.mode(), Mode::kStopped);
}

TEST_F(MoteusNodeTest, ZeroVelocityDampsAndIsWatched) {
  send(
      "01000C"
      "0D24"
      "0000003F"
      "0D27"
      "0AD7A33C");  // kd scale 0.5, watchdog 20 ms
  advance(3 * kMs);
  EXPECT_EQ(node_.mode(), Mode::kZeroVelocity);
  EXPECT_NEAR(torque_at(2.0, 0.5 * kTurn), -1.0, 1e-9);  // 4 * 0.5 * 0.5
  EXPECT_EQ(torque_at(2.0, 100.0 * kTurn), -5.0);        // as after a time-out
  advance(18 * kMs);
  EXPECT_EQ(node_.mode(), Mode::kTimeout);
}

TEST_F(MoteusNodeTest, BrakeShortsThePhases) {
  JointConfig joint = servo4();
  joint.drive.short_circuit_damping_Nms = 0.4;
  node_ = MoteusNode(joint);
  send("01000F");
  advance(3 * kMs);
  EXPECT_EQ(node_.mode(), Mode::kBrake);
  EXPECT_EQ(node_.law().passive_damping, 0.4);
  EXPECT_EQ(torque_at(1.0, 1.0), 0.0);
  advance(500 * kMs);
  EXPECT_EQ(node_.mode(), Mode::kBrake);
}

// A quarter turn at 1 turn/s^2: half of it gaining, half of it losing speed, 0.5 s each, 0.5
// turns/s between.
TEST_F(MoteusNodeTest, AccelerationLimit) {
  come_up();
  send(
      "01000A"
      "0D20"
      "0000803E"
      "0D27"
      "0000C07F"
      "0D29"
      "0000803F");
  EXPECT_EQ(read(Register::kTrajectoryComplete), 0.0);
  const auto wanted = [this] { return node_.law().q_des / kTurn; };
  for (int ms = 0; ms < 250; ++ms) advance(kMs);
  EXPECT_NEAR(wanted(), 0.5 * 0.25 * 0.25, 1e-4);
  EXPECT_NEAR(node_.law().v_des / kTurn, 0.25, 1e-3);
  for (int ms = 250; ms < 500; ++ms) advance(kMs);
  EXPECT_NEAR(wanted(), 0.125, 1e-3);
  EXPECT_EQ(read(Register::kTrajectoryComplete), 0.0);
  for (int ms = 500; ms < 1010; ++ms) {
    advance(kMs);
    EXPECT_LE(wanted(), 0.25 + 1e-6);
  }
  EXPECT_EQ(read(Register::kTrajectoryComplete), 1.0);
  EXPECT_NEAR(wanted(), 0.25, 1e-7);
  EXPECT_EQ(node_.law().v_des, 0.0);
}

TEST_F(MoteusNodeTest, VelocityLimit) {
  come_up();
  send(
      "01000A"
      "0D20"
      "0000803E"
      "0D27"
      "0000C07F"
      "0D28"
      "0000003F");  // 0.25 turns at 0.5 a s
  for (int ms = 0; ms < 400; ++ms) advance(kMs);
  EXPECT_NEAR(node_.law().q_des / kTurn, 0.2, 1e-3);
  EXPECT_NEAR(node_.law().v_des / kTurn, 0.5, 1e-9);
  for (int ms = 400; ms < 502; ++ms) advance(kMs);
  EXPECT_EQ(read(Register::kTrajectoryComplete), 1.0);
  EXPECT_NEAR(node_.law().q_des / kTurn, 0.25, 1e-7);
}

TEST_F(MoteusNodeTest, WithoutLimitsATrajectoryIsCompleteAtOnce) {
  EXPECT_EQ(read(Register::kTrajectoryComplete), 0.0);  // stopped
  come_up();
  command(0.3, 1.0, 1.0, 0.0);
  EXPECT_EQ(read(Register::kTrajectoryComplete), 1.0);
}

TEST_F(MoteusNodeTest, APositionLeftOutKeepsTheSetpoint) {
  come_up();
  command(0.3, 1.0, 1.0, 0.0);
  command(kNan, 1.0, 1.0, 0.0);
  EXPECT_NEAR(torque_at(0.3 * kTurn - 0.01 * kTurn, 0.0), 0.4, 1e-6);
}

TEST_F(MoteusNodeTest, StopPositionsAreDeprecated) {
  come_up();
  send("01000A0D260000803E");
  EXPECT_EQ(read(Register::kFault), 45.0);
}

// --- the diagnostic channel ---

class MoteusTextTest : public MoteusNodeTest {
 protected:
  /// Sends a line without wanting an answer, as moteus_tool does.
  void tell(const std::string& line) {
    moteus::FrameWriter request(0x0004);
    request.text_to_drive(line + "\n");
    EXPECT_EQ(send(request.frame()), "none");
  }
  /// All that the drive has to say.
  std::string hear() {
    std::string all;
    for (std::string_view text = "?"; !text.empty(); all += text) {
      send(frame(kToServo4, "42013D"));
      if (!moteus::decode_text(reply_, &text)) return all + "no text";
    }
    return all.substr(0);
  }
  std::string ask(const std::string& line) {
    tell(line);
    return hear();
  }
};

TEST_F(MoteusTextTest, BytesOfAPoll) {
  EXPECT_EQ(send("42013D"), "410100");
  EXPECT_EQ(send(frame(0x0004, "400107642073746F700A5050")), "none");  // "d stop"
  EXPECT_EQ(send("42013D"), "4101044F4B0D0A");                         // "OK"
  EXPECT_EQ(send("42013D"), "410100");
  // A line that wants an answer gets what was said before it.
  EXPECT_EQ(send("4001096465720A3132330A78"), "410100");
  EXPECT_EQ(send("420103"), "410103455252");  // "ERR", of the first of two
  EXPECT_EQ(send("44010001"), "");            // flow control: not known
  EXPECT_EQ(send("42023D"), "");              // no such channel
  EXPECT_EQ(send("4001FF78"), "");            // shorter than it says
}

TEST_F(MoteusTextTest, SettingsByName) {
  EXPECT_EQ(ask("conf get servo.pid_position.kp"), "40.000000\r\n");
  EXPECT_EQ(ask("conf get servo.pid_position.kd"), "4.000000\r\n");
  EXPECT_EQ(ask("conf get servopos.position_min"), "nan\r\n");
  EXPECT_EQ(ask("conf get id.id"), "4\r\n");
  EXPECT_EQ(ask("conf get servo.fault_temperature"), "75.000000\r\n");
  EXPECT_EQ(ask("conf get servo.no_such"), "ERR error reading\r\n");
  EXPECT_EQ(ask("conf get no.such"), "ERR unknown group\r\n");
  EXPECT_EQ(ask("conf frobnicate"), "ERR unknown subcommand\r\n");
  EXPECT_EQ(ask("bla"), "ERR unknown command\r\n");
  EXPECT_EQ(ask("conf enumerate id"), "id.id 4\r\nOK\r\n");
  EXPECT_GT(ask("conf enumerate").size(), 300U);
}

TEST_F(MoteusTextTest, ASettingTakesEffectAndIsStored) {
  EXPECT_EQ(ask("conf set servo.pid_position.kp 80"), "OK\r\n");
  come_up();
  command(0.0, 1.0, 0.0, 0.0);
  EXPECT_NEAR(torque_at(-0.01 * kTurn, 0.0), 0.8, 1e-6);
  EXPECT_EQ(ask("conf load"), "OK\r\n");
  EXPECT_NEAR(torque_at(-0.01 * kTurn, 0.0), 0.4, 1e-6);
  for (const char* refused :
       {"servo.pid_position.kp -1", "servo.pid_position.kp nan", "servo.pid_position.kp 1x",
        "servo.pid_position.ki 2", "servo.pid_position.kp", "id.id 127", "id.id 1.5",
        "motor_position.rotor_to_output_ratio 2", "servo.timeout_mode 10"})
    EXPECT_EQ(ask("conf set " + std::string(refused)), "ERR error setting\r\n") << refused;
  ask("conf set servo.pid_position.kp 80");
  ask("conf write");
  ask("conf set servo.pid_position.kp 90");
  ask("conf load");
  EXPECT_EQ(ask("conf get servo.pid_position.kp"), "80.000000\r\n");
  ask("conf default");
  EXPECT_EQ(ask("conf get servo.pid_position.kp"), "40.000000\r\n");
}

TEST_F(MoteusTextTest, AnotherIdAtOnce) {
  EXPECT_EQ(ask("conf set id.id 9"), "no text");  // the answer waits at the new id
  EXPECT_EQ(send(frame(0x8009, "42013D")), "4101044F4B0D0A");
  EXPECT_EQ(reply_.id, 0x900U);
  EXPECT_EQ(send(frame(0x8004, "1100")), "none");
}

TEST_F(MoteusTextTest, PositionRange) {
  ask("conf set servopos.position_max 0.1");
  joint_.theta = 0.2 * kTurn;
  command(kNan, 0.0, 0.0, 0.0);
  advance(3 * kMs);
  EXPECT_EQ(node_.mode(), Mode::kFault);
  EXPECT_EQ(read(Register::kFault), 39.0);
  joint_.theta = 0.0;
  send("010000");
  come_up();
  command(0.5, 1.0, 0.0, 0.0);
  EXPECT_NEAR(node_.law().q_des / kTurn, 0.1, 1e-9);
}

TEST_F(MoteusTextTest, DebugCommands) {
  EXPECT_EQ(ask("d pos 0.1 0 2 p0.5 d0.5 f0.25"), "OK\r\n");
  advance(3 * kMs);
  EXPECT_NEAR(torque_at(0.1 * kTurn, 0.0), 0.25, 1e-9);
  EXPECT_EQ(node_.law().limit, 2.0);
  advance(10'000 * kMs);
  EXPECT_EQ(node_.mode(), Mode::kPosition);  // no watchdog
  EXPECT_EQ(ask("d pos 0.1 0"), "ERR missing p/v/i, or unknown option\r\n");
  EXPECT_EQ(ask("d pos 0.1 0 2 x1"), "ERR missing p/v/i, or unknown option\r\n");
  EXPECT_EQ(ask("d exact 3"), "OK\r\n");
  EXPECT_NEAR(read(Register::kPosition), 3.0, 1.1e-5);
  EXPECT_EQ(ask("d exact nan"), "ERR missing position\r\n");
  EXPECT_EQ(ask("d stop"), "OK\r\n");
  EXPECT_EQ(node_.mode(), Mode::kStopped);
  EXPECT_EQ(ask("d cal 1"), "ERR unknown command\r\n");
}

TEST_F(MoteusTextTest, Telemetry) {
  EXPECT_EQ(ask("tel stop"), "OK\r\n");
  EXPECT_EQ(ask("tel list"), "firmware\r\ngit\r\nservo_stats\r\nOK\r\n");
  EXPECT_EQ(ask("tel get nothing"), "ERR unknown name\r\n");
  EXPECT_EQ(ask("tel rate git 100"), "ERR unknown subcommand\r\n");
  const std::string firmware = ask("tel get firmware");
  EXPECT_EQ(firmware.substr(0, 19), std::string("emit firmware\r\n\x14\0\0\0", 19));
  EXPECT_EQ(firmware.size(), 19U + 20U);  // version, serial number, model: five of four bytes
  ask("tel fmt git 1");
  EXPECT_NE(ask("tel get git").find("git.dirty 0\r\n"), std::string::npos);
}

TEST_F(MoteusTextTest, NoLineIsTooLong) {
  for (int i = 0; i < 101; ++i) {
    moteus::FrameWriter request(kToServo4);
    request.text_to_drive(std::string(61, 'x'));
    send(request.frame());
  }
  hear();
  tell("conf get id.id");  // lost with the rest of that line
  EXPECT_EQ(ask("conf get id.id"), "4\r\n");
  for (int i = 0; i < 100; ++i) tell("conf enumerate");  // more than there is room for
  EXPECT_LE(hear().size(), 4096U);
  EXPECT_EQ(ask("conf get id.id"), "4\r\n");
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

// As the firmware has it; its manual holds the kd scale at the kp scale.
TEST_F(MoteusNodeTest, DampingIsIndependentOfTheSpring) {
  come_up();
  for (double kp : {0.0, 0.2, 0.5}) {
    command(0.0, kp, 0.3, 0.0);
    EXPECT_NEAR(torque_at(0.0, kTurn), -4.0 * 0.3, 1e-6) << kp;
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

TEST_F(MoteusNodeTest, AHotDriveReportsAKelvinMoreThanItsLimit) {
  EXPECT_EQ(read(Register::kTemperature), 30.0);
  node_.inject(scenario_event_t::FAULT_HOT, joint_, now_ + 5 * kMs);
  EXPECT_EQ(read(Register::kTemperature), 66.0);
  EXPECT_EQ(read(Register::kFault), 0.0);
  advance(6 * kMs);
  EXPECT_EQ(read(Register::kTemperature), 30.0);
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
