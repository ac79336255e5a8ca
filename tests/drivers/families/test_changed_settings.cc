// Settings of drives that are changed past the bus while they are on.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/drivers/families/fake_cia402.h"

namespace limber::test_changed_settings {
namespace {

using testing::Cia402Arm;
using testing::FakeArm;
using testing::FakeMotor;
using testing::test_robot;

constexpr int kKeep = joint_command_t::REQUEST_KEEP;
constexpr int kOn = joint_state_t::DRIVE_ON;
constexpr int kHold = joint_state_t::DRIVE_HOLD;
constexpr int kDriveError = joint_state_t::FAULT_DRIVE_ERROR;

/// Cycles until the drives are no longer ON, or -1.
int cycles_until_off(testing::DrivenArm* arm, int most) {
  for (int i = 1; i <= most; ++i) {
    arm->cycle_with(kKeep);
    if (arm->state->drive_state != kOn) return i;
  }
  return -1;
}
void run(testing::DrivenArm* arm, int cycles) {
  for (int i = 0; i < cycles; ++i) arm->cycle_with(kKeep);
}
std::string text_of(const testing::DrivenArm& arm) {
  return arm.driver->fault_text(arm.state->fault, arm.state->fault_joint,
                                arm.driver->fault_detail());
}

/// The registers that a motor was asked for while it was on.
std::vector<int> asked(const FakeMotor& motor) {
  std::vector<int> registers;
  for (const CanFrame& frame : motor.questions) registers.push_back(frame.data[3]);
  return registers;
}

// Registers 21, 22, 23: ranges; 10: mode; 9: time-out. Two motors on the bus take turns.
TEST(ChangedSettings, ABusAsksForOneRegisterEveryTwentyCycles) {
  FakeArm arm(test_robot(2));
  ASSERT_TRUE(arm.switch_on());
  std::size_t before = 0;
  for (int i = 1; i <= 260; ++i) {
    arm.cycle_with(kKeep);
    const std::size_t now = arm.motors[0].questions.size() + arm.motors[1].questions.size();
    EXPECT_EQ(now, before + (i % 20 == 0 ? 1 : 0)) << i;
    before = now;
  }
  EXPECT_EQ(asked(arm.motors[1]), std::vector({21, 22, 23, 10, 9, 21, 22}));
  EXPECT_EQ(asked(arm.motors[0]), std::vector({21, 22, 23, 10, 9, 21}));
  const CanFrame& frame = arm.motors[1].questions[3];
  EXPECT_EQ(frame.id, 0x7FFU);
  EXPECT_TRUE(frame.fd && frame.bitrate_switch);
  const std::array<std::uint8_t, 8> bytes = {2, 0, 0x33, 10, 0, 0, 0, 0};
  EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), frame.data.begin()));
  const driver_status_t& status = arm.read_status();
  EXPECT_EQ(status.replies_invalid[0] + status.replies_invalid[1], 0);
  EXPECT_EQ(status.replies_late[0] + status.replies_lost[0], 0);
}

TEST(ChangedSettings, EveryBusAsksForItself) {
  FakeArm arm(test_robot(3, 2));  // joints 1 and 3 on one, 2 on the other
  ASSERT_TRUE(arm.switch_on());
  run(&arm, 200);
  EXPECT_EQ(arm.motors[0].questions.size(), 5U);
  EXPECT_EQ(arm.motors[1].questions.size(), 10U);
  EXPECT_EQ(arm.motors[2].questions.size(), 5U);
}

TEST(ChangedSettings, BothMotorsOfAJointAreAsked) {
  Robot robot = test_robot(1);
  testing::add_second_motor(&robot.joints[0]);
  FakeArm arm(robot);
  ASSERT_TRUE(arm.switch_on());
  run(&arm, 200);
  EXPECT_EQ(arm.motors[1].questions.size(), 5U);
  arm.motors[1].registers[9] = 0;
  EXPECT_GT(cycles_until_off(&arm, 440), 0);
  EXPECT_EQ(arm.state->fault, kDriveError);
  EXPECT_EQ(text_of(arm).substr(0, 26), "register 9 is 0, expected ");
}

