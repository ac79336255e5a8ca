// Who else is on the bus: another master, another motor with the same id, replayed replies.
#include <gtest/gtest.h>

#include "drivers/protocols/mit.h"
#include "tests/drivers/fake_arm.h"

namespace limber::test_bus_intruders {
namespace {

using testing::FakeArm;
using testing::test_robot;

/// With somebody else on the bus, who speaks before the motors do.
class IntrudedArm final : public FakeArm {
 public:
  using FakeArm::FakeArm;

  void answer() override {
    if (intruder == nullptr) intruder = memory[0]->attach();
    for (const CanFrame& frame : intrusion) intruder->send(frame);
    FakeArm::answer();
  }

  std::unique_ptr<CanBus> intruder;
  std::vector<CanFrame> intrusion;
};

/// Cycles until the drives are no longer ON, or -1.
int cycles_until_off(IntrudedArm* arm, int most) {
  for (int i = 1; i <= most; ++i) {
    arm->cycle_with(joint_command_t::REQUEST_KEEP);
    if (arm->state->drive_state != joint_state_t::DRIVE_ON) return i;
  }
  return -1;
}

CanFrame reply_now(IntrudedArm* arm, int motor) {
  CanFrame reply;
  const DriveConfig& drive = arm->robot.joints[static_cast<std::size_t>(motor)].drive;
  arm->motors[static_cast<std::size_t>(motor)].handle(
      mit::encode_state_request(static_cast<std::uint16_t>(drive.command_id), true), &reply);
  return reply;
}

TEST(BusIntruders, AnotherMastersCommandStopsTheArmWithTheReason) {
  IntrudedArm arm(test_robot(3));
  ASSERT_TRUE(arm.switch_on());
  CanFrame command;
  command.id = arm.robot.joints[1].drive.command_id;
  command.fd = true;
  command.length = 8;
  arm.intrusion = {command};
  EXPECT_EQ(cycles_until_off(&arm, 10), 1);
  EXPECT_EQ(arm.state->drive_state, +joint_state_t::DRIVE_HOLD);
  EXPECT_EQ(arm.state->fault, +joint_state_t::FAULT_FOREIGN_COMMAND);
  EXPECT_EQ(arm.state->fault_joint, 1);
  EXPECT_EQ(arm.driver->fault_text(arm.state->fault, 1, arm.driver->fault_detail()),
            "joint2 (id 0x2)");
}

/// TMAX (register 23) of motor 2: 8 N m become 10. Written, or stored.
CanFrame register_frame(std::uint8_t operation) {
  CanFrame frame;
  frame.id = 0x7FF;
  frame.length = 8;
  const std::uint8_t bytes[8] = {2, 0, operation, 23, 0x00, 0x00, 0x20, 0x41};
  std::copy_n(bytes, 8, frame.data.begin());
  return frame;
}

// Its range would scale every torque from here on.
TEST(BusIntruders, AWrittenRegisterStopsTheArmWithTheReason) {
  for (std::uint8_t operation : {0x55, 0xAA}) {
    IntrudedArm arm(test_robot(3));
    ASSERT_TRUE(arm.switch_on());
    arm.intrusion = {register_frame(operation)};
    EXPECT_EQ(cycles_until_off(&arm, 10), 1);
    EXPECT_EQ(arm.state->fault, +joint_state_t::FAULT_FOREIGN_COMMAND);
    EXPECT_EQ(arm.state->fault_joint, 1);
  }
}

TEST(BusIntruders, ARegisterThatIsReadOrOfAnotherDriveDoesNothing) {
  IntrudedArm arm(test_robot(3));
  ASSERT_TRUE(arm.switch_on());
  CanFrame other = register_frame(0x55);
  other.data[0] = 9;
  arm.intrusion = {other};
  EXPECT_EQ(cycles_until_off(&arm, 100), -1);
  arm.intrusion = {register_frame(0x33)};
  EXPECT_EQ(cycles_until_off(&arm, 1), -1);
}

// A register's answer has the shape of a state: "disabled", and what its value makes of heat.
TEST(BusIntruders, AnswersToSomebodyElsesReadsAreNoStates) {
  for (const int state :
       {joint_state_t::DRIVE_OFF + 0, joint_state_t::DRIVE_ON + 0, joint_state_t::DRIVE_HOLD + 0}) {
    IntrudedArm arm(test_robot(3));
    ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_OFF, joint_command_t::REQUEST_KEEP));
    if (state != joint_state_t::DRIVE_OFF) {
      ASSERT_TRUE(arm.switch_on());
    }
    if (state == joint_state_t::DRIVE_HOLD) arm.cycle_with(joint_command_t::REQUEST_HOLD);
    constexpr std::uint8_t kBoardVoltage = 60;      // which this driver does not read
    arm.motors[1].set_float(kBoardVoltage, -1e30);  // bytes that would be 73 and 241 degC
    CanFrame read = register_frame(0x33);
    read.data[3] = kBoardVoltage;
    arm.intrusion = {read};
    for (int i = 0; i < 200; ++i) {
      arm.cycle_with(joint_command_t::REQUEST_KEEP);
      ASSERT_EQ(arm.state->drive_state, state) << "cycle " << i;
      ASSERT_EQ(arm.state->temperature_degC[1], 35.0F);
    }
    EXPECT_EQ(arm.read_status().replies_invalid[1], 0);
    EXPECT_EQ(arm.read_status().replies_lost[1], 0);
  }
}

