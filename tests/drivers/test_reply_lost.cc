// Replies that are missing, late or foreign: what is bridged, what trips, which joint is named.
#include <gtest/gtest.h>

#include "drivers/drive/loss_window.h"
#include "tests/drivers/loaded_arm.h"

namespace limber::test_reply_lost {
namespace {

using loaded::kFallback;
using loaded::kFault;
using loaded::kKd1;
using loaded::kKp50;
using loaded::kOff;
using loaded::kOn;
using loaded::kRequestOn;
using loaded::loaded_arm;
using loaded::text_of_fault;
using loaded::torque_sent;
using testing::FakeArm;
using testing::is_special;
using testing::raw_command;
using testing::test_robot;

TEST(ReplyLostTest, TwoAreBridgedTheThirdHoldsTheOthers) {
  FakeArm arm = loaded_arm(3);
  arm.motors[1].silent = true;
  for (int missing = 1; missing <= 2; ++missing) {
    arm.cycle_with(kRequestOn);
    EXPECT_EQ(arm.state->drive_state, kOn);
    EXPECT_EQ(arm.state->age_cycles[1], missing);
    EXPECT_EQ(arm.state->joint_flags[1] & joint_state_t::JOINT_FRESH, 0);
  }
  arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kFallback);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_REPLY_LOST + 0);
  EXPECT_EQ(arm.state->fault_joint, 1);
  EXPECT_EQ(arm.read_status().replies_lost[1], 3);
  for (int i = 0; i < 110; ++i) arm.cycle_with(kRequestOn);
  EXPECT_EQ(raw_command(arm.motors[0].last()).kp, kKp50);
  EXPECT_EQ(raw_command(arm.motors[1].last()).kp, 0);  // nobody knows where it is
  EXPECT_EQ(raw_command(arm.motors[1].last()).kd, kKd1);
  EXPECT_NEAR(torque_sent(arm, 1), 0.3, 5e-3);
  // When it is back for 50 ms it is held as well, where it is then; the fault stays.
  arm.motors[1].silent = false;
  arm.set_angle(1, 0.31);  // drive angle -0.01
  for (int i = 0; i < 50; ++i) {
    arm.cycle_with(kRequestOn);
    EXPECT_EQ(raw_command(arm.motors[1].last()).kp, 0);
  }
  arm.cycle_with(kRequestOn);
  EXPECT_EQ(raw_command(arm.motors[1].last()).kp, kKp50);
  EXPECT_NEAR(-12.5 + raw_command(arm.motors[1].last()).p * 25.0 / 65535.0, -0.01, 5e-4);
  EXPECT_EQ(arm.state->drive_state, kFallback);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_REPLY_LOST + 0);
}

TEST(ReplyLostTest, TenWithinASecondAreTooManyAsWell) {
  for (int gap : {110, 112}) {  // ten losses over 991 or 1009 cycles
    FakeArm arm = loaded_arm(2);
    for (int loss = 1; loss <= 10; ++loss) {
      ASSERT_EQ(arm.state->drive_state, kOn) << loss;
      arm.motors[0].silent = true;
      arm.cycle_with(kRequestOn);
      arm.motors[0].silent = false;
      for (int i = 1; i < gap && loss < 10; ++i) arm.cycle_with(kRequestOn);
    }
    EXPECT_EQ(arm.state->drive_state, gap == 110 ? kFallback : kOn);
  }
}

TEST(ReplyLostTest, AllSilentIsAHoldUntilTheDrivesOwnWatchdogsHaveActed) {
  FakeArm arm = loaded_arm(2);
  for (testing::FakeMotor& motor : arm.motors) motor.silent = true;
  for (int silent = 1; silent <= 22; ++silent) {
    arm.cycle_with(kRequestOn);
    EXPECT_EQ(arm.state->drive_state, silent < 3    ? kOn
                                      : silent < 20 ? kFallback
                                                    : kFault)
        << silent;
  }
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_REPLY_LOST + 0);
  EXPECT_EQ(arm.state->fault_joint, -1);
  EXPECT_TRUE(is_special(arm.motors[0].last(), 0xFD));
  EXPECT_TRUE(is_special(arm.motors[1].last(), 0xFD));
}

