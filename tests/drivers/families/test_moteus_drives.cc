// An arm of moteus drives: dialogues, commands and faults, against drives that read and write the
// bytes themselves.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <numbers>

#include "drivers/drive/joint_link.h"
#include "robots/loader/protocols/drive_protocol.h"
#include "tests/drivers/fake_arm.h"

namespace limber::test_moteus_drives {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr int kStopped = 0, kPosition = 10, kTimeout = 11;
constexpr double kFloat = 1e-6;  // relative

float float_at(const CanFrame& frame, std::size_t at) {
  float value = 0.0F;
  std::memcpy(&value, &frame.data[at], 4);
  return value;
}
void put_float(CanFrame* frame, std::size_t at, double value) {
  const auto narrow = static_cast<float>(value);
  std::memcpy(&frame->data[at], &narrow, 4);
}

/// A command frame, by the offsets of its fields.
struct RawCommand {
  explicit RawCommand(const CanFrame& f)
      : position(float_at(f, 6)),
        velocity(float_at(f, 10)),
        torque(float_at(f, 14)),
        kp_scale(float_at(f, 18)),
        kd_scale(float_at(f, 22)),
        max_torque(float_at(f, 26)),
        watchdog(float_at(f, 32)) {}
  float position, velocity, torque, kp_scale, kd_scale, max_torque, watchdog;
};

bool is_command(const CanFrame& f) {
  return f.data[0] == 0x01 && f.data[2] == kPosition && f.data[3] == 0x0C && f.data[5] == 0x20;
}
bool is_stop(const CanFrame& f) {
  return f.data[0] == 0x01 && f.data[1] == 0x00 && f.data[2] == kStopped;
}
bool is_request(const CanFrame& f) { return f.data[0] == 0x11 && f.data[1] == 0x00; }

/// One moteus-like drive: takes two frames to come up, answers with the state before the frame.
struct FakeMoteus {
  explicit FakeMoteus(const DriveConfig& config) : drive(config) {}

  bool handle(const CanFrame& frame, CanFrame* reply) {
    if (!frame.extended || frame.id != drive.command_id) return false;
    frames.push_back(frame);
    *reply = {};
    reply->id = drive.reply_id;
    reply->extended = reply->id > 0x7FF;
    reply->fd = reply->bitrate_switch = true;
    if (frame.data[0] == 0x19) {
      answer_register(frame, reply);
    } else if (frame.data[0] == 0x40 || frame.data[0] == 0x42) {
      if (speaks) answer_text(frame, reply);
    } else {
      write_state(reply);
      obey(frame);
    }
    return !silent;
  }

  void answer_register(const CanFrame& frame, CanFrame* reply) const {
    const bool map = frame.data[1] == 0x82;
    const std::array<std::uint8_t, 7> bytes =
        map ? std::array<std::uint8_t, 7>{0x29, 0x82, 0x02, register_map, 0, 0, 0}
            : std::array<std::uint8_t, 7>{0x29, 0x0C, home_state, 0, 0, 0, 0x50};
    std::copy(bytes.begin(), bytes.end(), reply->data.begin());
    reply->length = 7;
  }
  /// Text said before goes out; a question is answered from the next frame but `delay` on.
  void answer_text(const CanFrame& frame, CanFrame* reply) {
    const bool ready = waited++ >= delay;
    const std::size_t most =
        frame.data[0] == 0x42 ? std::min<std::size_t>(frame.data[2], piece) : 48;
    const std::string said = ready ? text.substr(0, most) : "";
    text.erase(0, said.size());
    reply->data = {0x41, 0x01, static_cast<std::uint8_t>(said.size())};
    std::copy(said.begin(), said.end(), reply->data.begin() + 3);
    reply->length = static_cast<std::uint8_t>(fd_length(3 + static_cast<int>(said.size())));
    if (frame.data[0] == 0x42) return;
    const std::string line(frame.data.begin() + 3, frame.data.begin() + 3 + frame.data[2]);
    lines.push_back(line);
    waited = 0;
    if (line == "tel stop\n") text += "OK\r\n";
    if (line.starts_with("conf get ")) {
      const auto found = settings.find(line.substr(9, line.size() - 10));
      text += found == settings.end() ? "ERR error reading\r\n" : found->second + "\r\n";
    }
  }
  void write_state(CanFrame* reply) const {
    reply->length = 32;
    reply->data.fill(0x50);
    reply->data[0] = 0x21;
    reply->data[1] = 0x00;
    reply->data[2] = static_cast<std::uint8_t>(mode);
    reply->data[3] = 0x2C;
    reply->data[4] = 0x04;
    reply->data[5] = 0x01;
    put_float(reply, 6, turns);
    put_float(reply, 10, turns_per_s);
    put_float(reply, 14, torque);
    put_float(reply, 18, current);
    reply->data[22] = 0x22;
    reply->data[23] = 0x0E;
    reply->data[24] = 41;
    reply->data[25] = 0;
  }
  void obey(const CanFrame& frame) {
    if (is_stop(frame)) mode = kStopped;
    if (is_command(frame) && (mode == kStopped || mode == 2 || mode == 4)) {
      mode = !obedient ? mode : mode == kStopped ? 2 : mode == 2 ? 4 : kPosition;
    }
  }
  RawCommand last() const { return RawCommand(frames.back()); }

