// A CubeMars drive's family by itself: what it takes for on and off, its start-up, and whose frames
// are whose.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "drivers/families/drive_family.h"
#include "drivers/protocols/cubemars.h"
#include "robots/loader/protocols/drive_protocol.h"
#include "tests/support/frame_text.h"

namespace limber::test_cubemars_family {
namespace {

using testing::text;

const std::string kOn = "002#FFFFFFFFFFFFFFFC";
const std::string kOff = "002#FFFFFFFFFFFFFFFD";
const std::string kAtRest = "000#027FFF7FF7FF1E00";
const std::string kOverCurrent = "000#027FFF7FF7FF1E02";
const std::string kNoTorque = kAtRest;

CanFrame parse(const std::string& candump) {
  CanFrame frame = testing::parse(candump);
  frame.extended = candump.find('#') > 3;
  return frame;
}

/// Motor 2, an AK80-9 with 9 N m.
JointConfig joint(int board) {
  JointConfig made;
  made.drive.protocol = &protocol_named("cubemars");
  made.torque_limit_Nm = 9.0;
  made.drive.board = board;
  made.drive.command_id = board == cubemars::kV3 ? 0x802 : 2;
  made.drive.reply_id = board == cubemars::kV3 ? 0x2902 : 0;
  made.drive.range = {12.5, 50.0, 18.0, 500.0, 5.0};
  made.drive.gear_ratio = 9.0;
  made.drive.torque_constant_Nm_per_A = 2.0;
  return made;
}

struct Drive {
  explicit Drive(int board) : family(make_drive_family(joint(board), false, 1e-3)) {}

  DriveCondition read(const std::string& candump, bool late = false) {
    EXPECT_EQ(family.codec->read_state(parse(candump), late, &report), StateReading::kWhole);
    return report.condition;
  }
  std::string command(double torque) {
    family.codec->begin_cycle();
    CanFrame frame;
    return family.codec->command({.torque_Nm = torque}, {}, &frame, &sent) ? text(frame) : "none";
  }
  std::string request() { return text(family.codec->state_request()); }
  std::string words() const { return family.codec->status_text(report.status); }

