// A Damiao drive's family by itself: bytes of its frames, its states, and whose frames are whose.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>

#include "drivers/families/drive_family.h"
#include "robots/loader/protocols/drive_protocol.h"
#include "tests/support/frame_text.h"

namespace limber::test_damiao_family {
namespace {

using testing::parse;
using testing::text;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kTorqueCount = 20.0 / 4095.0;

/// Ids 001h and 011h; +-12.5 rad, +-30 rad/s, +-10 N m; 2 N m/A; a watchdog of 20 ms: 400 counts.
JointConfig joint(double torque_limit_Nm = 8.0) {
  JointConfig made;
  made.drive.protocol = &protocol_named("damiao_mit");
  made.torque_limit_Nm = torque_limit_Nm;
  made.drive.command_id = 0x001;
  made.drive.reply_id = 0x011;
  made.drive.torque_constant_Nm_per_A = 2.0;
  return made;
}

class DamiaoFamilyTest : public ::testing::Test {
 protected:
  void make(double torque_limit_Nm) {
    family_ = make_drive_family(joint(torque_limit_Nm), false, 1e-3);
  }
  /// The torque that the drive will understand.
  double sent(double torque_Nm) {
    CanFrame frame;
    DriveCommand sent;
    EXPECT_TRUE(family_.codec->command({.torque_Nm = torque_Nm}, {}, &frame, &sent));
    return sent.torque_Nm;
  }
  DriveReport read(const std::string& candump) {
    DriveReport report;
    EXPECT_EQ(family_.codec->read_state(parse(candump), false, &report), StateReading::kWhole);
    return report;
  }