  DriveConfig drive;
  std::vector<CanFrame> frames;
  int mode = kStopped;
  double turns = 0.0, turns_per_s = 0.0, torque = 0.0, current = 0.0;
  std::uint8_t register_map = 5, home_state = 2;
  bool silent = false;
  bool obedient = true;
  bool speaks = true;  // has a diagnostic channel
  std::map<std::string, std::string> settings = {{"servo.pid_position.kp", "200.000000"},
                                                 {"servo.pid_position.ki", "0.000000"},
                                                 {"servo.pid_position.kd", "20.000000"},
                                                 {"servopos.position_min", "nan"},
                                                 {"servopos.position_max", "nan"}};
  std::string text;  // not heard yet
  std::vector<std::string> lines;
  std::size_t piece = 64;  // of text in an answer, at most
  int delay = 0, waited = 0;
};

/// Joint i has servo id first_id + i; the second counts the other way round, with its zero
/// elsewhere. kp 200 and kd 20 N m per turn.
Robot moteus_robot(std::uint32_t first_id = 1) {
  Robot robot;
  robot.name = "test";
  robot.has_drives = true;
  robot.buses.push_back({"arm", "virtual:test", true, 1'000'000, 5'000'000});
  for (std::uint32_t i = 0; i < 2; ++i) {
    constexpr double kNoEnd = std::numeric_limits<double>::infinity();
    JointConfig joint;
    joint.name = "joint" + std::to_string(i + 1);
    joint.position_min = -2.0;
    joint.position_max = 2.0;
    joint.velocity_limit = 5.0;
    joint.torque_limit_Nm = 8.0;
    joint.torque_rate_limit_Nm_per_s = 8000.0;
    joint.drive.protocol = &protocol_named("moteus");
    joint.drive.command_id = 0x8000 + first_id + i;
    joint.drive.reply_id = (first_id + i) * 256;
    joint.drive.frames = {48, {32}};
    joint.drive.sign = i == 0 ? 1.0 : -1.0;
    joint.drive.offset_rad = i == 0 ? 0.0 : 0.3;
    joint.drive.range = {kNoEnd, kNoEnd, kNoEnd, 200.0 / kTurn, 20.0 / kTurn};
    joint.drive.counts_per_turn = 1 << 20;
    joint.drive.hold_kp_Nm_per_rad = 100.0 / kTurn;
    joint.drive.hold_kd_Nms_per_rad = 5.0 / kTurn;
    robot.joints.push_back(joint);
  }
  return robot;
}

class MoteusArm : public testing::DrivenArm {
 public:
  explicit MoteusArm(const Robot& from = moteus_robot()) : DrivenArm(from) {
    for (const JointConfig& joint : robot.joints) motors.emplace_back(joint.drive);
  }

