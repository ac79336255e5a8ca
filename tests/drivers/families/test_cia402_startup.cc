// The start-up dialogue with CANopen drives: every frame by its bytes, every way to fail.
#include <gtest/gtest.h>

#include <algorithm>

#include "drivers/protocols/canopen_sdo.h"
#include "tests/drivers/families/fake_cia402.h"

namespace limber::test_cia402_startup {
namespace {

using testing::cia402_robot;
using testing::Cia402Arm;

constexpr int kFault = joint_state_t::DRIVE_FAULT;
constexpr int kOn = joint_state_t::DRIVE_ON;
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
      "604#408F600200000000",
      "604#4091600100000000",
      "604#4091600200000000",  // counts, gear; the drive has none
      "604#40E6600100000000",  // link encoder
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
      "604#2301180184020080",
      "604#2302180184030080",
      "604#2303180184040080",  // no other TPDOs
      "000#0104",              // start
  };
  EXPECT_EQ(arm.motors[1].heard, expected);
  arm.half_cycle();
  EXPECT_EQ(arm.sent, std::vector<std::string>({"080#"})) << "OFF: asked for their state";
  EXPECT_TRUE(arm.motors[0].operational);
  EXPECT_EQ(arm.read_status().replies_lost[1], 0);
}

/// What a drive heard from the first mention of an object's index on.
std::vector<std::string> heard_from(const testing::FakeCia402& motor, const std::string& start) {
  const auto first = std::find_if(
      motor.heard.begin(), motor.heard.end(),
      [&](const std::string& frame) { return frame.compare(0, start.size(), start) == 0; });
  return {first, motor.heard.end()};
}

// Eight bytes at most: status and position, velocity and torque. The fourth TPDO is not there.
TEST(Cia402StartUp, TwoTpdosOnAClassicBus) {
  Cia402Arm arm(cia402_robot(false));
  ASSERT_TRUE(arm.start()) << arm.driver->configuration_problem();
  EXPECT_EQ(heard_from(arm.motors[0], "603#230018"), std::vector<std::string>({
                                                         "603#2300180183010080",
                                                         "603#2F001A0000000000",  // TPDO1
                                                         "603#23001A0110004160",
                                                         "603#23001A0220006460",
                                                         "603#2F001A0002000000",
                                                         "603#2F00180201000000",
                                                         "603#2300180183010000",
                                                         "603#2301180183020080",
                                                         "603#2F011A0000000000",  // TPDO2
                                                         "603#23011A0120006C60",
                                                         "603#23011A0210007760",
                                                         "603#2F011A0002000000",
                                                         "603#2F01180201000000",
                                                         "603#2301180183020000",
                                                         "603#2302180183030080",
                                                         "603#2303180183040080",  // not there
                                                         "000#0103",
                                                     }));
  EXPECT_TRUE(arm.driver->configuration_warnings().empty());
  EXPECT_EQ(arm.read_status().replies_invalid[0], 0);
}

