// A RobStride drive's family by itself: its states, its start-up, and whose frames are whose.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "drivers/families/drive_family.h"
#include "drivers/protocols/robstride.h"
#include "robots/loader/protocols/drive_protocol.h"
#include "tests/support/frame_text.h"

namespace limber::test_robstride_family {
namespace {

using testing::text;

constexpr double kCount_Nm = 17.0 / 32767.0;

/// Motor 1, an RS02 with 5 N m and a watchdog of 20 ms.
JointConfig joint() {
  JointConfig made;
  made.drive.protocol = &protocol_named("robstride");
  made.torque_limit_Nm = 5.0;
  made.drive.command_id = 0x01000001;
  made.drive.reply_id = 0x020001FD;
  made.drive.range = {4.0 * std::numbers::pi, 44.0, 17.0, 500.0, 5.0};
  made.drive.torque_constant_Nm_per_A = 2.0;
  return made;
}

CanFrame parse(const std::string& candump) {
  CanFrame frame = testing::parse(candump);
  frame.extended = true;
  return frame;
}

class RobstrideFamily : public ::testing::Test {
 protected:
  StateReading read(const std::string& candump) {
    return family_.codec->read_state(parse(candump), false, &report_);
  }

  DriveFamily family_ = make_drive_family(joint(), false, 1e-3);
  DriveReport report_;
};

TEST_F(RobstrideFamily, FramesWithoutTorque) {
  EXPECT_EQ(text(family_.codec->enable({})), "300FD01#0000000000000000");
  EXPECT_EQ(text(family_.codec->disable()), "400FD01#0000000000000000");
  EXPECT_EQ(text(family_.codec->clear_error()), "400FD01#0100000000000000");
  EXPECT_EQ(text(family_.codec->state_request()), "17FFF01#7FFF7FFF00000000");
  EXPECT_EQ(text(family_.startup->presence_request()), "FD01#0000000000000000");
}

TEST_F(RobstrideFamily, AStateInSIUnits) {
  ASSERT_EQ(read("028001FD#7FFF7FFF7FFF0181"), StateReading::kWhole);
  EXPECT_EQ(report_.condition, DriveCondition::kEnabled);
  EXPECT_NEAR(report_.angle_rad, 0.5 * 4.0 * std::numbers::pi / 32767.0, 1e-12) << "truncated";
  EXPECT_NEAR(report_.torque_Nm, 0.5 * kCount_Nm, 1e-12);
  EXPECT_NEAR(report_.current_A, 0.5 * report_.torque_Nm, 1e-12);
  EXPECT_NEAR(report_.temperature_degC, 38.5, 1e-9);
  ASSERT_EQ(read("020001FD#7FFF7FFF7FFF0181"), StateReading::kWhole);
  EXPECT_EQ(report_.condition, DriveCondition::kDisabled);
  EXPECT_EQ(family_.codec->status_text(report_.status), "stopped, without a fault");
  ASSERT_EQ(read("028601FD#7FFF7FFF7FFF0181"), StateReading::kWhole);
  EXPECT_EQ(report_.condition, DriveCondition::kFailed) << "whatever its mode";
  EXPECT_EQ(family_.codec->status_text(report_.status), "over-current, over-temperature");
}

TEST_F(RobstrideFamily, OtherFramesAreNoStates) {
  EXPECT_EQ(read("028002FD#7FFF7FFF7FFF0181"), StateReading::kNone) << "another motor's";
  EXPECT_EQ(read("188001FD#7FFF7FFF7FFF0181"), StateReading::kNone) << "not requested";
  EXPECT_TRUE(family_.codec->is_unsolicited(parse("188001FD#7FFF7FFF7FFF0181")));
  EXPECT_TRUE(family_.codec->is_unsolicited(parse("150001FD#0400000000000000")));
  EXPECT_FALSE(family_.codec->is_unsolicited(parse("028001FD#7FFF7FFF7FFF0181")));
  EXPECT_FALSE(family_.codec->is_mine(parse("028002FD#7FFF7FFF7FFF0181")));
  EXPECT_FALSE(family_.codec->is_mine(parse("0300FD01#0000000000000000"))) << "to it";
  CanFrame standard = testing::parse("1FD#7FFF7FFF7FFF0181");
  EXPECT_FALSE(family_.codec->is_mine(standard));
}

TEST_F(RobstrideFamily, AFaultFrameIsKeptUntilItIsCleared) {
  EXPECT_EQ(family_.codec->emergency(), 0);
  family_.codec->record_unsolicited(parse("150001FD#0400000000000000"));
  EXPECT_EQ(family_.codec->emergency_text(family_.codec->emergency()), "fault 2: under-voltage");
  family_.codec->record_unsolicited(parse("150001FD#0000008000000000"));
  EXPECT_EQ(family_.codec->emergency_text(family_.codec->emergency()),
            "fault 31: not in the manual");
  static_cast<void>(family_.codec->clear_error());
  EXPECT_EQ(family_.codec->emergency(), 0);
  family_.codec->record_unsolicited(parse("150001FD#0100000000000000"));
  family_.codec->record_unsolicited(parse("150001FD#0000000001000000"));
  EXPECT_EQ(family_.codec->emergency(), 0) << "a warning, and the fault is gone";
}

TEST_F(RobstrideFamily, NoTorqueBeyondTheLimitAndAllUpToIt) {
  CanFrame frame;
  DriveCommand sent;
  for (const double wanted : {5.0, 50.0, -50.0}) {
    ASSERT_TRUE(family_.codec->command({.torque_Nm = wanted}, {}, &frame, &sent));
    EXPECT_LE(std::abs(sent.torque_Nm), 5.0 + 1e-12);
    EXPECT_GT(std::abs(sent.torque_Nm), 5.0 - 1.001 * kCount_Nm);
  }
  ASSERT_TRUE(family_.codec->command({}, {}, &frame, &sent));
  EXPECT_EQ(sent.torque_Nm, 0.0) << "zero is a count";
  const double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(family_.codec->command({.torque_Nm = kNan}, {}, &frame, &sent));
}

TEST_F(RobstrideFamily, AnswersAreFoundInTheFilters) {
  const auto filters = family_.codec->receive_filters();
  const auto passes = [&](const std::string& candump) {
    return std::ranges::any_of(
        filters, [&](const CanFilter& filter) { return filter.passes(parse(candump)); });
  };
  EXPECT_TRUE(passes("028001FD#7FFF7FFF7FFF0181"));
  EXPECT_TRUE(passes("000001FE#0102030405060708"));
  EXPECT_TRUE(passes("0300AA01#0000000000000000")) << "of another master";
  EXPECT_FALSE(passes("028002FD#7FFF7FFF7FFF0181"));
}

TEST_F(RobstrideFamily, TheStartUp) {
  StartupDialogue& startup = *family_.startup;
  ASSERT_EQ(startup.steps(), 4);
  const char* requests[] = {"1200FD01#0570000000000000", "1100FD01#0570000000000000",
                            "1200FD01#2870000090010000", "1100FD01#2870000000000000"};
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(text(startup.request(i)), requests[i]);
    EXPECT_TRUE(startup.step(i).answered);
    EXPECT_EQ(startup.can_be_polled(i), i % 2 == 1) << "read again while it is on";
  }
  double found = 0.0;
  EXPECT_EQ(startup.check_answer(3, parse("110001FD#2870000090010000"), &found), Answer::kRight);
  EXPECT_EQ(startup.check_answer(3, parse("110001FD#2870000000000000"), &found), Answer::kWrong);
  EXPECT_EQ(found, 0.0);
  EXPECT_EQ(startup.describe({0x7028, Answer::kWrong, 0.0, 400.0}),
            "parameter 7028 is 0, expected 400");
  EXPECT_EQ(startup.check_answer(3, parse("110101FD#2870000000000000"), &found), Answer::kRefused);
  EXPECT_EQ(startup.describe({0x7028, Answer::kRefused, 0.0, 400.0}),
            "parameter 7028 is refused by its firmware");
  EXPECT_EQ(startup.check_answer(3, parse("110002FD#2870000090010000"), &found), Answer::kNone);
  EXPECT_EQ(startup.check_answer(3, parse("110001AA#2870000090010000"), &found), Answer::kNone)
      << "to another host";
  EXPECT_EQ(startup.check_answer(1, parse("110001FD#2870000090010000"), &found), Answer::kNone);
  EXPECT_EQ(startup.check_answer(0, parse("110001FD#0570000000000000"), &found), Answer::kNone);
  EXPECT_EQ(startup.check_answer(0, parse("028001FD#7FFF7FFF7FFF0181"), &found), Answer::kRight)
      << "a write is answered with a state";
  EXPECT_EQ(startup.check_answer(0, parse("028002FD#7FFF7FFF7FFF0181"), &found), Answer::kNone);
  EXPECT_TRUE(startup.is_presence(parse("000001FE#0102030405060708")));
  EXPECT_FALSE(startup.is_presence(parse("000002FE#0102030405060708")));
  EXPECT_FALSE(startup.is_presence(parse("028001FD#7FFF7FFF7FFF0181")));
}

TEST_F(RobstrideFamily, OtherMasters) {
  IntruderRules& rules = *family_.intruders;
  for (const char* command :
       {"0192D201#8A2F7A2E1EB84CCC", "0300AA01#0000000000000000", "0400FD01#0000000000000000",
        "0600FD01#0100000000000000", "0702FD01#0000000000000000", "1200FD01#2870000000000000",
        "1600FD01#0102030405060708", "1900FD01#0102030405060200"})
    EXPECT_TRUE(rules.is_foreign_command(parse(command))) << command;
  for (const char* harmless : {"0000FD01#0000000000000000", "1100FD01#1970000000000000",
                               "0300FD02#0000000000000000", "028001FD#7FFF7FFF7FFF0181"})
    EXPECT_FALSE(rules.is_foreign_command(parse(harmless))) << harmless;
  const CanFrame answer = parse("110001FD#1970000000000000");
  EXPECT_FALSE(rules.answers_foreign(answer)) << "nobody requested it";
  rules.record_foreign(parse("1100FD01#1970000000000000"));
  EXPECT_FALSE(rules.answers_foreign(parse("028001FD#7FFF7FFF7FFF0181"))) << "a state is none";
  EXPECT_TRUE(rules.answers_foreign(answer));
  EXPECT_FALSE(rules.answers_foreign(answer)) << "once";
}

}  // namespace
}  // namespace limber::test_robstride_family
