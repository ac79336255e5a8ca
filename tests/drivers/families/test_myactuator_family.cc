// A MyActuator drive's family by itself: what it takes for on and off, its start-up, and whose
// frames are whose.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "drivers/families/drive_family.h"
#include "drivers/protocols/myactuator.h"
#include "robots/loader/protocols/drive_protocol.h"
#include "tests/support/frame_text.h"

namespace limber::test_myactuator_family {
namespace {

using testing::parse;
using testing::text;

const std::string kOff = "141#8000000000000000";
const std::string kOffAnswer = "241#8000000000000000";
const std::string kAngle = "141#9200000000000000";
const std::string kStatus = "141#9A00000000000000";
const std::string kRelease = "141#7700000000000000";
const std::string kReleased = "241#7700000000000000";
const std::string kHealthy = "241#9A1E0001E0010000";
const std::string kUnderVoltage = "241#9A1E0000E0010400";
const std::string kTimedOut = "241#F100000000000000";
const std::string kState = "501#017FFF7FF7FF0000";

/// Motor 1, an X8 of V4.2 with 5 N m and a watchdog of 20 ms.
JointConfig joint(bool v44 = false) {
  JointConfig made;
  made.drive.protocol = &protocol_named("myactuator");
  made.torque_limit_Nm = 5.0;
  made.drive.command_id = 0x401;
  made.drive.reply_id = 0x501;
  made.drive.range = {12.5, 45.0, 24.0, 500.0, 5.0};
  if (v44) made.drive.range = {12.566, 45.0, 129.0, 500.0, 50.0};
  made.drive.torque_constant_Nm_per_A = 2.0;
  return made;
}

class MyactuatorFamily : public ::testing::Test {
 protected:
  StateReading read(const std::string& candump) {
    return family_.codec->read_state(parse(candump), false, &report_);
  }
  /// Of the next cycle.
  std::string request() {
    family_.codec->begin_cycle();
    return text(family_.codec->state_request());
  }
  std::string command(double torque) {
    family_.codec->begin_cycle();
    CanFrame frame;
    return family_.codec->command({.torque_Nm = torque}, {}, &frame, &sent_) ? text(frame) : "none";
  }
  void switch_on() {
    read(kOffAnswer);
    command(0.0);
    read(kState);
    EXPECT_EQ(report_.condition, DriveCondition::kDisabled) << "its brake is locked";
    EXPECT_EQ(text(family_.codec->enable({})), kRelease);
    ASSERT_EQ(read(kReleased), StateReading::kWhole);
    ASSERT_EQ(report_.condition, DriveCondition::kEnabled);
  }