  void answer() override {
    CanFrame frame;
    CanFrame reply;
    while (motor_ends[0]->receive(std::span(&frame, 1)) == 1) {
      for (FakeMoteus& motor : motors) {
        if (motor.handle(frame, &reply)) motor_ends[0]->send(reply);
      }
    }
  }

  std::vector<FakeMoteus> motors;
};

TEST(MoteusStartUp, StopThenQuestionsThenPolling) {
  MoteusArm arm;
  for (int i = 0; i < 16; ++i) arm.half_cycle();
  EXPECT_EQ(arm.state->drive_state, int{joint_state_t::DRIVE_OFF});
  const std::vector<CanFrame>& f = arm.motors[1].frames;
  ASSERT_EQ(f.size(), 16U);
  EXPECT_TRUE(is_stop(f[0]));
  EXPECT_EQ(f[1].length, 3);
  EXPECT_EQ(f[1].data[1], 0x82);  // 0x102, register map
  EXPECT_EQ(f[2].length, 2);
  EXPECT_EQ(f[2].data[1], 0x0C);  // home state
  const std::array<std::uint8_t, 12> stop = {0x40, 0x01, 0x09, 't', 'e', 'l',
                                             ' ',  's',  't',  'o', 'p', '\n'};
  EXPECT_EQ(f[3].length, 12);
  EXPECT_TRUE(std::equal(stop.begin(), stop.end(), f[3].data.begin()));
  EXPECT_EQ(f[4].length, 3);
  EXPECT_EQ(f[4].data[0], 0x42);
  EXPECT_EQ(f[4].data[1], 0x01);
  EXPECT_EQ(f[4].data[2], 29);
  EXPECT_EQ(f[5].length, 48);
  EXPECT_EQ(f[5].data[2], 31);
  EXPECT_EQ(f[5].data[3 + 31], 0x50);
  EXPECT_TRUE(is_request(f[15]));
  for (const CanFrame& frame : f) {
    EXPECT_EQ(frame.id, 0x8002U);
    EXPECT_TRUE(frame.fd && frame.bitrate_switch && frame.extended);
  }
  EXPECT_EQ(arm.motors[1].lines,
            (std::vector<std::string>{
                "tel stop\n", "conf get servo.pid_position.kp\n",
                "conf get servo.pid_position.ki\n", "conf get servo.pid_position.kd\n",
                "conf get servopos.position_min\n", "conf get servopos.position_max\n"}));
}

std::string problem_with(const std::string& name, const std::string& value) {
  MoteusArm arm;
  arm.motors[1].settings[name] = value;
  for (int i = 0; i < 40; ++i) arm.half_cycle();
  if (arm.state->drive_state == joint_state_t::DRIVE_OFF) return "";
  EXPECT_EQ(arm.state->fault, int{joint_state_t::FAULT_CONFIGURATION});
  return arm.driver->configuration_problem();
}

TEST(MoteusSettings, OtherGainsThanRobotYamlsAreRefused) {
  EXPECT_EQ(problem_with("servo.pid_position.kp", "200.010000"), "");  // 0.1 thousandths are near
  EXPECT_NE(problem_with("servo.pid_position.kp", "4.000000")
                .find("servo.pid_position.kp is 4, expected 200"),
            std::string::npos);
  EXPECT_NE(problem_with("servo.pid_position.kd", "20.010000")
                .find("servo.pid_position.kd is 20.01, expected 20"),
            std::string::npos);
  EXPECT_NE(problem_with("servo.pid_position.ki", "0.100000").find("ki is 0.1, expected 0"),
            std::string::npos);
  EXPECT_NE(problem_with("servo.pid_position.kp", "nan").find("kp is nan"), std::string::npos);
}

// Joint 2 counts the other way round: -2 to 2 rad are (0.3 -+ 2) rad of the drive, -0.270563 to
// 0.366056 turns.
TEST(MoteusSettings, TheDrivesRangeHoldsTheJoints) {
  EXPECT_EQ(problem_with("servopos.position_min", "-0.270564"), "");
  EXPECT_NE(problem_with("servopos.position_min", "-0.270000")
                .find("servopos.position_min is -0.27, expected -0.270563 or beyond"),
            std::string::npos);
  EXPECT_EQ(problem_with("servopos.position_max", "0.366057"), "");
  EXPECT_NE(problem_with("servopos.position_max", "0.010000").find("position_max is 0.01"),
            std::string::npos);
}

TEST(MoteusSettings, AJointWithoutEndsNeedsADriveWithout) {
  Robot robot = moteus_robot();
  robot.joints[1].position_min = -HUGE_VAL;
  robot.joints[1].position_max = HUGE_VAL;
  for (const char* end : {"nan", "5000.000000"}) {
    MoteusArm arm(robot);
    arm.motors[1].settings["servopos.position_max"] = end;
    for (int i = 0; i < 40; ++i) arm.half_cycle();
    EXPECT_EQ(arm.state->drive_state == joint_state_t::DRIVE_OFF, std::string(end) == "nan");
  }
}

// limit_temperature_degC has to act before the drive's own fault.
TEST(MoteusSettings, TheDrivesOwnTemperatureLimitIsAbove) {
  Robot robot = moteus_robot();
  robot.joints[1].drive.limit_temperature_degC = 65.0;
  for (const char* own : {"75.000000", "65.000000", "60.000000", "nan"}) {
    MoteusArm arm(robot);
    arm.motors[1].settings["servo.fault_temperature"] = own;
    for (int i = 0; i < 40; ++i) arm.half_cycle();
    EXPECT_EQ(arm.motors[1].lines.back(), "conf get servo.fault_temperature\n");
    EXPECT_EQ(arm.motors[0].lines.back(), "conf get servopos.position_max\n") << "has no limit";
    const bool right = std::string(own).starts_with("7") || std::string(own) == "nan";
    EXPECT_EQ(arm.state->drive_state == joint_state_t::DRIVE_OFF, right) << own;
    if (std::string(own).starts_with("60")) {
      EXPECT_EQ(arm.driver->configuration_problem(),
                "joint2 (servo 2): servo.fault_temperature is 60, expected more than 65: the drive "
                "would let go before limit_temperature_degC stops the arm");
    }
  }
}

TEST(MoteusSettings, TextComesInPiecesLateAndBehindOtherText) {
  MoteusArm arm;
  arm.motors[0].text = std::string("emit servo_stats\r\n\x07\x00\n\x00binary", 27);
  arm.motors[0].piece = 7;
  arm.motors[1].delay = 9;
  for (int i = 0; i < 120; ++i) arm.half_cycle();
  EXPECT_EQ(arm.state->drive_state, int{joint_state_t::DRIVE_OFF})
      << arm.driver->configuration_problem();
}

TEST(MoteusSettings, WhatCannotBeReadIsAWarning) {
  MoteusArm arm;
  arm.motors[0].settings.erase("servopos.position_max");
  arm.motors[1].speaks = false;
  for (int i = 0; i < 40; ++i) arm.half_cycle();
  EXPECT_EQ(arm.state->drive_state, int{joint_state_t::DRIVE_OFF});
  std::string warnings;
  for (const std::string& warning : arm.driver->configuration_warnings()) warnings += warning;
  EXPECT_NE(warnings.find("servopos.position_max cannot be read"), std::string::npos) << warnings;
  EXPECT_NE(warnings.find("no diagnostic channel"), std::string::npos) << warnings;
}

TEST(MoteusSettings, ADriveThatNeverAnswersALineIsRefused) {
  MoteusArm arm;
  arm.motors[1].delay = 1000;
  for (int i = 0; i < 60; ++i) arm.half_cycle();
  EXPECT_EQ(arm.state->fault, int{joint_state_t::FAULT_CONFIGURATION});
  EXPECT_NE(arm.driver->configuration_problem().find("tel stop not answered"), std::string::npos)
      << arm.driver->configuration_problem();
}

TEST(MoteusStartUp, UnknownRegisterMapIsRefused) {
  MoteusArm arm;
  arm.motors[1].register_map = 4;
  for (int i = 0; i < 10; ++i) arm.half_cycle();
  EXPECT_EQ(arm.state->drive_state, int{joint_state_t::DRIVE_FAULT});
  EXPECT_EQ(arm.state->fault, int{joint_state_t::FAULT_CONFIGURATION});
  EXPECT_EQ(arm.state->fault_joint, 1);
  const std::string problem = arm.driver->configuration_problem();
  EXPECT_NE(problem.find("joint2 (servo 2): register map (register 102h) is 4, expected 5"),
            std::string::npos)
      << problem;
  EXPECT_TRUE(is_stop(arm.motors[0].frames.back()));
}

// Behind a gear, an angle that is known up to a turn of the rotor is not known.
TEST(MoteusStartUp, ADriveThatDoesNotKnowWhereItIsIsRefused) {
  for (double gear : {1.0, 9.0}) {
    for (int home : {0, 1, 2, 3}) {
      Robot robot = moteus_robot();
      robot.joints[0].drive.gear_ratio = gear;
      MoteusArm arm(robot);
      arm.motors[0].home_state = static_cast<std::uint8_t>(home);
      for (int i = 0; i < 20; ++i) arm.half_cycle();
      const bool known = home == 2 || (home == 1 && gear == 1.0);
      EXPECT_EQ(arm.state->drive_state == joint_state_t::DRIVE_OFF, known) << gear << " " << home;
    }
  }
}

TEST(MoteusEnable, ComesUpThroughItsModesWithoutTorque) {
  MoteusArm arm;
  ASSERT_TRUE(arm.switch_on());
  for (const FakeMoteus& motor : arm.motors) {
    EXPECT_EQ(motor.mode, kPosition);
    for (const CanFrame& frame : motor.frames) {
      EXPECT_TRUE(!is_command(frame) || RawCommand(frame).torque == 0.0F);
    }
  }
}

TEST(MoteusEnable, AnErrorIsClearedByAStopFirst) {
  for (int mode : {1, kTimeout, 12}) {
    MoteusArm arm;
    ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_OFF, joint_command_t::REQUEST_KEEP));
    arm.motors[0].mode = mode;
    EXPECT_TRUE(arm.run_until(joint_state_t::DRIVE_ON, joint_command_t::REQUEST_ON)) << mode;
  }
}

