// A moteus drive's family by itself: its commands, states, settings, and whose frames are whose.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <numbers>
#include <string>

#include "drivers/families/drive_family.h"
#include "robots/loader/protocols/drive_protocol.h"
#include "tests/support/frame_text.h"

namespace limber::test_moteus_family {
namespace {

using testing::parse;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

float float_at(const CanFrame& frame, std::size_t at) {
  float value = 0.0F;
  std::memcpy(&value, &frame.data[at], 4);
  return value;
}

/// Number 5 with prefix 2; 500 N m/rad and 5 N m s/rad at most; from -1 to 2 rad.
JointConfig joint() {
  JointConfig made;
  made.torque_limit_Nm = 8.0;
  made.position_min = -1.0;
  made.position_max = 2.0;
  made.drive.protocol = &protocol_named("moteus");
  made.drive.command_id = 0x00028005;
  made.drive.reply_id = 0x500;
  return made;
}
DriveFamily family_of(const JointConfig& joint) { return make_drive_family(joint, true, 1e-3); }

CanFrame with_id(std::uint32_t id, bool extended) {
  CanFrame frame;
  frame.id = id;
  frame.extended = extended;
  return frame;
}

/// Mode and fault as int8, four floats, temperature; the rest is padding.
CanFrame state(int mode, int fault, float turns = 0.0F, float turns_per_s = 0.0F) {
  CanFrame frame = with_id(0x500, false);
  frame.fd = true;
  frame.length = 32;
  frame.data.fill(0x50);
  const int bytes[] = {0x21, 0x00, mode, 0x2C, 0x04, 0x01};
  for (std::size_t i = 0; i < 6; ++i) frame.data[i] = static_cast<std::uint8_t>(bytes[i]);
  const float values[] = {turns, turns_per_s, 1.5F, 0.25F};
  std::memcpy(&frame.data[6], values, sizeof(values));
  const int rest[] = {0x22, 0x0E, 41, fault};
  for (std::size_t i = 0; i < 4; ++i) frame.data[22 + i] = static_cast<std::uint8_t>(rest[i]);
  return frame;
}
/// Text of the diagnostic channel.
CanFrame said(const std::string& text) {
  CanFrame frame = with_id(0x500, false);
  frame.fd = true;
  frame.data = {0x41, 0x01, static_cast<std::uint8_t>(text.size())};
  std::copy(text.begin(), text.end(), frame.data.begin() + 3);
  frame.length = static_cast<std::uint8_t>(fd_length(3 + static_cast<int>(text.size())));
  return frame;
}

class MoteusFamilyTest : public ::testing::Test {
 protected:
  Answer check(int step, const CanFrame& frame) {
    found_ = -77.0;
    return family_.startup->check_answer(step, frame, &found_);
  }
  /// A question's line, sent and answered at once.
  Answer asked(int question, const std::string& answer) {
    EXPECT_EQ(check(2 + 2 * question, said("")), Answer::kRight);
    return check(3 + 2 * question, said(answer));
  }