  DriveFamily family_ = make_drive_family(joint(), false, 1e-3);
};

TEST_F(DamiaoFamilyTest, FramesWithoutTorque) {
  EXPECT_EQ(text(family_.codec->enable({})), "001#FFFFFFFFFFFFFFFC");
  EXPECT_EQ(text(family_.codec->disable()), "001#FFFFFFFFFFFFFFFD");
  EXPECT_EQ(text(family_.codec->clear_error()), "001#FFFFFFFFFFFFFFFB");
  EXPECT_TRUE(text(family_.startup->presence_request()).starts_with("7FF#0100330A"))
      << "register 10";
  EXPECT_TRUE(text(family_.codec->state_request()).starts_with("7FF#0100CC"));
}

TEST_F(DamiaoFamilyTest, AStateInSIUnits) {
  // Enabled; position, velocity and torque in the middle, less half a count; 30 and 35 degC.
  const DriveReport report = read("011#117FFF7FF7FF1E23");
  EXPECT_EQ(report.condition, DriveCondition::kEnabled);
  EXPECT_EQ(report.status, 1);
  EXPECT_NEAR(report.angle_rad, 0.0, 1e-12);
  EXPECT_NEAR(report.speed_rad_per_s, 0.0, 1e-12);
  EXPECT_NEAR(report.torque_Nm, 0.0, 1e-12);
  EXPECT_EQ(report.temperature_degC, 35.0);
  const DriveReport lowest = read("011#A100000000002814");
  EXPECT_EQ(lowest.condition, DriveCondition::kFailed);
  EXPECT_EQ(lowest.status, 10);
  EXPECT_NEAR(lowest.angle_rad, -12.5 + 12.5 / 65535.0, 1e-12);
  EXPECT_NEAR(lowest.link_angle_rad, lowest.angle_rad, 0.0) << "the same place";
  EXPECT_NEAR(lowest.speed_rad_per_s, -30.0 + 30.0 / 4095.0, 1e-12);
  EXPECT_NEAR(lowest.link_speed_rad_per_s, lowest.speed_rad_per_s, 0.0);
  EXPECT_NEAR(lowest.torque_Nm, -10.0 + 10.0 / 4095.0, 1e-12);
  EXPECT_NEAR(lowest.current_A, 0.5 * lowest.torque_Nm, 1e-12);
  EXPECT_EQ(lowest.temperature_degC, 40.0) << "the warmer one";
  EXPECT_EQ(read("011#017FFF7FF7FF1E23").condition, DriveCondition::kDisabled);
  DriveReport none;
  EXPECT_EQ(family_.codec->read_state(parse("011#127FFF7FF7FF1E23"), false, &none),
            StateReading::kNone)
      << "another drive's number";
  EXPECT_EQ(family_.codec->read_state(parse("011#117FFF"), false, &none), StateReading::kNone);
}

TEST_F(DamiaoFamilyTest, EveryErrorInWords) {
  const std::pair<int, const char*> texts[] = {
      {0x0, "disabled, without an error"},
      {0x1, "enabled"},
      {0x2, "error 2: not in the manual"},
      {0x8, "error 8: over-voltage; check the supply"},
      {0x9, "error 9: under-voltage; check the supply"},
      {0xA, "error A: over-current"},
      {0xB, "error B: power stage too hot; let it cool"},
      {0xC, "error C: motor too hot; let it cool"},
      {0xD, "error D: no command within the drive's time-out"},
      {0xE, "error E: overload"},
  };
  for (const auto& [status, words] : texts)
    EXPECT_EQ(family_.codec->status_text(static_cast<std::uint16_t>(status)), words);
}

// A count of 20 N m / 4095 is the most that rounding takes away, and nothing is added.
TEST_F(DamiaoFamilyTest, NoTorqueBeyondTheLimitAndAllUpToIt) {
  for (int i = 0; i < 10; ++i) {
    const double limit = 5.0 + 0.1 * i * kTorqueCount;
    make(limit);
    for (const double sign : {1.0, -1.0}) {
      for (int k = 0; k < 3; ++k) {
        const double most = sign * sent(sign * 50.0);
        EXPECT_LE(most, limit + 1e-12) << i;
        EXPECT_GT(most, limit - 1.001 * kTorqueCount) << i;
      }
    }
  }
  make(0.0);
  EXPECT_LE(std::abs(sent(5.0)), kTorqueCount);
}

TEST_F(DamiaoFamilyTest, RoundingIsMadeUpForUntilTheDriveIsTakenOff) {
  const double wanted = 1.0 + 0.3 * kTorqueCount;
  const double first = sent(wanted);
  double sum = first;
  for (int k = 1; k < 1000; ++k) sum += sent(wanted);
  EXPECT_NEAR(sum / 1000.0, wanted, 0.001 * kTorqueCount);
  for (int k = 0; k < 10; ++k) {
    sent(wanted + 0.37 * k * kTorqueCount);
    static_cast<void>(family_.codec->disable());
    EXPECT_EQ(sent(wanted), first) << "nothing is left of before";
    CanFrame frame;
    DriveCommand command{.torque_Nm = kNan};
    sent(wanted + 0.37 * k * kTorqueCount);
    EXPECT_FALSE(family_.codec->command(command, {}, &frame, &command));
    EXPECT_EQ(sent(wanted), first) << "nor after a command that was none";
  }
}

TEST_F(DamiaoFamilyTest, WhatIsNotFiniteIsNoCommand) {
  CanFrame frame;
  DriveCommand sent;
  ASSERT_TRUE(family_.codec->command({}, {}, &frame, &sent));
  for (double DriveCommand::*field :
       {&DriveCommand::angle_rad, &DriveCommand::speed_rad_per_s, &DriveCommand::kp_Nm_per_rad,
        &DriveCommand::kd_Nms_per_rad, &DriveCommand::torque_Nm}) {
    DriveCommand command;
    command.*field = kNan;
    EXPECT_FALSE(family_.codec->command(command, {}, &frame, &sent));
  }
}

TEST_F(DamiaoFamilyTest, CommandsAndSettingsOfOthersAreForeign) {
  const auto foreign = [this](const std::string& frame) {
    return family_.intruders->is_foreign_command(parse(frame));
  };
  EXPECT_TRUE(foreign("001#FFFFFFFFFFFFFFFC"));
  EXPECT_TRUE(foreign("7FF#0100550A02000000")) << "writes a register";
  EXPECT_TRUE(foreign("7FF#0100AA0102000000")) << "stores them";
  EXPECT_FALSE(foreign("7FF#0100330A00000000")) << "reads one";
  EXPECT_FALSE(foreign("7FF#0100560A02000000"));
  EXPECT_FALSE(foreign("7FF#0200550A02000000")) << "another drive's";
  EXPECT_FALSE(foreign("7FE#0100550A02000000"));
  EXPECT_FALSE(foreign("7FF#0100"));
  EXPECT_FALSE(foreign("002#FFFFFFFFFFFFFFFC"));
}

// As delivered, it answers with identifier 0.
TEST_F(DamiaoFamilyTest, AnswersWithAnotherIdAreAstray) {
  const auto astray = [this](const std::string& frame) {
    return family_.startup->has_wrong_reply_id(parse(frame));
  };
  EXPECT_TRUE(astray("000#0100330A01000000"));
  EXPECT_TRUE(astray("012#0100330A01000000"));
  EXPECT_FALSE(astray("011#0100330A01000000")) << "its own";
  EXPECT_FALSE(astray("7FF#0100330A01000000")) << "the driver's request";
  EXPECT_FALSE(astray("000#0200330A01000000")) << "another drive's";
  EXPECT_FALSE(astray("000#0100550A01000000"));
  EXPECT_FALSE(astray("000#0100330901000000")) << "another register";
  CanFrame longer = parse("000#0100330A01000000");
  longer.extended = true;
  EXPECT_FALSE(family_.startup->has_wrong_reply_id(longer));
  EXPECT_FALSE(astray("000#117FFF7FF7FF1E23"));
}

TEST_F(DamiaoFamilyTest, EachFrameIsAnsweredAtOnce) {
  CanFrame frame;
  EXPECT_FALSE(family_.codec->needs_bus_frame(&frame));
  EXPECT_EQ(family_.startup->patience_cycles(), 1);
}

TEST_F(DamiaoFamilyTest, AnAnswerIsPresence) {
  EXPECT_TRUE(family_.startup->is_presence(parse("011#0100330A01000000")));
  EXPECT_FALSE(family_.startup->is_presence(parse("012#0100330A01000000")));
}

/// An answer judged, with what was found.
struct Checked {
  Answer answer;
  double found = -1.0;
};

// Register requests of another master to drive 1: their answers look like states of the drive.
class DamiaoForeign : public ::testing::Test {
 protected:
  void request(const std::string& bytes) { rules_->record_foreign(parse("7FF#" + bytes)); }
  bool answers(const std::string& bytes) { return rules_->answers_foreign(parse("011#" + bytes)); }
  void cycles(int count) {
    for (int i = 0; i < count; ++i) rules_->begin_cycle();
  }