TEST(MoteusEnable, ADriveThatStaysOffIsAFault) {
  MoteusArm arm;
  arm.motors[1].obedient = false;
  EXPECT_FALSE(arm.switch_on());
  EXPECT_EQ(arm.state->fault, int{joint_state_t::FAULT_DRIVE_ERROR});
  EXPECT_EQ(arm.state->fault_joint, 1);
}

TEST(MoteusTorque, GoesOutAloneWithItsLimitAndWatchdog) {
  MoteusArm arm;
  ASSERT_TRUE(arm.switch_on());
  arm.command.tau[0] = 1.25;
  arm.command.tau[1] = 2.5;
  ASSERT_EQ(arm.cycle_with(joint_command_t::REQUEST_ON), int{driver_status_t::VERDICT_ACCEPTED});
  arm.half_cycle();
  for (std::size_t i = 0; i < 2; ++i) {
    const RawCommand sent = arm.motors[i].last();
    EXPECT_TRUE(std::isnan(sent.position));
    EXPECT_EQ(sent.velocity, 0.0F);
    EXPECT_EQ(sent.torque, i == 0 ? 1.25F : -2.5F);
    EXPECT_EQ(sent.kp_scale, 0.0F);
    EXPECT_EQ(sent.kd_scale, 0.0F);
    EXPECT_EQ(sent.max_torque, 8.0F);
    EXPECT_EQ(sent.watchdog, 0.02F);
    EXPECT_EQ(arm.motors[i].frames.back().length, arm.robot.joints[i].drive.frames.command);
  }
  EXPECT_EQ(arm.state->tau_applied[0], 1.25);
  EXPECT_EQ(arm.state->tau_applied[1], 2.5);
}