TEST(BusIntruders, AnAnswerThatNobodyAskedForIsStillInvalid) {
  IntrudedArm arm(test_robot(3));
  ASSERT_TRUE(arm.switch_on());
  CanFrame answer;
  arm.motors[1].handle(register_frame(0x33), &answer);
  arm.intrusion = {answer};
  EXPECT_GT(cycles_until_off(&arm, 50), 0);
}

// While nothing has power, too: the settings are compared again after the acknowledgement.
TEST(BusIntruders, AWrittenRegisterOfADriveWithoutPowerIsAFaultThatIsCheckedAgain) {
  IntrudedArm arm(test_robot(3));
  ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_OFF, joint_command_t::REQUEST_KEEP));
  arm.intrusion = {register_frame(0x55)};
  arm.cycle_with(joint_command_t::REQUEST_KEEP);
  EXPECT_EQ(arm.state->drive_state, +joint_state_t::DRIVE_FAULT);
  EXPECT_EQ(arm.state->fault, +joint_state_t::FAULT_FOREIGN_COMMAND);
  arm.intrusion.clear();
  arm.motors[1].set_float(23, 10.5);
  arm.cycle_with(joint_command_t::REQUEST_ACKNOWLEDGE);
  EXPECT_FALSE(arm.run_until(joint_state_t::DRIVE_OFF, joint_command_t::REQUEST_KEEP));
  EXPECT_EQ(arm.state->fault, +joint_state_t::FAULT_CONFIGURATION);
}

TEST(BusIntruders, FramesOfOtherDevicesDoNothing) {
  IntrudedArm arm(test_robot(3));
  ASSERT_TRUE(arm.switch_on());
  CanFrame other;
  other.id = 0x321;
  other.length = 8;
  arm.intrusion = {other, other};
  EXPECT_EQ(cycles_until_off(&arm, 200), -1);
  EXPECT_GT(arm.read_status().frames_foreign[0], 300);
}

TEST(BusIntruders, ReplayedRepliesAreNoticedWithinTenCycles) {
  IntrudedArm arm(test_robot(3));
  ASSERT_TRUE(arm.switch_on());
  arm.intrusion = {reply_now(&arm, 0)};
  const int cycles = cycles_until_off(&arm, 50);
  EXPECT_GT(cycles, 0);
  EXPECT_LE(cycles, 11);
  EXPECT_EQ(arm.state->fault, +joint_state_t::FAULT_REPLY_INVALID);
  EXPECT_EQ(arm.state->fault_joint, 0);
}

bool fresh(const IntrudedArm& arm, int joint) {
  return (arm.state->joint_flags[joint] & joint_state_t::JOINT_FRESH) != 0;
}