TEST(ReplyLostTest, TheJointIsNamedUnlessAllAreSilentForAsLong) {
  FakeArm arm = loaded_arm(2);
  arm.motors[0].silent = true;
  arm.cycle_with(kRequestOn);
  arm.motors[1].silent = true;
  for (int i = 0; i < 2; ++i) arm.cycle_with(kRequestOn);
  ASSERT_EQ(arm.state->fault, joint_state_t::FAULT_REPLY_LOST + 0);
  EXPECT_EQ(arm.state->fault_joint, 0);
  EXPECT_EQ(text_of_fault(arm), "joint1 (id 0x1): no reply for 3 cycles");
  EXPECT_EQ(arm.driver->fault_text(joint_state_t::FAULT_REPLY_LOST, 0, 0xFFFF),
            "joint1 (id 0x1): no reply since the start")
      << "as many cycles as the detail has room for";
}

TEST(ReplyLostTest, AllOfThemAreNamedAndManySingleOnesAreToldAsSuch) {
  FakeArm silent = loaded_arm(2);
  for (testing::FakeMotor& motor : silent.motors) motor.silent = true;
  for (int i = 0; i < 3; ++i) silent.cycle_with(kRequestOn);
  ASSERT_EQ(silent.state->fault_joint, -1);
  EXPECT_EQ(text_of_fault(silent),
            "all drives, joint1 (id 0x1) to joint2 (id 0x2): no reply for 3 cycles");
  FakeArm often = loaded_arm(2);
  for (int i = 0; i < 100 && often.state->fault == joint_state_t::FAULT_NONE; ++i) {
    often.motors[1].silent = i % 5 == 0;
    often.cycle_with(kRequestOn);
  }
  EXPECT_EQ(text_of_fault(often),
            "joint2 (id 0x2): ten replies within a second missing or impossible");
}

TEST(ReplyLostTest, OnASimulatedBusInRealTimeTheSimulatorIsNamed) {
  Robot robot = test_robot(2);
  for (BusConfig& bus : robot.buses) bus.can = "virtual:test";
  FakeArm arm(robot);
  ASSERT_TRUE(arm.switch_on());
  for (testing::FakeMotor& motor : arm.motors) motor.silent = true;
  for (int i = 0; i < 3; ++i) arm.cycle_with(kRequestOn);
  EXPECT_NE(text_of_fault(arm).find("limber-sim ended or stood still"), std::string::npos);
}

TEST(ReplyLostTest, AStallOfTenCyclesEndsInAFirmHold) {
  FakeArm arm = loaded_arm(2);
  for (testing::FakeMotor& motor : arm.motors) motor.silent = true;
  for (int i = 0; i < 10; ++i) arm.cycle_with(kRequestOn);
  for (testing::FakeMotor& motor : arm.motors) motor.silent = false;
  for (int i = 0; i < 94; ++i) {
    arm.cycle_with(kRequestOn);
    EXPECT_NEAR(torque_sent(arm, 0), 0.3, 5e-3);  // never without its weight
  }
  EXPECT_EQ(raw_command(arm.motors[0].last()).kp, kKp50);
}

TEST(ReplyLostTest, ASilentDriveWhileOffMayHaveForgottenItsSettings) {
  FakeArm arm(test_robot(2));
  ASSERT_TRUE(arm.run_until(kOff, joint_command_t::REQUEST_KEEP));
  arm.motors[0].silent = true;
  for (int i = 0; i < 3; ++i) arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kFault);
}