  DriveFamily family_ = make_drive_family(joint(), false, 1e-3);
  IntruderRules* rules_ = family_.intruders.get();
};

TEST_F(DamiaoForeign, EachRequestHasOneAnswer) {
  EXPECT_FALSE(answers("0100330701000000")) << "nobody has requested it";
  request("01003307");
  EXPECT_FALSE(answers("0100330801000000")) << "another register";
  EXPECT_FALSE(answers("0100550701000000")) << "of a write";
  EXPECT_TRUE(answers("0100330701000000"));
  EXPECT_FALSE(answers("0100330701000000")) << "a second time";
  request("0100550901000000");
  EXPECT_TRUE(answers("0100550901000000"));
  request("01003300");
  EXPECT_TRUE(answers("0100330000000000"));
}

TEST_F(DamiaoForeign, OnlyReadsAndWritesOfThisDriveAreKept) {
  request("02003307");                            // to drive 2
  request("0100AA07");                            // store
  request("0100CC07");                            // a state
  rules_->record_foreign(parse("7FE#01003307"));  // no register identifier
  for (const char* bytes : {"0100330701000000", "0100550701000000", "0100AA0701000000"})
    EXPECT_FALSE(answers(bytes)) << bytes;
}

TEST_F(DamiaoForeign, RequestsOfStatesDisplaceNone) {
  request("01003307");
  for (int i = 0; i < 8; ++i) request("0100CC00");
  EXPECT_TRUE(answers("0100330701000000"));
}

TEST_F(DamiaoForeign, AnAnswerMayTakeNinetyNineCycles) {
  request("01003307");
  cycles(99);
  EXPECT_TRUE(answers("0100330701000000"));
  request("01003307");
  cycles(100);
  EXPECT_FALSE(answers("0100330701000000"));
  cycles(100);
  EXPECT_FALSE(answers("0100330701000000")) << "nor later";
}

TEST_F(DamiaoForeign, EightAreKept) {
  for (int reg = 1; reg <= 9; ++reg) request("0100330" + std::to_string(reg));
  EXPECT_FALSE(answers("0100330101000000")) << "the ninth took its place";
  for (int reg = 2; reg <= 9; ++reg)
    EXPECT_TRUE(answers("0100330" + std::to_string(reg) + "01000000")) << reg;
}

class DamiaoStartUp : public DamiaoFamilyTest {
 protected:
  Checked check(int step, const std::string& frame) {
    Checked checked;
    checked.answer = family_.startup->check_answer(step, parse(frame), &checked.found);
    return checked;
  }
  /// An answer to a read of a register, float32.
  static std::string range(int reg, float value) {
    std::uint32_t raw = 0;
    std::memcpy(&raw, &value, 4);
    char made[32];
    std::snprintf(made, sizeof(made), "011#010033%02X%02X%02X%02X%02X", reg, raw & 255,
                  raw >> 8 & 255, raw >> 16 & 255, raw >> 24);
    return made;
  }
};

TEST_F(DamiaoStartUp, ReadsThreeRangesAndWritesTwoSettings) {
  ASSERT_EQ(family_.startup->steps(), 7);
  const char* const requests[] = {"7FF#01003315",         "7FF#01003316", "7FF#01003317",
                                  "7FF#0100550A01000000", "7FF#0100330A", "7FF#0100550990010000",
                                  "7FF#01003309"};
  const StartupStep steps[] = {{21, 12.5}, {22, 30.0}, {23, 10.0}, {10, 1.0},
                               {10, 1.0},  {9, 400.0}, {9, 400.0}};
  for (int i = 0; i < 7; ++i) {
    EXPECT_TRUE(text(family_.startup->request(i)).starts_with(requests[i])) << i;
    EXPECT_EQ(family_.startup->step(i).reg, steps[i].reg);
    EXPECT_EQ(family_.startup->step(i).expected, steps[i].expected);
    EXPECT_TRUE(family_.startup->step(i).answered);
  }
}

// 12.566 for 4 pi is right: a ten-thousandth.
TEST_F(DamiaoStartUp, RangesAgreeToATenThousandth) {
  EXPECT_EQ(check(0, range(21, 12.5F)).answer, Answer::kRight);
  EXPECT_EQ(check(0, range(21, 12.50124F)).answer, Answer::kRight);
  EXPECT_EQ(check(0, range(21, 12.49876F)).answer, Answer::kRight);
  const Checked above = check(0, range(21, 12.5013F));
  EXPECT_EQ(above.answer, Answer::kWrong);
  EXPECT_NEAR(above.found, 12.5013, 1e-6);
  EXPECT_EQ(check(0, range(21, 12.4987F)).answer, Answer::kWrong);
  EXPECT_EQ(check(2, range(23, 10.0F)).answer, Answer::kRight);
  JointConfig fast = joint();
  fast.drive.range.velocity_rad_per_s = 10000.0;
  family_ = make_drive_family(fast, false, 1e-3);
  EXPECT_EQ(check(1, range(22, 10001.0F)).answer, Answer::kRight);
  EXPECT_EQ(check(1, range(22, 10001.1F)).answer, Answer::kWrong);
  EXPECT_EQ(check(2, range(22, 10.0F)).answer, Answer::kNone) << "another register";
}

TEST_F(DamiaoStartUp, SettingsAreEqual) {
  EXPECT_EQ(check(3, "011#0100550A01000000").answer, Answer::kRight);
  EXPECT_EQ(check(3, "011#0100330A01000000").answer, Answer::kNone) << "not yet written";
  EXPECT_EQ(check(4, "011#0100330A01000000").answer, Answer::kRight);
  const Checked other = check(4, "011#0100330A02000000");
  EXPECT_EQ(other.answer, Answer::kWrong);
  EXPECT_EQ(other.found, 2.0);
  EXPECT_EQ(check(6, "011#0100330990010000").answer, Answer::kRight);
  EXPECT_EQ(check(6, "011#0100330991010000").answer, Answer::kWrong);
}

TEST_F(DamiaoStartUp, WhatFailedInWords) {
  EXPECT_EQ(family_.startup->describe({}), "could not be disabled, or does not answer");
  EXPECT_EQ(family_.startup->describe({23, Answer::kNone, 0.0, 28.0}), "register 23 not answered");
  EXPECT_EQ(family_.startup->describe({23, Answer::kWrong, 10.0, 28.0}),
            "register 23 is 10, expected 28");
}

// OT_Value, register 2, against limit_temperature_degC. 90 is 42B40000h, the next float 42B40001h.
TEST(DamiaoHeat, TheDrivesOwnLimitIsAbove) {
  JointConfig made = joint();
  const int without = make_drive_family(made, false, 1e-3).startup->steps();
  made.drive.limit_temperature_degC = 90.0;
  const auto family = make_drive_family(made, false, 1e-3);
  ASSERT_EQ(family.startup->steps(), without + 1);
  const int last = without;
  EXPECT_EQ(text(family.startup->request(last)), "7FF#0100330200000000");
  EXPECT_EQ(family.startup->step(last).reg, 2U);
  EXPECT_EQ(family.startup->step(last).expected, 90.0);
  EXPECT_FALSE(family.startup->can_be_polled(last))
      << "the ranges, mode and time-out have their turn";
  double found = 0.0;
  const auto answer = [&](const std::string& bytes) {
    return family.startup->check_answer(last, parse("011#01003302" + bytes), &found);
  };
  EXPECT_EQ(answer("0000C842"), Answer::kRight);
  EXPECT_EQ(found, 100.0);
  EXPECT_EQ(answer("0100B442"), Answer::kRight);
  EXPECT_EQ(answer("0000B442"), Answer::kWrong);
  EXPECT_EQ(answer("0000C07F"), Answer::kWrong) << "not a number";
  EXPECT_EQ(family.startup->describe({2, Answer::kWrong, 85.0, 90.0}),
            "register 2 (over-temperature) is 85, expected more than 90: the drive would let go "
            "before limit_temperature_degC stops the arm");
  EXPECT_EQ(family.startup->describe({2, Answer::kNone, 0.0, 90.0}), "register 2 not answered");
}

TEST(DriveFamilies, WhatNobodyHasToldIsADisabledDriveAtRest) {
  const DriveReport report;
  EXPECT_EQ(report.condition, DriveCondition::kDisabled);
  for (const double value :
       {report.angle_rad, report.speed_rad_per_s, report.link_angle_rad,
        report.link_speed_rad_per_s, report.torque_Nm, report.current_A, report.temperature_degC})
    EXPECT_EQ(value, 0.0);
  EXPECT_EQ(report.status, 0);
  EXPECT_FALSE(DriveMemory{}.recent);
  const DriveCommand command;
  for (const double value : {command.angle_rad, command.speed_rad_per_s, command.kp_Nm_per_rad,
                             command.kd_Nms_per_rad, command.torque_Nm})
    EXPECT_EQ(value, 0.0);
  const StartupFailure failure;
  EXPECT_EQ(failure.answer, Answer::kNone);
  EXPECT_EQ(failure.found, 0.0);
  EXPECT_EQ(failure.expected, 0.0);
  EXPECT_EQ(StartupStep{}.reg, 0u);
  EXPECT_EQ(StartupStep{}.expected, 0.0);
}

}  // namespace
}  // namespace limber::test_damiao_family