  DriveFamily family_ = make_drive_family(joint(), false, 1e-3);
  DriveReport report_;
  DriveCommand sent_;
};

TEST_F(MyactuatorFamily, ADriveOfUnknownStateIsSwitchedOffUntilItAnswers) {
  EXPECT_EQ(text(family_.codec->disable()), kOff);
  EXPECT_EQ(request(), kOff);
  EXPECT_EQ(read(kOffAnswer), StateReading::kPart) << "no angle yet";
  const std::string first = request();
  const std::string second = request();
  EXPECT_TRUE((first == kAngle && second == kStatus) || (first == kStatus && second == kAngle));
  EXPECT_EQ(text(family_.codec->disable()).substr(0, 5), "141#9") << "confirmed";
}

TEST_F(MyactuatorFamily, StandingByItReadsAngleAndStatusInTurn) {
  read(kOffAnswer);
  ASSERT_EQ(read("241#92000000E8030000"), StateReading::kWhole);  // 10 degrees
  EXPECT_EQ(report_.condition, DriveCondition::kDisabled);
  EXPECT_NEAR(report_.angle_rad, 0.174533, 1e-6);
  EXPECT_EQ(report_.speed_rad_per_s, 0.0) << "of one angle";
  family_.codec->begin_cycle();
  ASSERT_EQ(read(kHealthy), StateReading::kWhole);
  EXPECT_EQ(report_.temperature_degC, 30.0);
  family_.codec->begin_cycle();
  ASSERT_EQ(read("241#92000000F2030000"), StateReading::kWhole);  // a tenth of a degree in 2 ms
  EXPECT_NEAR(report_.speed_rad_per_s, 0.00174533 / 2e-3, 1e-5);
  family_.codec->begin_cycle();
  ASSERT_EQ(read(kHealthy), StateReading::kWhole);
  EXPECT_NEAR(report_.angle_rad, 0.176278 + 0.00174533 / 2.0, 1e-6) << "on its way";
  EXPECT_EQ(family_.codec->status_text(report_.status), "off, without an error");
}

TEST_F(MyactuatorFamily, ItIsOnOnceItsBrakeIsReleasedAndItIsCommanded) {
  switch_on();
  EXPECT_EQ(command(0.0).substr(0, 4), "401#");
  ASSERT_EQ(read("501#018A3D7A58550000"), StateReading::kWhole);
  EXPECT_EQ(report_.condition, DriveCondition::kEnabled);
  EXPECT_NEAR(report_.angle_rad, 35389 * 25.0 / 65535.0 - 12.5 + 0.5 * 25.0 / 65535.0, 1e-9);
  EXPECT_NEAR(report_.speed_rad_per_s, (1957 + 0.5) * 90.0 / 4095.0 - 45.0, 1e-9);
  EXPECT_NEAR(report_.torque_Nm, (0x855 + 0.5) * 48.0 / 4095.0 - 24.0, 1e-9);
  EXPECT_NEAR(report_.current_A, 0.5 * report_.torque_Nm, 1e-12);
  EXPECT_EQ(family_.codec->status_text(report_.status), "running");
  EXPECT_EQ(read(kHealthy), StateReading::kPart) << "requested besides";
  EXPECT_EQ(text(family_.codec->disable()), kOff);
  ASSERT_EQ(read(kOffAnswer), StateReading::kWhole);
  EXPECT_EQ(report_.condition, DriveCondition::kDisabled);
}

TEST_F(MyactuatorFamily, ABrakeMayTakeItsTime) {
  read(kOffAnswer);
  command(0.0);
  read(kState);
  EXPECT_EQ(text(family_.codec->enable({})), kRelease);
  EXPECT_EQ(text(family_.codec->enable({})).substr(0, 4), "401#") << "without torque";
  ASSERT_EQ(read(kState), StateReading::kWhole);
  EXPECT_EQ(report_.condition, DriveCondition::kDisabled);
  ASSERT_TRUE(family_.codec->is_unsolicited(parse(kReleased)));
  family_.codec->record_unsolicited(parse(kReleased));
  command(0.0);
  read(kState);
  EXPECT_EQ(report_.condition, DriveCondition::kEnabled);
}

// The first frame afterwards is only sent back; the second would be obeyed, so that it is "off".
TEST_F(MyactuatorFamily, AfterATimeOutNothingIsCommandedBeforeItIsCleared) {
  switch_on();
  const std::string sent = command(1.0);
  EXPECT_EQ(read("501#" + sent.substr(4)), StateReading::kPart) << "sent back";
  EXPECT_EQ(command(1.0), "none");
  EXPECT_EQ(request(), kOff);
  ASSERT_EQ(read(kOffAnswer), StateReading::kWhole);
  EXPECT_EQ(report_.condition, DriveCondition::kFailed);
  EXPECT_EQ(family_.codec->status_text(report_.status),
            "let go: no command within the drive's time-out");
  EXPECT_EQ(request().substr(0, 5), "141#9");
  EXPECT_EQ(text(family_.codec->clear_error()), kStatus);
  ASSERT_EQ(read(kHealthy), StateReading::kWhole);
  EXPECT_EQ(report_.condition, DriveCondition::kDisabled);
  EXPECT_NE(command(0.0), "none");
}

TEST_F(MyactuatorFamily, ATimeOutIsTold) {
  switch_on();
  command(1.0);
  ASSERT_TRUE(family_.codec->is_unsolicited(parse(kTimedOut)));
  family_.codec->record_unsolicited(parse(kTimedOut));
  EXPECT_EQ(command(1.0), "none");
  ASSERT_EQ(read(kState), StateReading::kWhole);
  EXPECT_EQ(report_.condition, DriveCondition::kFailed);
}

// Standing by, what comes back after a time-out must not be read as an angle of zero.
TEST_F(MyactuatorFamily, ARequestThatIsSentBackIsNoAngle) {
  read(kOffAnswer);
  read("241#92000000E8030000");
  family_.codec->record_unsolicited(parse(kTimedOut));
  EXPECT_EQ(read("241#9200000000000000"), StateReading::kWhole);
  EXPECT_NEAR(report_.angle_rad, 0.174533, 1e-6);
  EXPECT_EQ(report_.condition, DriveCondition::kDisabled) << "it was off";
  ASSERT_EQ(read("241#9200000000000000"), StateReading::kWhole);
  EXPECT_EQ(report_.angle_rad, 0.0) << "the second acts";
}

TEST_F(MyactuatorFamily, AnErrorIsAskedForOrToldAndGoesByItself) {
  switch_on();
  ASSERT_TRUE(family_.codec->is_unsolicited(parse(kUnderVoltage)));
  family_.codec->record_unsolicited(parse(kUnderVoltage));
  EXPECT_EQ(command(1.0), "none");
  EXPECT_EQ(request(), kOff);
  ASSERT_EQ(read(kOffAnswer), StateReading::kWhole);
  EXPECT_EQ(report_.condition, DriveCondition::kFailed);
  EXPECT_EQ(family_.codec->status_text(report_.status), "under-voltage");
  EXPECT_EQ(text(family_.codec->clear_error()), kStatus);
  read(kUnderVoltage);
  EXPECT_EQ(command(0.0), "none") << "it is still there";
  read(kHealthy);
  EXPECT_NE(command(0.0), "none");
}

TEST_F(MyactuatorFamily, OtherFramesAreNoStates) {
  EXPECT_EQ(read("501#027FFF7FF7FF0000"), StateReading::kNone) << "another motor's number";
  EXPECT_EQ(read("501#017FFF7FF7FF00"), StateReading::kNone);
  EXPECT_EQ(read("241#B200000032C0C278"), StateReading::kNone);
  EXPECT_FALSE(family_.codec->is_mine(parse("502#027FFF7FF7FF0000")));
  EXPECT_FALSE(family_.codec->is_mine(parse("141#9A00000000000000")));
  EXPECT_TRUE(family_.codec->is_mine(parse(kTimedOut)));
  EXPECT_FALSE(family_.codec->is_unsolicited(parse(kState)));
}

TEST_F(MyactuatorFamily, NoTorqueBeyondTheLimitAndExactInTheMean) {
  const double kCount_Nm = 48.0 / 4095.0;
  switch_on();
  for (const double wanted : {5.0, 50.0, -50.0}) {
    ASSERT_NE(command(wanted), "none");
    EXPECT_LE(std::abs(sent_.torque_Nm), 5.0 + 1e-12);
    EXPECT_GT(std::abs(sent_.torque_Nm), 5.0 - 2.0 * kCount_Nm);
  }
  double sum = 0.0;
  static_cast<void>(family_.codec->disable());
  for (int i = 0; i < 1000; ++i) {
    ASSERT_NE(command(0.003), "none");
    sum += sent_.torque_Nm;
  }
  EXPECT_NEAR(sum / 1000.0, 0.003, 1e-5);
  EXPECT_EQ(command(std::numeric_limits<double>::quiet_NaN()), "none");
}

TEST_F(MyactuatorFamily, TheStartUp) {
  StartupDialogue& startup = *family_.startup;
  const char* requests[] = {"141#B200000000000000", "141#B501010000000000", "141#B501020000000000",
                            "141#B300000014000000", "141#2003000001000000", "141#9A00000000000000"};
  ASSERT_EQ(startup.steps(), 6);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(text(startup.request(i)), requests[i]);
    EXPECT_EQ(startup.step(i).answered, i < 5);
    EXPECT_EQ(startup.can_be_polled(i), i == 5) << "while it is on";
  }
  EXPECT_EQ(text(startup.presence_request()), requests[0]);
  EXPECT_TRUE(startup.is_presence(parse("241#B200000032C0C278")));
  EXPECT_FALSE(startup.is_presence(parse("242#B200000032C0C278")));
  double found = 0.0;
  EXPECT_EQ(startup.check_answer(3, parse("241#B300000014000000"), &found), Answer::kRight);
  EXPECT_EQ(startup.check_answer(3, parse("241#B300000000000000"), &found), Answer::kWrong);
  EXPECT_EQ(startup.describe({0xB3, Answer::kWrong, 0.0, 20.0}),
            "its time-out (B3) is 0 ms, expected 20");
  EXPECT_EQ(startup.check_answer(3, parse("241#2003000001000000"), &found), Answer::kNone);
  EXPECT_EQ(startup.check_answer(4, parse("241#2003000001000000"), &found), Answer::kRight);
  EXPECT_EQ(startup.check_answer(5, parse(kHealthy), &found), Answer::kNone) << "the codec's";
}

// 2025070202 is 78B41E7Ah, 2026042402 is 78C2F422h.
TEST_F(MyactuatorFamily, AnotherFirmwareIsRefusedWithItsDate) {
  double found = 0.0;
  const CanFrame before = parse("241#B20000007A1EB478");
  const CanFrame from_then = parse("241#B200000022F4C278");
  ASSERT_EQ(myactuator::value_of(from_then), 2026042402U);
  EXPECT_EQ(family_.startup->check_answer(0, before, &found), Answer::kRight);
  EXPECT_EQ(family_.startup->check_answer(0, from_then, &found), Answer::kWrong);
  EXPECT_EQ(family_.startup->describe({0xB2, Answer::kWrong, found, 0.0}),
            "its firmware is of 2026042402, robot.yaml has firmware: V4.2; V4.2 is of dates before "
            "2026042402, V4.4 from it on, and their commands have other ranges");
  EXPECT_EQ(family_.startup->check_answer(0, parse("241#B200000001000000"), &found), Answer::kWrong)
      << "no date";
  EXPECT_EQ(family_.startup->check_answer(0, parse("241#B200000000000000"), &found),
            Answer::kNotYet)
      << "sent back after a time-out";
  EXPECT_EQ(family_.startup->describe({0xB2, Answer::kNone, 0.0, 0.0}).substr(0, 30),
            "its firmware cannot be read, r");
  const DriveFamily v44 = make_drive_family(joint(true), false, 1e-3);
  EXPECT_EQ(v44.startup->check_answer(0, before, &found), Answer::kWrong);
  EXPECT_EQ(v44.startup->check_answer(0, from_then, &found), Answer::kRight);
}

TEST_F(MyactuatorFamily, FromV44OnTheModelMustHaveTheTorqueOfRobotYaml) {
  double found = 0.0;
  const auto answer = [&](const JointConfig& config, const std::string& letters) {
    const DriveFamily family = make_drive_family(config, false, 1e-3);
    EXPECT_EQ(family.startup->check_answer(1, parse("241#B50101524D442D58"), &found),
              Answer::kRight);
    return family.startup->check_answer(2, parse("241#B50102" + letters), &found);
  };
  const std::string x8 = "382D503230";
  const std::string x6 = "362D503230";
  const std::string x4 = "342D503230";
  EXPECT_EQ(answer(joint(true), x8), Answer::kRight);
  EXPECT_EQ(answer(joint(true), x6), Answer::kWrong);
  EXPECT_EQ(found, 6.0);
  EXPECT_EQ(answer(joint(true), x4), Answer::kWrong);
  EXPECT_EQ(family_.startup->describe({0xB5, Answer::kWrong, 6.0, 129.0}),
            "it is an X6, of which a command does not reach to 129 N m (model)");
  JointConfig other = joint(true);
  other.drive.range.torque_Nm = 36.0;
  EXPECT_EQ(answer(other, x4), Answer::kRight);
  EXPECT_EQ(answer(other, x8), Answer::kWrong) << "the torque of an X8 is known";
  EXPECT_EQ(answer(joint(), x6), Answer::kRight) << "the same of all before";
}

TEST_F(MyactuatorFamily, OtherMasters) {
  IntruderRules& rules = *family_.intruders;
  for (const char* command :
       {"401#8A3C7A41EB4CC8D4", "141#8000000000000000", "280#8000000000000000",
        "141#B300000000000000", "141#2005000005000000", "300#7900000000000002",
        "141#A100000064000000"})
    EXPECT_TRUE(rules.is_foreign_command(parse(command))) << command;
  for (const char* harmless :
       {"141#9A00000000000000", "280#9200000000000000", "402#8A3C7A41EB4CC8D4",
        "142#8000000000000000", "300#7900010000000000", "501#017FFF7FF7FF0000"})
    EXPECT_FALSE(rules.is_foreign_command(parse(harmless))) << harmless;
  const CanFrame answer = parse("241#9C1E000000000000");
  EXPECT_FALSE(rules.answers_foreign(answer)) << "nobody requested it";
  rules.record_foreign(parse("141#9C00000000000000"));
  EXPECT_FALSE(rules.answers_foreign(parse("241#921E000000000000")));
  EXPECT_TRUE(rules.answers_foreign(answer));
  EXPECT_FALSE(rules.answers_foreign(answer)) << "once";
}

TEST_F(MyactuatorFamily, AnswersAreFoundInTheFilters) {
  const auto filters = family_.codec->receive_filters();
  const auto passes = [&](const std::string& candump) {
    return std::ranges::any_of(
        filters, [&](const CanFilter& filter) { return filter.passes(parse(candump)); });
  };
  for (const std::string& mine : {kState, kTimedOut, kOff, std::string("280#8000000000000000")})
    EXPECT_TRUE(passes(mine)) << mine;
  EXPECT_FALSE(passes("502#027FFF7FF7FF0000"));
}

}  // namespace
}  // namespace limber::test_myactuator_family