  DriveFamily family_ = family_of(joint());
  double found_ = 0.0;
};

TEST_F(MoteusFamilyTest, ACommandInTurnsAndShares) {
  CanFrame frame;
  DriveCommand sent;
  ASSERT_TRUE(
      family_.codec->command({kTurn / 8.0, kTurn / 4.0, 250.0, 1.25, -3.0}, {}, &frame, &sent));
  const float expected[] = {0.125F, 0.25F, -3.0F, 0.5F, 0.25F, 8.0F};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_FLOAT_EQ(float_at(frame, 6 + 4 * i), expected[i]) << i;
  EXPECT_FLOAT_EQ(float_at(frame, 32), 0.02F);
  EXPECT_NEAR(sent.kp_Nm_per_rad, 250.0, 1e-12);
  EXPECT_NEAR(sent.kd_Nms_per_rad, 1.25, 1e-12);
  ASSERT_TRUE(family_.codec->command({1.0, 0.0, 0.0, 0.0, 9.0}, {}, &frame, &sent));
  EXPECT_TRUE(std::isnan(float_at(frame, 6))) << "without stiffness there is no place";
  EXPECT_EQ(sent.torque_Nm, 8.0);
}

TEST_F(MoteusFamilyTest, WhatIsNotFiniteIsNoCommand) {
  for (double DriveCommand::*field :
       {&DriveCommand::angle_rad, &DriveCommand::speed_rad_per_s, &DriveCommand::kp_Nm_per_rad,
        &DriveCommand::kd_Nms_per_rad, &DriveCommand::torque_Nm}) {
    CanFrame frame;
    DriveCommand command;
    command.*field = kInf;
    EXPECT_FALSE(family_.codec->command(command, {}, &frame, &command));
  }
}

TEST_F(MoteusFamilyTest, ItIsEnabledByACommandOfNothing) {
  DriveMemory memory;
  memory.seen.angle_rad = 1.0;
  const CanFrame frame = family_.codec->enable(memory);
  EXPECT_EQ(frame.data[2], 10) << "position mode";
  EXPECT_TRUE(std::isnan(float_at(frame, 6)));
  for (const std::size_t at : {10u, 14u, 18u, 22u}) EXPECT_EQ(float_at(frame, at), 0.0F) << at;
  memory.seen.angle_rad = kNan;
  EXPECT_EQ(testing::text(family_.codec->enable(memory)),
            testing::text(family_.codec->state_request()));
}

TEST_F(MoteusFamilyTest, AStateInSIUnits) {
  DriveReport report;
  ASSERT_EQ(family_.codec->read_state(state(10, 0, 0.25F, -0.5F), false, &report),
            StateReading::kWhole);
  EXPECT_EQ(report.condition, DriveCondition::kEnabled);
  EXPECT_EQ(report.status, 10);
  EXPECT_NEAR(report.angle_rad, 0.25 * kTurn, 1e-12);
  EXPECT_NEAR(report.link_angle_rad, 0.25 * kTurn, 1e-12);
  EXPECT_NEAR(report.speed_rad_per_s, -0.5 * kTurn, 1e-12);
  EXPECT_NEAR(report.link_speed_rad_per_s, -0.5 * kTurn, 1e-12);
  EXPECT_EQ(report.torque_Nm, 1.5);
  EXPECT_EQ(report.current_A, 0.25);
  EXPECT_EQ(report.temperature_degC, 41.0);
  ASSERT_EQ(family_.codec->read_state(state(1, 33), false, &report), StateReading::kWhole);
  EXPECT_EQ(report.condition, DriveCondition::kFailed);
  EXPECT_EQ(report.status, 0x2101);
  ASSERT_EQ(family_.codec->read_state(state(1, -1), false, &report), StateReading::kWhole);
  EXPECT_EQ(report.status, 0xFF01);
  EXPECT_EQ(family_.codec->read_state(said("OK"), false, &report), StateReading::kNone);
}

TEST_F(MoteusFamilyTest, ModeAndFaultInWords) {
  EXPECT_EQ(family_.codec->status_text(10), "mode 10: position");
  EXPECT_EQ(family_.codec->status_text(0), "mode 0: stopped");
  EXPECT_EQ(family_.codec->status_text(0x000B), "mode 11: no command within the drive's time-out");
  EXPECT_EQ(family_.codec->status_text(0x2101), "mode 1, fault 33: motor driver");
  EXPECT_EQ(family_.codec->status_text(0x0101), "mode 1, fault 1: see the maker's list");
  EXPECT_EQ(family_.codec->status_text(0x0200), "mode 0, fault 2: see the maker's list");
}

// An encoder count, or what float32 tells apart in a turn.
TEST_F(MoteusFamilyTest, TheSmallestDifferenceOfAngles) {
  JointConfig config = joint();
  config.drive.counts_per_turn = 4096.0;
  EXPECT_NEAR(family_of(config).codec->angle_resolution(), kTurn / 4096.0, 1e-15);
  config.drive.counts_per_turn = 1e9;
  EXPECT_NEAR(family_of(config).codec->angle_resolution(), kTurn * std::ldexp(1.0, -23), 1e-15);
}

// Bits 0 to 6 are the number of whom it is for, 7Fh all; 16 to 28 the prefix.
TEST_F(MoteusFamilyTest, FramesForItsNumberAndPrefixAreForeign) {
  EXPECT_TRUE(family_.intruders->is_foreign_command(with_id(0x28005, true)));
  EXPECT_TRUE(family_.intruders->is_foreign_command(with_id(0x28105, true))) << "from another host";
  EXPECT_FALSE(family_.intruders->is_foreign_command(with_id(0x18005, true))) << "another prefix";
  EXPECT_FALSE(family_.intruders->is_foreign_command(with_id(0x38005, true)));
  EXPECT_FALSE(family_.intruders->is_foreign_command(with_id(0x28006, true)));
  CanFrame error = with_id(0x28005, true);
  error.error = true;
  EXPECT_FALSE(family_.intruders->is_foreign_command(error));
  EXPECT_FALSE(family_.startup->has_wrong_reply_id(with_id(0x600, false)))
      << "its answers have its number";
}

TEST_F(MoteusFamilyTest, FiltersLetItsNumberAndAllsPass) {
  const auto passes = [this](std::uint32_t id, bool extended) {
    const std::vector<CanFilter> filters = family_.codec->receive_filters();
    return std::ranges::any_of(
        filters, [&](const CanFilter& filter) { return filter.passes(with_id(id, extended)); });
  };
  EXPECT_TRUE(passes(0x500, false)) << "its reply";
  for (const std::uint32_t number : {0x05u, 0x7Fu}) {
    EXPECT_TRUE(passes(0x180 | number, false));
    EXPECT_TRUE(passes(0x28000 | number, true));
    EXPECT_TRUE(passes(0x2FF80 | number, true));
    EXPECT_FALSE(passes(0x38000 | number, true)) << "another prefix";
    EXPECT_FALSE(passes(0x08000 | number, true));
    EXPECT_FALSE(passes(0x1028000 | number, true));
  }
  for (const std::uint32_t number : {0x04u, 0x07u, 0x01u, 0x0Du, 0x15u, 0x25u, 0x45u, 0x7Eu}) {
    EXPECT_FALSE(passes(0x180 | number, false)) << number;
    EXPECT_FALSE(passes(0x28000 | number, true)) << number;
  }
}

// --- start-up --------------------------------------------------------------------------------

TEST_F(MoteusFamilyTest, TheRegisterMapAndTheHomeState) {
  EXPECT_EQ(family_.startup->patience_cycles(), 5) << "text is answered from the drive's main loop";
  const auto map = [this](int version) {
    CanFrame frame = with_id(0x500, false);
    frame.data = {0x29, 0x82, 0x02, static_cast<std::uint8_t>(version), 0, 0, 0};
    frame.length = 7;
    return check(0, frame);
  };
  const auto home = [this](int where) {
    CanFrame frame = with_id(0x500, false);
    frame.data = {0x29, 0x0C, static_cast<std::uint8_t>(where), 0, 0, 0, 0x50};
    frame.length = 7;
    return check(1, frame);
  };
  EXPECT_EQ(map(5), Answer::kRight);
  EXPECT_EQ(map(4), Answer::kWrong);
  EXPECT_EQ(map(6), Answer::kWrong);
  EXPECT_EQ(found_, 6.0);
  EXPECT_EQ(check(0, state(0, 0)), Answer::kNone);
  EXPECT_EQ(home(0), Answer::kWrong);
  EXPECT_EQ(home(1), Answer::kRight) << "no gear: the rotor is the output";
  EXPECT_EQ(home(2), Answer::kRight);
  EXPECT_EQ(home(3), Answer::kWrong) << "the maker knows no such state";
  JointConfig geared = joint();
  geared.drive.gear_ratio = 9.0;
  family_ = family_of(geared);
  EXPECT_EQ(home(1), Answer::kWrong);
  EXPECT_EQ(home(2), Answer::kRight);
}

// kp is 500 N m/rad * 2 pi = 3141.592654 N m a turn.
TEST_F(MoteusFamilyTest, GainsAgreeToATenThousandthAndItsLastDecimal) {
  EXPECT_EQ(asked(1, "3141.592654\r\n"), Answer::kRight);
  EXPECT_EQ(asked(1, "3141.906\r\n"), Answer::kRight);
  EXPECT_EQ(asked(1, "3141.907\r\n"), Answer::kWrong);
  EXPECT_NEAR(found_, 3141.907, 1e-9);
  EXPECT_EQ(asked(1, "3141.278\r\n"), Answer::kWrong);
  EXPECT_EQ(asked(2, "0.000001\r\n"), Answer::kRight) << "ki is 0";
  EXPECT_EQ(asked(2, "0.00000105\r\n"), Answer::kWrong);
}

// -1 and 2 rad in turns, -0.159155 and 0.318310; the drive may end beyond them.
TEST_F(MoteusFamilyTest, TheDrivesRangeHoldsTheJoints) {
  EXPECT_EQ(asked(4, "-0.159155\r\n"), Answer::kRight);
  EXPECT_EQ(asked(4, "-0.159154\r\n"), Answer::kRight) << "the last decimal is rounded";
  EXPECT_EQ(asked(4, "-0.159153\r\n"), Answer::kWrong);
  EXPECT_EQ(asked(4, "-5\r\n"), Answer::kRight);
  EXPECT_EQ(asked(4, "nan\r\n"), Answer::kRight) << "no end";
  EXPECT_EQ(asked(5, "0.318309\r\n"), Answer::kRight);
  EXPECT_EQ(asked(5, "0.318308\r\n"), Answer::kWrong);
  EXPECT_EQ(asked(5, "1\r\n"), Answer::kRight);
  JointConfig half = joint();
  half.position_min = -0.25 * kTurn;
  half.position_max = 0.25 * kTurn;
  family_ = family_of(half);
  EXPECT_EQ(asked(4, "-0.249999\r\n"), Answer::kRight);
  EXPECT_EQ(asked(4, "-0.24999895\r\n"), Answer::kWrong);
  EXPECT_EQ(asked(5, "0.249999\r\n"), Answer::kRight);
  EXPECT_EQ(asked(5, "0.24999895\r\n"), Answer::kWrong);
}

TEST_F(MoteusFamilyTest, LinesComeInPiecesBehindOthers) {
  ASSERT_EQ(check(2, said("")), Answer::kRight);
  EXPECT_EQ(check(3, said("K")), Answer::kNotYet);
  EXPECT_EQ(check(3, said("\r\nO")), Answer::kNotYet) << "a line that is not the answer";
  EXPECT_EQ(check(3, said("K\n")), Answer::kRight);
  ASSERT_EQ(check(8, said("OK\r\n3")), Answer::kRight) << "said before: no part of the answer";
  EXPECT_EQ(check(9, said("\n\r\nnews: 1\n31.")), Answer::kNotYet);
  EXPECT_EQ(check(9, said("415926536\r")), Answer::kRight) << "kd: 5 N m s/rad * 2 pi";
  ASSERT_EQ(check(8, said("")), Answer::kRight);
  EXPECT_EQ(check(9, said("31.4 N m s\n")), Answer::kNotYet) << "no number alone";
}

TEST_F(MoteusFamilyTest, AnyLineThatEndsInOkAnswersTheFirstQuestion) {
  ASSERT_EQ(check(2, said("")), Answer::kRight);
  EXPECT_EQ(check(3, said("ERR unknown\r\n12\r\n")), Answer::kNotYet);
  EXPECT_EQ(check(3, said("12 OK\r\n")), Answer::kRight);
}

TEST_F(MoteusFamilyTest, HalfALineIsForgottenBeforeTheNextQuestion) {
  ASSERT_EQ(check(4, said("")), Answer::kRight);
  EXPECT_EQ(check(5, said("31")), Answer::kNotYet);
  EXPECT_EQ(asked(1, "3141.592654\r\n"), Answer::kRight);
}

TEST_F(MoteusFamilyTest, TextBesideAStateIsText) {
  ASSERT_EQ(check(2, said("")), Answer::kRight);
  CanFrame both = said("OK\r\n");
  const CanFrame other = state(0, 0);
  std::copy_n(other.data.begin(), 26, both.data.begin() + 7);
  std::fill(both.data.begin() + 33, both.data.end(), 0x50);
  both.length = 48;
  EXPECT_EQ(check(3, both), Answer::kRight);
}

TEST_F(MoteusFamilyTest, ALineThatIsLongerThanAnyAnswerIsPassedOver) {
  ASSERT_EQ(check(8, said("")), Answer::kRight);
  EXPECT_EQ(check(9, said(std::string(32, 'x'))), Answer::kNotYet);
  EXPECT_EQ(check(9, said("31.415927\n")), Answer::kRight) << "33 to 41: the end of the line";
}

TEST_F(MoteusFamilyTest, AnErrorInsteadOfAnAnswerIsAWarning) {
  EXPECT_EQ(asked(1, "ERR error reading\r\n"), Answer::kMissing);
  EXPECT_EQ(found_, 0.0);
  EXPECT_EQ(asked(1, "3141.592654\r\n"), Answer::kRight);
}

// What answers otherwise than with a state or text has no diagnostic channel: one warning in all.
TEST_F(MoteusFamilyTest, ADriveWithoutADiagnosticChannelIsOneWarning) {
  const CanFrame neither = with_id(0x500, false);
  EXPECT_EQ(check(2, state(0, 0)), Answer::kNone) << "of the request before";
  EXPECT_EQ(found_, -77.0);
  EXPECT_EQ(check(2, neither), Answer::kMissing);
  EXPECT_EQ(found_, 0.0);
  for (int step = 3; step < family_.startup->steps(); ++step)
    EXPECT_EQ(check(step, neither), Answer::kRight) << step;
  EXPECT_EQ(check(2, said("")), Answer::kRight) << "another start-up, and now it has one";
  EXPECT_EQ(check(2, neither), Answer::kMissing);
}

TEST_F(MoteusFamilyTest, WhatFailedInWords) {
  const auto told = [this](std::uint32_t reg, Answer answer, double found, double expected) {
    return family_.startup->describe({reg, answer, found, expected});
  };
  EXPECT_EQ(told(0, Answer::kNone, 0.0, 0.0), "could not be stopped, or does not answer");
  EXPECT_EQ(told(0x102, Answer::kNone, 0.0, 5.0), "register map (register 102h) not answered");
  EXPECT_EQ(told(0x102, Answer::kWrong, 4.0, 5.0), "register map (register 102h) is 4, expected 5");
  EXPECT_EQ(told(0x00C, Answer::kWrong, 0.0, 1.0), "home state (register 00Ch) is 0, expected 1");
  const std::uint32_t line = family_.startup->step(2).reg;
  EXPECT_EQ(family_.startup->step(2).expected, 0.0);
  EXPECT_EQ(told(line, Answer::kMissing, 0.0, 0.0),
            "no diagnostic channel: servo.pid_position and servopos are not compared with "
            "robot.yaml");
  EXPECT_EQ(told(line, Answer::kNone, 0.0, 0.0),
            "tel stop not answered over the diagnostic channel");
  EXPECT_EQ(told(line + 1, Answer::kMissing, 0.0, 0.0),
            "servo.pid_position.kp cannot be read, and is not compared with robot.yaml");
  EXPECT_EQ(told(line + 1, Answer::kWrong, 2.0, 3.0), "servo.pid_position.kp is 2, expected 3");
  EXPECT_EQ(told(line + 4, Answer::kWrong, 2.0, 3.0),
            "servopos.position_min is 2, expected 3 or beyond");
  EXPECT_EQ(told(line + 5, Answer::kWrong, 2.0, kInf),
            "servopos.position_max is 2, expected nan: the joint has no end");
}

}  // namespace
}  // namespace limber::test_moteus_family