TEST(MoteusState, SignsOffsetsAndUnits) {
  MoteusArm arm;
  for (FakeMoteus& motor : arm.motors) {
    motor.turns = 0.1;
    motor.turns_per_s = -0.2;
    motor.torque = 1.5;
    motor.current = 3.0;
  }
  ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_OFF, joint_command_t::REQUEST_KEEP));
  arm.half_cycle();
  EXPECT_NEAR(arm.state->q[0], 0.1 * kTurn, kFloat);
  EXPECT_NEAR(arm.state->v[0], -0.2 * kTurn, kFloat);
  EXPECT_EQ(arm.state->tau[0], 1.5);
  EXPECT_EQ(arm.state->current_A[0], 3.0F);
  EXPECT_NEAR(arm.state->q[1], -(0.1 * kTurn - 0.3), kFloat);
  EXPECT_NEAR(arm.state->v[1], 0.2 * kTurn, kFloat);
  EXPECT_EQ(arm.state->tau[1], -1.5);
  EXPECT_EQ(arm.state->current_A[1], -3.0F);
  EXPECT_EQ(arm.state->temperature_degC[0], 41.0F);
}

TEST(MoteusState, IdsFrom8OnAnswerWith29Bits) {
  MoteusArm arm(moteus_robot(8));
  EXPECT_TRUE(arm.switch_on());
}