// With torque sensor and link encoder: the current in TPDO2, the link's side in TPDO3.
TEST(Cia402StartUp, ThreeTpdosOfADriveWithSensors) {
  Cia402Arm arm(cia402_robot(false));
  ASSERT_TRUE(arm.start()) << arm.driver->configuration_problem();
  EXPECT_EQ(heard_from(arm.motors[1], "604#230118"), std::vector<std::string>({
                                                         "604#2301180184020080",
                                                         "604#2F011A0000000000",
                                                         "604#23011A0120006C60",
                                                         "604#23011A0210007760",
                                                         "604#23011A0310007860",
                                                         "604#2F011A0003000000",
                                                         "604#2F01180201000000",
                                                         "604#2301180184020000",
                                                         "604#2302180184030080",
                                                         "604#2F021A0000000000",
                                                         "604#23021A012001E460",
                                                         "604#23021A0220006920",
                                                         "604#2F021A0002000000",
                                                         "604#2F02180201000000",
                                                         "604#2302180184030000",
                                                         "604#2303180184040080",
                                                         "000#0104",
                                                     }));
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
                                                 {2500.0, 4U, 0xFCU},
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

// A drive behind a gear counts turns of the motor: 16384 * 2401 / 15 a turn of the joint.
TEST(Cia402StartUp, CountsOfTheMotorTimesTheGear) {
  Robot robot = cia402_robot();
  robot.joints[1].drive.counts_per_turn = 2622532.2666667;
  Cia402Arm arm(robot);
  auto& objects = arm.motors[1].objects;
  objects[0x608F01].raw = 32768;
  objects[0x608F02].raw = 2;
  objects[0x609100] = {1, 2};
  objects[0x609101] = {4, 2401};
  objects[0x609102] = {4, 15};
  EXPECT_TRUE(arm.start()) << arm.driver->configuration_problem();
  EXPECT_TRUE(arm.driver->configuration_warnings().empty());
}

// What the profile leaves to the maker may be missing; the user is told what that means.
TEST(Cia402StartUp, MissingObjectsAreWarnings) {
  const std::string of = "joint2 (node 4): object ";
  for (const auto& [object, words] :
       {std::pair{0x140005U,
                  "1400h:05 is missing: the drive does not notice that its commands "
                  "have stopped"},
        {0x600700U,
         "6007h:00 is missing: what the drive does when its commands stop is its maker's choice"},
        {0x605E00U, "605Eh:00 is missing: what the drive does in a fault is its maker's choice"},
        {0x60C202U, "60C2h:02 is missing: the drive is not told the cycle time"}}) {
    Cia402Arm arm;
    arm.motors[1].objects.erase(object);
    ASSERT_TRUE(arm.start()) << arm.driver->configuration_problem();
    EXPECT_EQ(arm.driver->configuration_warnings(), std::vector<std::string>{of + words});
    EXPECT_TRUE(arm.run_until(kOn, joint_command_t::REQUEST_ON)) << words;
  }
  Cia402Arm arm;
  for (const std::uint32_t object : {0x140005U, 0x600700U, 0x605E00U, 0x60C201U, 0x60C202U})
    arm.motors[1].objects.erase(object);
  ASSERT_TRUE(arm.start()) << arm.driver->configuration_problem();
  EXPECT_EQ(arm.driver->configuration_warnings().size(), 5U);
}

void expect_refused(Cia402Arm* arm, const std::string& words) {
  ASSERT_TRUE(arm->run_until(kFault, joint_command_t::REQUEST_ON, 4400)) << words;
  EXPECT_EQ(arm->state->fault, int{joint_state_t::FAULT_CONFIGURATION});
  EXPECT_EQ(arm->state->fault_joint, 1);
  EXPECT_EQ(arm->driver->configuration_problem(), "joint2 (node 4): " + words);
  for (int i = 0; i < 20; ++i) arm->cycle_with(joint_command_t::REQUEST_ON);
  EXPECT_EQ(arm->state->drive_state, kFault);
  EXPECT_NE(arm->motors[0].status(), testing::kOperationEnabled);
}

TEST(Cia402StartUp, AnotherDriveThanDescribedIsRefused) {
  struct Case {
    std::uint32_t object, value;
    const char* words;
  };
  for (const Case& c :
       {Case{0x100000, 0x00020191,
             "is no CiA 402 drive: object 1000h has profile 401, expected 402"},
        Case{0x650200, 0x000001FF, "has no cyclic synchronous torque mode (6502h, bit 9 is 0)"},
        Case{0x607600, 10000, "object 6076h:00 is 10000, expected 28000"},
        Case{0x608F01, 1U << 20U,
             "counts 1048576 a turn of the joint (608Fh, 6091h), expected 65536"},
        Case{0x608F02, 0, "counts inf a turn of the joint (608Fh, 6091h), expected 65536"},
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
                           canopen::text_of(canopen::SdoAbort::kNoSuchSub));
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
  ASSERT_TRUE(arm.start(65 * 1100));
  EXPECT_TRUE(arm.motors[1].operational);
  const std::vector<std::string>& heard = arm.motors[1].heard;
  EXPECT_EQ(std::count(heard.begin(), heard.end(), "604#2F6060000A000000"), 2);
}

// SDO servers run beside the drive's cycle: their answers come when they come.
TEST(Cia402StartUp, AnswersBetweenTheCyclesCount) {
  Cia402Arm arm;
  for (int i = 0; i < 80; ++i) {
    arm.driver->transmit(i * 1'000'000, 0);
    arm.driver->poll();
    arm.driver->finish_cycle();
    arm.answer();
  }
  EXPECT_TRUE(arm.motors[1].operational);
}

TEST(Cia402StartUp, AModeMayTakeItsTime) {
  Cia402Arm arm;
  arm.motors[1].read_only.insert(0x606100);
  for (int i = 0; i < 1500; ++i) arm.half_cycle();
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

TEST(Cia402StartUp, ANodeThatSendsHalfAStateIsRefused) {
  Cia402Arm arm(cia402_robot(false));
  arm.motors[1].withheld = {2};
  expect_refused(&arm, "sends some, but not all of its 3 TPDOs after the start");
  EXPECT_EQ(arm.read_status().replies_invalid[1], 0);
}

// SDO servers may take long: a second is theirs, and nobody asks again in the meantime.
TEST(Cia402StartUp, ASlowServerIsNotAskedTwice) {
  Cia402Arm arm;
  arm.motors[1].mute.insert(0x607600);
  for (int i = 0; i < 900; ++i) arm.half_cycle();
  const std::vector<std::string>& heard = arm.motors[1].heard;
  EXPECT_EQ(std::count(heard.begin(), heard.end(), "604#4076600000000000"), 1);
  CanFrame answer;  // 28 000 mN m, at last
  answer.id = 0x584;
  answer.length = 8;
  answer.data = {0x43, 0x76, 0x60, 0x00, 0x60, 0x6D, 0x00, 0x00};
  arm.motor_ends[0]->send(answer);
  EXPECT_TRUE(arm.start()) << arm.driver->configuration_problem();
  EXPECT_EQ(std::count(heard.begin(), heard.end(), "604#4076600000000000"), 1);
}

}  // namespace
}  // namespace limber::test_cia402_startup