// The replay comes first and is believed; the true angle is the second.
TEST(BusIntruders, ADoubtedAngleIsNeitherFreshNorHeldUntilTwoReadingsAgree) {
  IntrudedArm arm(test_robot(3));
  ASSERT_TRUE(arm.switch_on());
  arm.intrusion = {reply_now(&arm, 0)};
  ASSERT_GT(cycles_until_off(&arm, 50), 0);
  ASSERT_EQ(arm.state->fault, +joint_state_t::FAULT_REPLY_INVALID);
  for (int i = 0; i < 300; ++i) {
    arm.cycle_with(joint_command_t::REQUEST_KEEP);
    ASSERT_FALSE(fresh(arm, 0));
    ASSERT_TRUE(fresh(arm, 1));
  }
  EXPECT_EQ(testing::raw_command(arm.motors[0].last()).kp, 0) << "no pull towards that angle";
  EXPECT_GT(testing::raw_command(arm.motors[0].last()).kd, 0);
  EXPECT_GT(testing::raw_command(arm.motors[1].last()).kp, 0) << "the others are held";
  arm.intrusion.clear();
  arm.cycle_with(joint_command_t::REQUEST_KEEP);
  EXPECT_FALSE(fresh(arm, 0)) << "one reading agrees with nothing";
  arm.cycle_with(joint_command_t::REQUEST_KEEP);
  EXPECT_TRUE(fresh(arm, 0));
}

TEST(BusIntruders, UnreadableFramesAfterTheRepliesCountToo) {
  IntrudedArm arm(test_robot(3));
  ASSERT_TRUE(arm.switch_on());
  CanFrame frame = reply_now(&arm, 0);
  frame.length = 3;
  int cycles = 0;
  for (; cycles < 50 && arm.state->drive_state == joint_state_t::DRIVE_ON; ++cycles) {
    arm.intruder->send(frame);  // the cycle is over: it is found at the start of the next
    arm.cycle_with(joint_command_t::REQUEST_KEEP);
  }
  EXPECT_LE(cycles, 11);
  EXPECT_EQ(arm.state->fault, +joint_state_t::FAULT_REPLY_INVALID);
  EXPECT_EQ(arm.state->fault_joint, 0);
}

TEST(BusIntruders, AFewDoubledRepliesAreBridged) {
  IntrudedArm arm(test_robot(3));
  ASSERT_TRUE(arm.switch_on());
  for (int second = 0; second < 3; ++second) {
    arm.intrusion = {reply_now(&arm, 0)};
    EXPECT_EQ(cycles_until_off(&arm, 5), -1);
    arm.intrusion.clear();
    EXPECT_EQ(cycles_until_off(&arm, 1000), -1);
  }
}

TEST(BusIntruders, AfterTheCauseIsGoneTheFaultIsAcknowledged) {
  IntrudedArm arm(test_robot(3));
  ASSERT_TRUE(arm.switch_on());
  arm.intrusion = {reply_now(&arm, 0)};
  ASSERT_GT(cycles_until_off(&arm, 50), 0);
  arm.intrusion.clear();
  EXPECT_TRUE(arm.run_until(joint_state_t::DRIVE_ON, joint_command_t::REQUEST_ACKNOWLEDGE, 400));
}

// Drives have their own numbers for what went wrong; they are published as they are.
TEST(BusIntruders, TheDrivesOwnErrorReachesTheState) {
  IntrudedArm arm(test_robot(3));
  ASSERT_TRUE(arm.switch_on());
  arm.motors[2].error = 0xB;
  ASSERT_GT(cycles_until_off(&arm, 5), 0);
  EXPECT_EQ(arm.state->fault, +joint_state_t::FAULT_DRIVE_ERROR);
  EXPECT_EQ(arm.state->drive_status[2], 0xB);
  EXPECT_EQ(arm.driver->fault_detail(), 0xB);
  EXPECT_EQ(arm.driver->fault_text(arm.state->fault, 2, 0xB),
            "error B: power stage too hot; let it cool");
}

}  // namespace
}  // namespace limber::test_bus_intruders