TEST(MoteusState, NothingButNumbersIsPublished) {
  MoteusArm arm;
  ASSERT_TRUE(arm.switch_on());
  arm.motors[0].torque = std::nan("");
  arm.half_cycle();
  EXPECT_EQ(arm.state->tau[0], 0.0);
  EXPECT_EQ(arm.state->age_cycles[0], 1);
  EXPECT_EQ(arm.read_status().replies_invalid[0], 1);
}

TEST(MoteusHold, DampsFirstAndThenHoldsWhereTheJointIs) {
  MoteusArm arm;
  ASSERT_TRUE(arm.switch_on());
  arm.motors[1].turns = 0.0005;  // within what a joint can do in a cycle
  arm.cycle_with(joint_command_t::REQUEST_HOLD);
  arm.half_cycle();
  ASSERT_EQ(arm.state->drive_state, int{joint_state_t::DRIVE_HOLD});
  // 5 of 20 N m per turn/s, and no spring.
  EXPECT_NEAR(arm.motors[1].last().kd_scale, 0.25, kFloat);
  EXPECT_EQ(arm.motors[1].last().kp_scale, 0.0F);
  EXPECT_TRUE(std::isnan(arm.motors[1].last().position));
  for (int i = 0; i < 110; ++i) arm.cycle_with(joint_command_t::REQUEST_HOLD);
  EXPECT_NEAR(arm.motors[1].last().kd_scale, 0.25, kFloat);
  EXPECT_NEAR(arm.motors[1].last().kp_scale, 0.5, kFloat);  // 100 of 200
  EXPECT_NEAR(arm.motors[1].last().position, 0.0005, 1e-9);
  // What the drive exerts is told: 0.0001 turns too far on are -0.01 N m at the drive.
  arm.motors[1].turns = 0.0006;
  arm.half_cycle();
  EXPECT_NEAR(arm.state->tau_applied[1], 0.01, 1e-6);
}

TEST(MoteusFaults, ATimeOutIsADriveErrorAndNeedsAcknowledging) {
  for (int mode : {kTimeout, 1}) {
    MoteusArm arm;
    ASSERT_TRUE(arm.switch_on());
    arm.motors[0].mode = mode;
    arm.cycle_with(joint_command_t::REQUEST_ON);
    EXPECT_EQ(arm.state->drive_state, int{joint_state_t::DRIVE_HOLD});
    EXPECT_EQ(arm.state->fault, int{joint_state_t::FAULT_DRIVE_ERROR});
    EXPECT_NE(arm.state->joint_flags[0] & joint_state_t::JOINT_DRIVE_ERROR, 0);
    arm.cycle_with(joint_command_t::REQUEST_KEEP);
    EXPECT_TRUE(is_request(arm.motors[0].frames.back()));  // not spoken to as if it obeyed
    EXPECT_TRUE(is_command(arm.motors[1].frames.back()));  // the others hold
    ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_OFF, joint_command_t::REQUEST_OFF));
    EXPECT_TRUE(arm.run_until(joint_state_t::DRIVE_ON, joint_command_t::REQUEST_ON)) << mode;
  }
}

