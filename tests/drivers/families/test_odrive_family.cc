// An ODrive axis's family by itself: the parts of a state, what tells on and off, its start-up
// against a drive that reads bytes, and whose frames are whose.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "drivers/drive/configure.h"
#include "drivers/families/drive_family.h"
#include "robots/loader/protocols/drive_protocol.h"
#include "tests/support/frame_text.h"

namespace limber::test_odrive_family {
namespace {

using testing::parse;
using testing::text;

const std::string kEstimates = "049#87F9A23E0000C0BF";  // 2 rad and -1.5 turns/s of the motor
const std::string kNoError = "043#0000000000000000";
const std::string kTorques = "05C#CDCC4CBE000040BE";  // -0.1875 N m made
const std::string kNoTorque = "05C#0000000000000000";
const std::string kRuns = "041#0000000008000100";
const std::string kIsIdle = "041#0000000001000100";

/// Node 2, geared 8 to 1, 12 N m, 0.25 N m/A at the joint, endpoints of 0.6.11.
JointConfig joint() {
  JointConfig made;
  made.drive.protocol = &protocol_named("odrive");
  made.torque_limit_Nm = 9.0;
  made.velocity_limit = std::numbers::pi;
  made.drive.command_id = 0x4E;
  made.drive.reply_id = 0x49;
  made.drive.gear_ratio = 8.0;
  made.drive.peak_torque_Nm = 12.0;
  made.drive.torque_constant_Nm_per_A = 0.25;
  made.drive.counts_per_turn = 8.0 * 16384.0;
  made.drive.watchdog_s = 0.02;
  made.drive.firmware = 0x00060B;
  made.drive.endpoints = {223, 243, 244, 275, 378, 379, 384};
  return made;
}

struct Drive {
  StateReading hear(const std::string& candump, bool late = false) {
    const CanFrame frame = parse(candump);
    EXPECT_TRUE(family.codec->is_mine(frame)) << candump;
    const StateReading reading = family.codec->read_state(frame, late, &report);
    if (reading == StateReading::kNone && family.codec->is_unsolicited(frame))
      family.codec->record_unsolicited(frame);
    return reading;
  }
  DriveCondition cycle(const std::string& errors = kNoError,
                       const std::string& torques = kTorques) {
    family.codec->begin_cycle();
    EXPECT_EQ(hear(kEstimates), StateReading::kPart);
    EXPECT_EQ(hear(errors), StateReading::kPart);
    EXPECT_EQ(hear(torques), StateReading::kWhole);
    return report.condition;
  }
  std::string command(const DriveCommand& wanted, const DriveMemory& memory = {}) {
    CanFrame frame;
    return family.codec->command(wanted, memory, &frame, &sent) ? text(frame) : "none";
  }
  std::string words() const { return family.codec->status_text(report.status); }