TEST(ReplyLostTest, LateRepliesAreCountedAndACycleOld) {
  FakeArm arm = loaded_arm(2);
  arm.set_angle(0, 0.005);
  arm.driver->transmit(++arm.cycle * 1'000'000, 0);
  arm.driver->poll();
  const joint_state_t& state = arm.driver->finish_cycle();
  EXPECT_EQ(state.age_cycles[0], 1);
  arm.answer();  // too late
  arm.half_cycle();
  EXPECT_EQ(arm.read_status().replies_late[0], 1);
  EXPECT_EQ(arm.read_status().replies_lost[0], 0);
  EXPECT_EQ(arm.state->age_cycles[0], 0);  // by its own reply of this cycle
}

TEST(ReplyLostTest, ForeignFramesAreCounted) {
  FakeArm arm = loaded_arm(1);
  CanFrame foreign;
  foreign.length = 8;
  for (std::uint32_t id : {0x21U, 0x10U, 0x12U, 0x7FFU}) {
    foreign.id = id;
    arm.motor_ends[0]->send(foreign);
  }
  foreign.id = 0x11;
  foreign.extended = true;
  arm.motor_ends[0]->send(foreign);
  arm.half_cycle();
  EXPECT_EQ(arm.read_status().frames_foreign[0], 5);
  EXPECT_EQ(arm.state->drive_state, kOn);
}

// A pause of the messages' delivery is bridged also when all that was under way comes at once.
TEST(BridgeTest, LateAnswersAreBridgedLikeMissingOnes) {
  Robot robot = test_robot(2);
  for (JointConfig& joint : robot.joints) joint.drive.watchdog_s = 0.1;
  FakeArm arm(robot, false, 50);
  ASSERT_TRUE(arm.switch_on());
  joint_command_t late = arm.command;
  std::vector<std::int64_t> unanswered;
  for (int i = 0; i < 40; ++i) unanswered.push_back(arm.half_cycle().seq);
  for (std::int64_t seq : unanswered) {
    late.state_seq = seq;
    arm.driver->accept(late);
  }
  arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kOn);
}

// On a virtual bus, whose pauses are those of a scheduler, more is bridged.
TEST(ToleranceTest, AsManyCyclesAsWantedAreBridgedAndNotOneMore) {
  for (int bridged : {2, 3, 7, 50}) {
    Robot robot = test_robot(2);
    for (JointConfig& joint : robot.joints) joint.drive.watchdog_s = 0.1;
    FakeArm arm(robot, false, bridged);
    ASSERT_TRUE(arm.switch_on());
    arm.motors[0].silent = true;
    for (int i = 0; i < bridged; ++i) arm.cycle_with(kRequestOn);
    EXPECT_EQ(arm.state->drive_state, kOn) << bridged;
    arm.motors[0].silent = false;
    arm.cycle_with(kRequestOn);
    EXPECT_EQ(arm.state->age_cycles[0], 0);
    for (int i = 0; i < bridged; ++i) arm.half_cycle();
    EXPECT_EQ(arm.state->drive_state, kOn) << bridged;
    arm.cycle_with(kRequestOn);
    arm.motors[0].silent = true;
    for (int i = 0; i < bridged + 1; ++i) arm.cycle_with(kRequestOn);
    EXPECT_EQ(arm.state->drive_state, kFallback) << bridged;
    EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_REPLY_LOST + 0);
  }
}

TEST(ToleranceTest, FiveTimesAsManyWithinASecondAreTooMany) {
  LossWindow wire(2);
  LossWindow scheduler(50);
  int wire_losses = 0;
  int scheduler_losses = 0;
  for (std::int64_t cycle = 0; !wire.add(3 * cycle, 1000); ++cycle) ++wire_losses;
  for (std::int64_t cycle = 0; !scheduler.add(3 * cycle, 1000); ++cycle) ++scheduler_losses;
  EXPECT_EQ(wire_losses + 1, 10);
  EXPECT_EQ(scheduler_losses + 1, 250);
}

}  // namespace
}  // namespace limber::test_reply_lost