// Somebody else's mode: voltage, current, zero velocity, stay within, brake.
TEST(MoteusFaults, AnyModeButPositionIsADriveError) {
  for (int mode : {0, 6, 9, 12, 13, 15}) {
    MoteusArm arm;
    ASSERT_TRUE(arm.switch_on());
    arm.motors[0].mode = mode;
    arm.cycle_with(joint_command_t::REQUEST_ON);
    EXPECT_EQ(arm.state->fault, int{joint_state_t::FAULT_DRIVE_ERROR}) << mode;
  }
}

// Host 0 with its own identifier, host 1, a 11-bit identifier, all drives; not another drive, nor
// a reply, nor another prefix.
TEST(MoteusFaults, FramesOfSomebodyElseForADriveAreForeign) {
  const auto fault_of = [](std::uint32_t id, bool extended) {
    MoteusArm arm;
    EXPECT_TRUE(arm.switch_on());
    CanFrame frame;
    frame.id = id;
    frame.extended = extended;
    frame.fd = true;
    arm.motor_ends[0]->send(frame);
    arm.cycle_with(joint_command_t::REQUEST_KEEP);
    return arm.state->fault;
  };
  const std::uint32_t node = MoteusArm().robot.joints[0].drive.command_id & 0x7F;
  for (std::uint32_t id : {0x8000 | node, 0x8100 | node, 0x0100 | node, std::uint32_t{0x807F}})
    EXPECT_EQ(fault_of(id, true), int{joint_state_t::FAULT_FOREIGN_COMMAND}) << id;
  EXPECT_EQ(fault_of(node, false), int{joint_state_t::FAULT_FOREIGN_COMMAND});
  for (std::uint32_t id : {std::uint32_t{0x8063}, std::uint32_t{0x6300}, 0x18000 | node})
    EXPECT_EQ(fault_of(id, true), int{joint_state_t::FAULT_NONE}) << id;
}

TEST(MoteusFaults, ShutDownStopsEveryDrive) {
  MoteusArm arm;
  ASSERT_TRUE(arm.switch_on());
  arm.driver->request_shut_down();
  for (int i = 0; i < 400 && !arm.driver->shut_down(); ++i) arm.half_cycle();
  EXPECT_TRUE(arm.driver->shut_down());
  for (const FakeMoteus& motor : arm.motors) EXPECT_EQ(motor.mode, kStopped);
}

TEST(MoteusLink, WhatIsNotFiniteBecomesAStateRequest) {
  for (double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    for (const JointCommand& command : {JointCommand{0, 0, 0, bad}, JointCommand{bad, 1, 1, 0},
                                        JointCommand{0, bad, 0, 0}, JointCommand{0, 0, bad, 0}}) {
      JointLink link(moteus_robot().joints[0], true, 1e-3, 2);
      EXPECT_TRUE(is_request(link.command(command)));
      EXPECT_EQ(RawCommand(link.torque(1.0)).torque, 1.0F);
    }
  }
}

TEST(MoteusLink, NoTorqueBeyondTheLimitAndNoGainBeyondTheDrives) {
  JointLink link(moteus_robot().joints[1], true, 1e-3, 2);
  for (double wanted : {8.0, 8.1, 1e9}) {
    EXPECT_EQ(RawCommand(link.torque(wanted)).torque, -8.0F);
    EXPECT_EQ(RawCommand(link.torque(-wanted)).torque, 8.0F);
  }
  const RawCommand stiff(link.command({0.5, 1e6, 1e6, 0.0}));
  EXPECT_EQ(stiff.kp_scale, 1.0F);
  EXPECT_EQ(stiff.kd_scale, 1.0F);
  EXPECT_NEAR(stiff.position, (-0.5 + 0.3) / kTurn, kFloat);
}

}  // namespace
}  // namespace limber::test_moteus_drives