  DriveFamily family;
  DriveReport report;
  DriveCommand sent;
};

TEST(CubemarsFamily, ItIsOnOnceItHasAnsweredThatItIsTo) {
  Drive drive(cubemars::kV2);
  EXPECT_EQ(text(drive.family.codec->disable()), kOff);
  EXPECT_EQ(drive.read(kAtRest), DriveCondition::kDisabled);
  EXPECT_EQ(drive.request(), kOff);
  EXPECT_EQ(drive.command(0.0).substr(0, 4), "002#");
  EXPECT_EQ(drive.read(kAtRest), DriveCondition::kDisabled) << "a command enables nothing";
  drive.family.codec->begin_cycle();
  EXPECT_EQ(text(drive.family.codec->enable({})), kOn);
  EXPECT_EQ(drive.read(kAtRest, true), DriveCondition::kDisabled) << "of the cycle before";
  EXPECT_EQ(drive.read(kAtRest), DriveCondition::kEnabled);
  EXPECT_EQ(drive.words(), "enabled");
  EXPECT_EQ(drive.request(), kOn) << "leaves it as it is";
  EXPECT_EQ(text(drive.family.codec->disable()), kOff);
  EXPECT_EQ(drive.read(kAtRest), DriveCondition::kDisabled);
  EXPECT_EQ(drive.words(), "disabled, without an error");
}

// Raw 30670, 2170, 1569 counts, and half a count more.
TEST(CubemarsFamily, AStateIsReadWithHalfACountMore) {
  Drive drive(cubemars::kV2);
  drive.read("000#0277CE87A6212400");
  EXPECT_NEAR(drive.report.angle_rad, 30670.5 * 25.0 / 65535.0 - 12.5, 1e-9);
  EXPECT_NEAR(drive.report.speed_rad_per_s, 2170.5 * 100.0 / 4095.0 - 50.0, 1e-9);
  EXPECT_NEAR(drive.report.torque_Nm, 1569.5 * 36.0 / 4095.0 - 18.0, 1e-9);
  EXPECT_NEAR(drive.report.current_A, 0.5 * drive.report.torque_Nm, 1e-12);
  EXPECT_EQ(drive.report.temperature_degC, 36.0);
  EXPECT_NEAR(drive.family.codec->angle_resolution(), 25.0 / 65535.0, 1e-12);
  Drive v1(cubemars::kV1);
  v1.read("000#0277CE87A621");
  EXPECT_NEAR(v1.report.angle_rad, drive.report.angle_rad, 1e-12);
}

TEST(CubemarsFamily, ADriveInErrorIsOffAndStaysSo) {
  Drive drive(cubemars::kV2);
  drive.family.codec->enable({});
  EXPECT_EQ(drive.read(kOverCurrent), DriveCondition::kFailed);
  EXPECT_EQ(drive.words(), "error 2: over-current");
  EXPECT_EQ(drive.request(), kOff);
  EXPECT_EQ(drive.read(kAtRest), DriveCondition::kDisabled) << "the cause is gone";
  drive.read("000#027FFF7FF7FF1E63");
  EXPECT_EQ(drive.words(), "error 99: not in the manual");
}

// 9 N m limit, a count is 8.8 mN m: 0.3 N m are commanded, none is made.
TEST(CubemarsFamily, ADriveThatWasResetIsKnownByTheTorqueItDoesNotMake) {
  Drive drive(cubemars::kV2);
  drive.family.codec->enable({});
  drive.read(kAtRest);
  for (int cycle = 0; cycle < 9; ++cycle) {
    drive.command(0.3);
    ASSERT_EQ(drive.read(kNoTorque), DriveCondition::kEnabled) << cycle;
  }
  drive.command(0.3);
  EXPECT_EQ(drive.read(kNoTorque), DriveCondition::kFailed);
  EXPECT_NE(drive.words().find("reset; its zero may be lost"), std::string::npos);
  EXPECT_EQ(drive.request(), kOff) << "not to go on by itself";
  EXPECT_EQ(drive.read("000#027FFF7FF8FF1E00"), DriveCondition::kFailed) << "until cleared";
  drive.family.codec->clear_error();
  EXPECT_EQ(drive.read(kAtRest), DriveCondition::kDisabled);
}

TEST(CubemarsFamily, LittleTorqueAndATorqueThatIsMadeAreNoReset) {
  Drive drive(cubemars::kV2);
  drive.family.codec->enable({});
  for (int cycle = 0; cycle < 100; ++cycle) {
    drive.command(0.1);
    ASSERT_EQ(drive.read(kNoTorque), DriveCondition::kEnabled) << "below 20 counts";
  }
  for (int cycle = 0; cycle < 100; ++cycle) {
    drive.command(3.0);
    ASSERT_EQ(drive.read("000#027FFF7FF8041E00"), DriveCondition::kEnabled) << "5 counts";
  }
}

TEST(CubemarsFamily, AV3IsOnAsSoonAsItIsCommanded) {
  Drive drive(cubemars::kV3);
  EXPECT_EQ(text(drive.family.codec->disable()), "102#00000000");
  EXPECT_EQ(drive.request(), "102#00000000");
  EXPECT_EQ(drive.read("00002902#0000000000001E00"), DriveCondition::kDisabled);
  EXPECT_EQ(drive.command(2.5), "802#000000800080091C") << "no gains, in front";
  EXPECT_EQ(drive.read("00002902#011E000000961E00"), DriveCondition::kEnabled);
  EXPECT_NEAR(drive.report.angle_rad, 28.6 * 3.14159265358979 / 180.0, 1e-9);
  EXPECT_NEAR(drive.report.torque_Nm, 3.0, 1e-9);
  EXPECT_EQ(drive.request(), "802#0000008000800800") << "neither gains nor torque";
  EXPECT_EQ(text(drive.family.codec->enable({})), "802#0000008000800800");
}

TEST(CubemarsFamily, NothingThatIsNotFiniteIsSent) {
  for (const int board : {1, 2, 3}) {
    Drive drive(board);
    EXPECT_EQ(drive.command(std::numeric_limits<double>::quiet_NaN()), "none");
    EXPECT_EQ(drive.command(std::numeric_limits<double>::infinity()), "none");
  }
}

TEST(CubemarsFamily, StartUpTellsAnotherBoardAndServoMode) {
  const auto family = make_drive_family(joint(cubemars::kV2), false, 1e-3);
  StartupDialogue& startup = *family.startup;
  ASSERT_EQ(startup.steps(), 1);
  EXPECT_EQ(text(startup.request(0)), kOff);
  EXPECT_EQ(text(startup.presence_request()), kOff);
  double found = 0.0;
  EXPECT_EQ(startup.check_answer(0, parse(kAtRest), &found), Answer::kRight);
  EXPECT_EQ(startup.check_answer(0, parse("000#037FFF7FF7FF1E00"), &found), Answer::kNone);
  const auto words = [&](const std::string& candump) {
    const Answer answer = startup.check_answer(0, parse(candump), &found);
    EXPECT_EQ(answer, Answer::kWrong);
    return startup.describe({startup.step(0).reg, answer, found, startup.step(0).expected});
  };
  EXPECT_NE(words("000#027FFF7FF7FF").find("6 bytes, those of a board V2 8"), std::string::npos);
  EXPECT_NE(words("00002902#0000000000001E00").find("servo mode"), std::string::npos);
  EXPECT_TRUE(startup.is_presence(parse("00002902#0000000000001E00")));
  EXPECT_NE(startup.describe({1, Answer::kNone, 0.0, 8.0}).find("MIT mode"), std::string::npos);
}

TEST(CubemarsFamily, WhatOtherMastersSend) {
  const auto v2 = make_drive_family(joint(cubemars::kV2), false, 1e-3);
  EXPECT_TRUE(v2.intruders->is_foreign_command(parse(kOff)));
  EXPECT_FALSE(v2.intruders->is_foreign_command(parse("003#FFFFFFFFFFFFFFFD")));
  EXPECT_FALSE(v2.intruders->is_foreign_command(parse(kAtRest)));
  const auto v3 = make_drive_family(joint(cubemars::kV3), false, 1e-3);
  for (const char* frame : {"00000002#00000000", "00000502#00", "00000802#0000007FFF7FF7FF"})
    EXPECT_TRUE(v3.intruders->is_foreign_command(parse(frame))) << frame;
  for (const char* frame : {"00000803#0000007FFF7FF7FF", "00002902#0000000000001E00", "002#00"})
    EXPECT_FALSE(v3.intruders->is_foreign_command(parse(frame))) << frame;
}

TEST(CubemarsFamily, FiltersPassWhatItMustHear) {
  for (const int board : {2, 3}) {
    const auto family = make_drive_family(joint(board), false, 1e-3);
    const auto filters = family.codec->receive_filters();
    CanFrame frame;
    frame.length = 8;
    frame.data[0] = 2;
    for (frame.id = 0; frame.id <= 0xFFFF; ++frame.id) {
      for (const bool extended : {false, true}) {
        if (!extended && frame.id > kStandardIdMax) continue;
        frame.extended = extended;
        const bool wanted =
            family.codec->is_mine(frame) || family.intruders->is_foreign_command(frame);
        const bool passes =
            std::ranges::any_of(filters, [&](const CanFilter& one) { return one.passes(frame); });
        ASSERT_TRUE(!wanted || passes) << std::hex << frame.id;
      }
    }
  }
}

}  // namespace
}  // namespace limber::test_cubemars_family