// At the latest after the five registers of both motors, and the wrong one once more.
TEST(ChangedSettings, AreADriveErrorThatNamesTheSetting) {
  for (int reg : {9, 10, 21, 22, 23}) {
    FakeArm arm(test_robot(2));
    ASSERT_TRUE(arm.switch_on());
    run(&arm, 77);
    arm.motors[1].registers[reg] = 0;
    const int cycles = cycles_until_off(&arm, 300);
    EXPECT_GT(cycles, 40) << reg << ": not for one wrong answer";
    EXPECT_LE(cycles, 240) << reg;
    EXPECT_EQ(arm.state->drive_state, kHold);
    EXPECT_EQ(arm.state->fault, kDriveError);
    EXPECT_EQ(arm.state->fault_joint, 1);
    EXPECT_NE(arm.state->joint_flags[1] & joint_state_t::JOINT_DRIVE_ERROR, 0);
    EXPECT_EQ(arm.state->joint_flags[0] & joint_state_t::JOINT_DRIVE_ERROR, 0);
  }
}

// 20 ms are 400 counts of 50 us.
TEST(ChangedSettings, AreToldInWords) {
  FakeArm arm(test_robot(2));
  ASSERT_TRUE(arm.switch_on());
  arm.motors[0].registers[9] = 0;
  ASSERT_GT(cycles_until_off(&arm, 300), 0);
  EXPECT_EQ(text_of(arm),
            "register 9 is 0, expected 400: changed past the bus while the drive was on; end what "
            "else writes to it, or find out why it restarted");
  // Of the other joint nothing but its status can be told.
  EXPECT_EQ(arm.driver->fault_text(kDriveError, 1, 1), "enabled");
}

TEST(ChangedSettings, AreAcknowledgedAfterTheStartUpHasWrittenThemAgain) {
  FakeArm arm(test_robot(2));
  ASSERT_TRUE(arm.switch_on());
  arm.motors[1].registers[9] = 0;
  ASSERT_GT(cycles_until_off(&arm, 300), 0);
  EXPECT_FALSE(arm.run_until(kOn, joint_command_t::REQUEST_ACKNOWLEDGE, 100));
  EXPECT_EQ(arm.state->drive_state, kHold);
  ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_OFF, joint_command_t::REQUEST_OFF));
  EXPECT_EQ(arm.motors[1].registers[9], 400U);
  ASSERT_TRUE(arm.run_until(kOn, joint_command_t::REQUEST_ON));
  EXPECT_EQ(cycles_until_off(&arm, 500), -1);
}

TEST(ChangedSettings, AWrongAnswerForOneTimeIsNone) {
  FakeArm arm(test_robot(1));
  ASSERT_TRUE(arm.switch_on());
  for (int i = 0; i < 10; ++i) {
    arm.motors[0].registers[21] = 0;
    run(&arm, 20);
    arm.motors[0].set_float(21, 12.5);
    run(&arm, 20);
  }
  EXPECT_EQ(arm.state->drive_state, kOn);
}

TEST(ChangedSettings, NothingIsAskedWhileTheDrivesHoldOrAreOff) {
  FakeArm arm(test_robot(1));
  ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_OFF, kKeep));
  run(&arm, 100);
  ASSERT_TRUE(arm.run_until(kOn, joint_command_t::REQUEST_ON));
  run(&arm, 1);
  arm.cycle_with(joint_command_t::REQUEST_HOLD);
  for (FakeMotor& motor : arm.motors) motor.frames.clear();
  run(&arm, 100);
  EXPECT_TRUE(arm.motors[0].questions.empty());
  for (const CanFrame& frame : arm.motors[0].frames) EXPECT_EQ(frame.id, 1U);
}

/// Answers to questions come `hidden`: 0 at once, 1 with the next cycle's replies, 2 never.
class SlowTeller final : public FakeArm {
 public:
  using FakeArm::FakeArm;

  void answer() override {
    for (const CanFrame& late : waiting_) motor_ends[0]->send(late);
    waiting_.clear();
    CanFrame frame;
    CanFrame reply;
    while (motor_ends[0]->receive(std::span(&frame, 1)) == 1) {
      for (FakeMotor& motor : motors) {
        if (!motor.handle(frame, &reply)) continue;
        const bool told = frame.id == 0x7FF && frame.data[2] == 0x33;
        if (!told || delay == 0) motor_ends[0]->send(reply);
        if (told && delay == 1) waiting_.push_back(reply);
      }
    }
  }

  int delay = 0;

 private:
  std::vector<CanFrame> waiting_;
};