  DriveFamily family = make_drive_family(joint(), false, 2e-3);
  DriveReport report;
  DriveCommand sent;
};

TEST(OdriveFamily, AsksForThreePartsOfAState) {
  Drive drive;
  std::string asked;
  for (const CanFrame& frame : drive.family.codec->part_requests()) {
    EXPECT_TRUE(frame.remote);
    asked += text(frame) + " ";
  }
  EXPECT_EQ(asked, "049# 043# 05C# ");
  EXPECT_EQ(text(drive.family.codec->state_request()), "049#");
  const FrameSizes sizes = protocol_named("odrive").frames(joint(), false);
  EXPECT_EQ(sizes.asked, (std::vector<std::uint32_t>{0x49, 0x43, 0x5C}));
}

// 2 rad and 3 pi rad/s of the motor, -0.1875 N m: an eighth of angle and speed, eightfold torque.
TEST(OdriveFamily, AStateIsBehindTheGear) {
  Drive drive;
  EXPECT_EQ(drive.cycle(), DriveCondition::kDisabled);
  EXPECT_NEAR(drive.report.angle_rad, 0.25, 1e-6);
  EXPECT_NEAR(drive.report.speed_rad_per_s, -3.0 * std::numbers::pi / 8.0, 1e-6);
  EXPECT_EQ(drive.report.torque_Nm, -1.5);
  EXPECT_EQ(drive.report.current_A, -6.0);
  EXPECT_NEAR(drive.family.codec->angle_resolution(), std::numbers::pi / 65536.0, 1e-12);
}

TEST(OdriveFamily, PartsCountOnceAndByTheirCycle) {
  Drive drive;
  drive.family.codec->begin_cycle();
  EXPECT_EQ(drive.hear(kTorques), StateReading::kPart);
  EXPECT_EQ(drive.hear(kTorques), StateReading::kNone);
  EXPECT_EQ(drive.hear(kEstimates), StateReading::kPart);
  drive.family.codec->begin_cycle();
  EXPECT_EQ(drive.hear(kNoError), StateReading::kPart) << "of another cycle";
  EXPECT_EQ(drive.hear(kNoError, true), StateReading::kWhole);
  EXPECT_EQ(drive.hear("049#87F9A23E0000C0"), StateReading::kNone) << "seven bytes";
  EXPECT_EQ(drive.hear("049#0000C07F0000C0BF"), StateReading::kNone) << "not a number";
  EXPECT_EQ(drive.hear("049#"), StateReading::kNone);
}

TEST(OdriveFamily, ItsHeartbeatTellsThatItRuns) {
  Drive drive;
  EXPECT_EQ(text(drive.family.codec->enable({})), "047#08000000");
  EXPECT_EQ(drive.cycle(), DriveCondition::kDisabled) << "not told yet";
  // 0.15 s of 2 ms, and not while a heartbeat may come
  for (int cycle = 1; cycle < 75; ++cycle) {
    ASSERT_EQ(text(drive.family.codec->enable({})), "049#") << cycle;
    drive.cycle();
  }
  EXPECT_EQ(text(drive.family.codec->enable({})), "047#08000000");
  EXPECT_EQ(drive.hear(kRuns), StateReading::kNone);
  EXPECT_EQ(drive.cycle(), DriveCondition::kEnabled);
  EXPECT_EQ(drive.words(), "closed loop");
  drive.hear(kIsIdle);
  EXPECT_EQ(drive.cycle(), DriveCondition::kDisabled);
  EXPECT_EQ(drive.words(), "idle");
  drive.hear(kRuns);
  EXPECT_EQ(text(drive.family.codec->disable()), "047#01000000");
  EXPECT_EQ(drive.cycle(), DriveCondition::kDisabled) << "of before";
  drive.hear("041#00000000010E0100");
  drive.cycle();
  EXPECT_EQ(drive.words(), "idle: not calibrated");
}

TEST(OdriveFamily, AnErrorOrItsTraceIsAFailure) {
  Drive drive;
  drive.hear(kRuns);
  EXPECT_EQ(drive.cycle("043#0000000100000000"), DriveCondition::kFailed);
  EXPECT_EQ(drive.words(), "error: watchdog expired");
  EXPECT_EQ(drive.cycle("043#0000000000040000"), DriveCondition::kFailed) << "disarmed by it";
  EXPECT_EQ(drive.words(), "error: over-current");
  EXPECT_EQ(text(drive.family.codec->clear_error()), "058#");
  EXPECT_EQ(drive.cycle(), DriveCondition::kDisabled);
}

// 0.05 of 9 N m: 0.45; 0.5 N m are commanded, none is made.
TEST(OdriveFamily, ADriveThatLetsGoIsKnownByItsTorqueBeforeTheHeartbeat) {
  Drive drive;
  drive.hear(kRuns);
  for (int cycle = 0; cycle < 9; ++cycle) {
    drive.command({.torque_Nm = 0.5});
    ASSERT_EQ(drive.cycle(kNoError, kNoTorque), DriveCondition::kEnabled) << cycle;
  }
  EXPECT_EQ(drive.cycle(kNoError, kNoTorque), DriveCondition::kFailed);
  EXPECT_EQ(drive.words(), "makes no torque: switched off or reset");
  EXPECT_EQ(drive.cycle(), DriveCondition::kEnabled) << "one that it makes";
  drive.command({.torque_Nm = 0.4});
  for (int cycle = 0; cycle < 20; ++cycle)
    ASSERT_EQ(drive.cycle(kNoError, kNoTorque), DriveCondition::kEnabled) << "too little to tell";
}

TEST(OdriveFamily, TorqueIsTheMotorsAndWithinTheLimit) {
  Drive drive;
  EXPECT_EQ(drive.command({.torque_Nm = -1.6}), "04E#CDCC4CBE");
  EXPECT_EQ(drive.sent.torque_Nm, -1.6);
  EXPECT_EQ(drive.command({.torque_Nm = 100.0}), text(parse("04E#0000903F"))) << "9 / 8";
  EXPECT_EQ(drive.sent.torque_Nm, 9.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(drive.command({.torque_Nm = nan}), "none");
  EXPECT_EQ(drive.command({.kp_Nm_per_rad = std::numeric_limits<double>::infinity()}), "none");
  // Stiffness is made of the state seen last: 4 (0.5 - 0.25) + 2 (0 + 0.25) = 1.5 N m.
  DriveMemory memory;
  memory.seen.angle_rad = 0.25;
  memory.seen.speed_rad_per_s = -0.25;
  const DriveCommand held{.angle_rad = 0.5, .kp_Nm_per_rad = 4.0, .kd_Nms_per_rad = 2.0};
  EXPECT_EQ(drive.command(held, memory), "04E#00000000") << "seen too long ago";
  memory.recent = true;
  EXPECT_EQ(drive.command(held, memory), text(parse("04E#0000403E")));
  EXPECT_EQ(drive.sent.torque_Nm, 1.5);
  EXPECT_EQ(drive.sent.kp_Nm_per_rad, 0.0);
}

/// Reads bytes, and answers with others: what is written is kept unless it is to be lost.
struct Axis {
  std::map<int, std::string> raw = {{223, "01"},       {243, "00000000"}, {244, "00"},
                                    {275, "0A000000"}, {378, "03"},       {379, "01"},
                                    {384, "00000040"}};
  std::string estimates = "0000000000000000";
  bool takes = true;

  std::string answer(const std::string& frame) {
    const std::string id = frame.substr(0, 3);
    const std::string data = frame.substr(4);
    if (id == "040") return "040#0204040000060B00";
    if (id == "049") return "049#" + estimates;
    if (id == "04B" && takes) {
      raw[378] = data.substr(0, 2);
      raw[379] = data.substr(8, 2);
    }
    if (id == "04F" && takes) raw[384] = data.substr(0, 8);
    if (id != "044") return "";
    const int number = std::stoi(data.substr(4, 2) + data.substr(2, 2), nullptr, 16);
    if (data.substr(0, 2) == "00") return "045#00" + data.substr(2, 4) + "00" + raw.at(number);
    if (takes) raw[number] = data.substr(8);
    return "";
  }
};

/// Ends as a real one does; empty: done.
std::string problem_of(Axis* axis) {
  const DriveFamily family = make_drive_family(joint(), false, 2e-3);
  ConfigureDialogue dialogue(family);
  for (int cycle = 0; cycle < 100 && !dialogue.done() && !dialogue.failed(); ++cycle) {
    const std::string answer = axis->answer(text(dialogue.next_frame()));
    if (dialogue.expects_state()) {
      dialogue.receive_state(false);
    } else if (!answer.empty()) {
      EXPECT_TRUE(dialogue.receive(parse(answer))) << answer;
    }
    dialogue.close_cycle();
  }
  EXPECT_NE(dialogue.done(), dialogue.failed());
  return dialogue.done() ? "" : family.startup->describe(dialogue.failure());
}

// Twice pi rad/s are 8 turns/s of the motor; 12 / 8 N m at a sixth of a N m s a turn are 9.
TEST(OdriveStartup, SetsWhatItsMakerLeavesOff) {
  Axis axis;
  EXPECT_EQ(problem_of(&axis), "");
  EXPECT_EQ(axis.raw[243], "0AD7A33C") << "0.02 s";
  EXPECT_EQ(axis.raw[244], "01");
  EXPECT_EQ(axis.raw[275], "00000000");
  EXPECT_EQ(axis.raw[378], "01");
  EXPECT_EQ(axis.raw[379], "01");
  EXPECT_EQ(axis.raw[384], "00008841") << "17 turns/s";
}

TEST(OdriveStartup, NamesWhatDiffers) {
  Axis stuck;
  stuck.takes = false;
  EXPECT_EQ(problem_of(&stuck), "vel_limit is 2, expected 17");
  Axis uncalibrated;
  uncalibrated.estimates = "0000C07F0000C07F";
  EXPECT_EQ(problem_of(&uncalibrated), "no position estimate: calibrate its encoder");
  Axis busy;
  busy.raw[223] = "03";
  EXPECT_EQ(problem_of(&busy), "current_state is 3, expected 1");
  JointConfig other = joint();
  other.drive.firmware = 0x00060A;
  const DriveFamily family = make_drive_family(other, false, 2e-3);
  double found = 0.0;
  ASSERT_EQ(family.startup->check_answer(0, parse("040#0204040000060B00"), &found), Answer::kWrong);
  EXPECT_NE(family.startup->describe({100, Answer::kWrong, found, 10.0})
                .find("firmware 0.6.11, or of another generation, expected 0.6.10"),
            std::string::npos);
  EXPECT_EQ(family.startup->describe({1, Answer::kNone, 0.0, 0.02}),
            "endpoint 243 (watchdog_timeout) not answered");
  EXPECT_EQ(family.startup->describe({100, Answer::kNone, 0.0, 0.0}), "it does not answer");
}

TEST(OdriveStartup, NothingIsWrittenBeforeTheEndpointsAreKnownToBeRight) {
  const DriveFamily family = make_drive_family(joint(), false, 2e-3);
  int reads = 0;
  for (int step = 0; step < family.startup->steps(); ++step) {
    const std::string frame = text(family.startup->request(step));
    if (frame.starts_with("044#01")) break;
    if (frame.starts_with("044#00")) ++reads;
    EXPECT_EQ(family.startup->step(step).answered,
              !frame.starts_with("04B") && !frame.starts_with("04F"));
  }
  EXPECT_EQ(reads, 4) << "state, velocity limit, control mode, input mode";
}

TEST(OdriveIntruders, WhoeverCommandsIsHeard) {
  const DriveFamily family = make_drive_family(joint(), false, 2e-3);
  for (const char* frame : {"04E#00000000", "047#08000000", "042#", "058#", "056#00",
                            "044#01F30000", "7E7#01000000", "04C#0000000000000000", "05F#"})
    EXPECT_TRUE(family.intruders->is_foreign_command(parse(frame))) << frame;
  for (const char* frame :
       {"049#", "044#00F3000000000000", "7E6#", "06E#00000000", "06E#", "7E6#0502000000003000"})
    EXPECT_FALSE(family.intruders->is_foreign_command(parse(frame))) << frame;
  CanFrame asked = parse("04E#");
  asked.remote = true;
  EXPECT_FALSE(family.intruders->is_foreign_command(asked));
  CanFrame extended = parse("04E#00000000");
  extended.extended = true;
  EXPECT_FALSE(family.intruders->is_foreign_command(extended));
}

TEST(OdriveIntruders, AnAnswerToSomebodyElseIsLeftToHim) {
  const DriveFamily family = make_drive_family(joint(), false, 2e-3);
  IntruderRules& rules = *family.intruders;
  EXPECT_FALSE(rules.answers_foreign(parse(kEstimates)));
  CanFrame asked = parse("049#");
  asked.remote = true;
  rules.record_foreign(asked);
  rules.record_foreign(parse("044#00F3000000000000"));
  EXPECT_TRUE(rules.answers_foreign(parse(kEstimates)));
  EXPECT_FALSE(rules.answers_foreign(parse(kEstimates))) << "once";
  EXPECT_TRUE(rules.answers_foreign(parse("045#00F3000000000000")));
  rules.record_foreign(asked);
  rules.begin_cycle();
  EXPECT_FALSE(rules.answers_foreign(parse(kEstimates))) << "too late";
}

}  // namespace
}  // namespace limber::test_odrive_family
