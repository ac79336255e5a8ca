// The start-up dialogue with CANopen drives: every frame by its bytes, every way to fail.
#include <gtest/gtest.h>

#include <algorithm>

#include "drivers/protocols/canopen_sdo.h"
#include "tests/drivers/driver/fake_cia402.h"

namespace limber {
namespace {

using testing::cia402_robot;
using testing::Cia402Arm;

constexpr int kFault = joint_state_t::DRIVE_FAULT;
constexpr int kOff = joint_state_t::DRIVE_OFF;

TEST(Cia402StartUp, FrameByFrame) {
  Cia402Arm arm;
  ASSERT_TRUE(arm.start());
  const std::vector<std::string> expected = {
      // A node that is not operational does not answer PDOs: four attempts.
      "204#00000000",
      "204#00000000",
      "204#00000000",
      "204#00000000",
      "000#8004",  // pre-operational
      "604#2B40600000000000",
      "604#4041600000000000",  // disable voltage; statusword
      "604#4000100000000000",  // device type
      "604#4002650000000000",  // supported modes
      "604#4076600000000000",  // rated torque
      "604#408F600100000000",
      "604#40E6600100000000",  // encoders
      "604#2F6060000A000000",
      "604#4061600000000000",  // mode 10
      "604#2B726000F4010000",
      "604#4072600000000000",  // 14 of 28 N m
      "604#2B00140514000000",
      "604#4000140500000000",  // watchdog 20 ms
      "604#2B07600001000000",
      "604#4007600000000000",  // connection lost: fault
      "604#2B5E600002000000",
      "604#405E600000000000",  // fault: brake
      "604#2FC2600101000000",
      "604#40C2600100000000",  // 1 *
      "604#2FC26002FD000000",
      "604#40C2600200000000",  // 10^-3 s
      "604#4011200100000000",  // lag of the current loop
      "604#2310200100008040",
      "604#4010200100000000",  // 4
      "604#2310200200409C45",
      "604#4010200200000000",  // 5000 N m/rad
      "604#2310200300000040",
      "604#4010200300000000",  // 2 N m s/rad
      "604#4010200400000000",
      "604#4010200500000000",  // rate and delay of the torque loop
      "604#2300140104020080",
      "604#2F00160000000000",  // RPDO1
      "604#2300160110004060",
      "604#2300160210007160",
      "604#2F00160002000000",
      "604#2F00140201000000",
      "604#2300140104020000",
      "604#2300180184010080",
      "604#2F001A0000000000",  // TPDO1
      "604#23001A0110004160",
      "604#23001A0220006460",
      "604#23001A0320006C60",
      "604#23001A0410007760",
      "604#23001A0510007860",
      "604#23001A062001E460",
      "604#23001A0720006920",
      "604#2F001A0007000000",
      "604#2F00180201000000",
      "604#2300180184010000",
      "000#0104",  // start
  };
  EXPECT_EQ(arm.motors[1].heard, expected);
  arm.half_cycle();
  EXPECT_EQ(arm.sent, std::vector<std::string>({"080#"})) << "OFF: asked for their state";
  EXPECT_TRUE(arm.motors[0].operational);
  EXPECT_EQ(arm.read_status().replies_lost[1], 0);
}

TEST(Cia402StartUp, ADriveWithoutSensorsIsAskedForNone) {
  Cia402Arm arm;
  ASSERT_TRUE(arm.start());
  const std::vector<std::string>& heard = arm.motors[0].heard;
  const auto has = [&](const char* text) {
    return std::find(heard.begin(), heard.end(), text) != heard.end();
  };
  EXPECT_FALSE(has("603#40E6600100000000"));
  EXPECT_FALSE(has("603#4010200100000000"));
  EXPECT_TRUE(has("603#2F001A0005000000"));  // five objects in TPDO1
}

TEST(Cia402StartUp, PowerOffAfterATimeoutIfNothingBrakes) {
  Robot robot = cia402_robot();
  robot.joints[0].drive.watchdog_reaction = NodeWatchdogReaction::kOff;
  Cia402Arm arm(robot);
  arm.motors[0].objects[0x605E00].raw = 2;
  ASSERT_TRUE(arm.start());
  EXPECT_EQ(arm.motors[0].objects[0x605E00].raw, 0U);
}

TEST(Cia402StartUp, CyclePeriodsAsExactAsEightBitsAllow) {
  for (const auto& [rate_hz, count, exponent] : {std::tuple{1000.0, 1U, 0xFDU},
                                                 {500.0, 2U, 0xFDU},
                                                 {4000.0, 25U, 0xFBU},
                                                 {800.0, 125U, 0xFBU},
                                                 {300.0, 33U, 0xFCU}}) {
    Robot robot = cia402_robot();
    robot.rate_hz = rate_hz;
    robot.joints.resize(1);
    Cia402Arm arm(robot);
    ASSERT_TRUE(arm.start()) << rate_hz;
    EXPECT_EQ(arm.motors[0].objects[0x60C201].raw, count) << rate_hz;
    EXPECT_EQ(arm.motors[0].objects[0x60C202].raw, exponent) << rate_hz;
  }
}

void expect_refused(Cia402Arm* arm, const std::string& words) {
  ASSERT_TRUE(arm->run_until(kFault, joint_torque_t::REQUEST_ON, 400)) << words;
  EXPECT_EQ(arm->state->fault, int{joint_state_t::FAULT_CONFIGURATION});
  EXPECT_EQ(arm->state->fault_joint, 1);
  EXPECT_EQ(arm->driver->configuration_problem(), "joint2 (id 0x204): " + words);
  for (int i = 0; i < 20; ++i) arm->cycle_with(joint_torque_t::REQUEST_ON);
  EXPECT_EQ(arm->state->drive_state, kFault);
  EXPECT_NE(arm->motors[0].status(), testing::kOperationEnabled);
}

TEST(Cia402StartUp, AnotherDriveThanDescribedIsRefused) {
  struct Case {
    std::uint32_t object, value;
    const char* words;
  };
  for (const Case& c : {Case{0x100000, 0x00020191, "object 1000h:00 is 401, expected 402"},
                        Case{0x650200, 0x000001FF, "object 6502h:00 is 0, expected 512"},
                        Case{0x607600, 10000, "object 6076h:00 is 10000, expected 28000"},
                        Case{0x608F01, 1U << 20U, "object 608Fh:01 is 1048576, expected 65536"},
                        Case{0x60E601, 262143, "object 60E6h:01 is 262143, expected 262144"},
                        Case{0x201101, 501, "object 2011h:01 is 501, expected 500"},
                        Case{0x201004, 3999, "object 2010h:04 is 3999, expected 4000"},
                        Case{0x201005, 0, "object 2010h:05 is 0, expected 100"}}) {
    Cia402Arm arm;
    arm.motors[1].objects[c.object].raw = c.value;
    expect_refused(&arm, c.words);
  }
}

TEST(Cia402StartUp, WritesThatDoNotTakeAreRefused) {
  for (const auto& [object, words] : {std::pair{0x607200U, "object 6072h:00 is 1000, expected 500"},
                                      {0x140005U, "object 1400h:05 is 0, expected 20"},
                                      {0x600700U, "object 6007h:00 is 0, expected 1"},
                                      {0x60C202U, "object 60C2h:02 is 0, expected -3"},
                                      {0x201001U, "object 2010h:01 is 0, expected 4"},
                                      {0x606100U, "object 6061h:00 is 0, expected 10"}}) {
    Cia402Arm arm;
    arm.motors[1].read_only.insert(object);
    expect_refused(&arm, words);
  }
}

TEST(Cia402StartUp, ARefusalTellsTheReason) {
  Cia402Arm arm;
  arm.motors[1].objects.erase(0x201001);
  expect_refused(&arm, std::string("object 2010h:01 refused: ") +
                           canopen::text_of(canopen::SdoAbort::kNoSuchObject));
}

TEST(Cia402StartUp, NoAnswerIsAskedForFourTimes) {
  Cia402Arm arm;
  arm.motors[1].mute.insert(0x607600);
  expect_refused(&arm, "object 6076h:00 not answered");
  const std::vector<std::string>& heard = arm.motors[1].heard;
  EXPECT_EQ(std::count(heard.begin(), heard.end(), "604#4076600000000000"), 4);
}

TEST(Cia402StartUp, LostAnswersAreAskedForAgain) {
  Cia402Arm arm;
  arm.motors[1].forgetful = true;
  ASSERT_TRUE(arm.start(60 * 60));
  EXPECT_TRUE(arm.motors[1].operational);
  const std::vector<std::string>& heard = arm.motors[1].heard;
  EXPECT_EQ(std::count(heard.begin(), heard.end(), "604#2F6060000A000000"), 2);
}

// SDO servers run beside the drive's cycle: their answers come when they come.
TEST(Cia402StartUp, AnswersBetweenTheCyclesCount) {
  Cia402Arm arm;
  for (int i = 0; i < 70; ++i) {
    arm.driver->transmit(i * 1'000'000);
    arm.driver->poll();
    arm.driver->finish_cycle();
    arm.answer();
  }
  EXPECT_TRUE(arm.motors[1].operational);
}

TEST(Cia402StartUp, AModeMayTakeItsTime) {
  Cia402Arm arm;
  arm.motors[1].read_only.insert(0x606100);
  for (int i = 0; i < 30; ++i) arm.half_cycle();
  arm.motors[1].objects[0x606100].raw = 10;
  EXPECT_TRUE(arm.start());
}

TEST(Cia402StartUp, AStrangersEnabledDriveIsDisabledFirst) {
  Cia402Arm arm;
  arm.motors[1].operational = true;
  arm.motors[1].set_status(testing::kOperationEnabled);
  arm.half_cycle();
  EXPECT_EQ(arm.motors[1].status(), testing::kSwitchOnDisabled);
  arm.half_cycle();  // tells it
  arm.half_cycle();
  EXPECT_EQ(arm.motors[1].heard,
            std::vector<std::string>({"204#00000000", "204#00000000", "000#8004"}));
  EXPECT_TRUE(arm.start());
}

TEST(Cia402StartUp, ADriveThatCannotBeDisabledIsRefused) {
  Cia402Arm arm;
  arm.motors[1].set_status(testing::kOperationEnabled);
  arm.motors[1].stubborn = true;
  expect_refused(&arm, "could not be disabled");
}

TEST(Cia402StartUp, ANodeThatDoesNotStartIsRefused) {
  Cia402Arm arm;
  arm.motors[1].never_operational = true;
  expect_refused(&arm, "sends no state (TPDO1) after the start");
}

}  // namespace
}  // namespace limber