TEST(ChangedSettings, AnAnswerThatIsLateOrLostIsNoReplyOfTheMotor) {
  for (int delay : {1, 2}) {
    SlowTeller arm(test_robot(2));
    ASSERT_TRUE(arm.switch_on());
    arm.delay = delay;
    run(&arm, 500);
    EXPECT_EQ(arm.state->drive_state, kOn) << delay;
    const driver_status_t& status = arm.read_status();
    for (int i = 0; i < 2; ++i) {
      EXPECT_EQ(status.replies_invalid[i], 0) << delay;
      EXPECT_EQ(status.replies_late[i], 0) << delay;
      EXPECT_EQ(status.replies_lost[i], 0) << delay;
    }
  }
}

TEST(ChangedSettings, ALateAnswerCountsAsWellAsAnother) {
  SlowTeller arm(test_robot(2));
  ASSERT_TRUE(arm.switch_on());
  arm.delay = 1;
  arm.motors[1].registers[10] = 2;
  EXPECT_GT(cycles_until_off(&arm, 260), 0);
  EXPECT_EQ(text_of(arm).substr(0, 28), "register 10 is 2, expected 1");
}

/// Runs a CANopen arm, in which the object of the second drive is changed.
void expect_found(std::uint32_t object, std::uint32_t raw, const std::string& words) {
  Cia402Arm arm;
  ASSERT_TRUE(arm.switch_on());
  run(&arm, 50);
  arm.motors[1].objects.at(object).raw = raw;
  EXPECT_GT(cycles_until_off(&arm, 900), 0) << words;
  EXPECT_EQ(arm.state->fault, kDriveError);
  EXPECT_EQ(arm.state->fault_joint, 1);
  EXPECT_EQ(text_of(arm).substr(0, words.size()), words);
}

TEST(ChangedSettings, ObjectsOfCanopenDrivesAreReadAgain) {
  expect_found(0x140005, 0, "object 1400h:05 is 0, expected 20: changed past the bus");
  expect_found(0x607200, 1000, "object 6072h:00 is 1000, expected 500: changed");
  expect_found(0x606100, 8, "object 6061h:00 is 8, expected 10: changed");
  expect_found(0x605E00, 0, "object 605Eh:00 is 0, expected 2: changed");
  expect_found(0x201001, 0x40000000, "object 2010h:01 is 2, expected 4: changed");
  expect_found(0x608F01, 32768, "counts 32768 a turn of the joint (608Fh, 6091h), expected 65536");
}

// SDO upload requests behind the SYNC, of nothing that is written and of nothing with power in it.
TEST(ChangedSettings, QuestionsToCanopenDrivesAreTheLastFramesOfACycle) {
  Cia402Arm arm;
  ASSERT_TRUE(arm.switch_on());
  std::vector<std::string> questions;
  arm.on_bus = [&](int, const std::vector<std::string>& sent) {
    const auto sync = std::ranges::find(sent, "080#");
    ASSERT_NE(sync, sent.end());
    for (auto behind = sync + 1; behind != sent.end(); ++behind) questions.push_back(*behind);
  };
  run(&arm, 1000);
  ASSERT_EQ(questions.size(), 50U);
  for (std::size_t i = 0; i < questions.size(); ++i) {
    EXPECT_EQ(questions[i].substr(0, 6), i % 2 == 0 ? "604#40" : "603#40") << questions[i];
    EXPECT_NE(questions[i].substr(6, 4), "4160") << "the statusword";
  }
  EXPECT_EQ(questions[0], "604#4000100000000000");  // device type
  EXPECT_TRUE(std::ranges::count(questions, "604#4000140500000000") > 0);
  EXPECT_EQ(arm.state->drive_state, kOn);
}

// What the drive does not have was told at its start; a drive that refuses says nothing.
TEST(ChangedSettings, ObjectsThatAreMissingAreNoChange) {
  Cia402Arm arm;
  for (std::uint32_t object : {0x140005U, 0x600700U, 0x605E00U})
    arm.motors[1].objects.erase(object);
  ASSERT_TRUE(arm.switch_on());
  EXPECT_EQ(cycles_until_off(&arm, 2000), -1);
  arm.motors[0].objects.erase(0x607200);
  EXPECT_EQ(cycles_until_off(&arm, 2000), -1);
  EXPECT_EQ(arm.read_status().replies_invalid[0], 0);
}

TEST(ChangedSettings, ASilentServerIsNoSilentDrive) {
  Cia402Arm arm;
  ASSERT_TRUE(arm.switch_on());
  arm.motors[1].mute = {0x100000};
  EXPECT_EQ(cycles_until_off(&arm, 1000), -1);
  EXPECT_EQ(arm.read_status().replies_lost[1], 0);
}

}  // namespace
}  // namespace limber::test_changed_settings
