// Lock step on the wire, and the cycle's promise to allocate nothing.
#include <gtest/gtest.h>

#include "drivers/can/lockstep_frame.h"
#include "tests/drivers/fake_arm.h"
#include "tests/drivers/families/fake_cia402.h"
#include "tools/allocations/allocations.h"

namespace limber::test_lockstep {
namespace {

using testing::FakeArm;
using testing::test_robot;

/// All frames that wait at the motors' end of a bus; the motors see them too.
std::vector<CanFrame> take_all(FakeArm& arm, std::size_t bus) {
  std::vector<CanFrame> frames;
  CanFrame frame;
  while (arm.motor_ends[bus]->receive(std::span(&frame, 1)) == 1) {
    frames.push_back(frame);
    CanFrame reply;
    for (testing::FakeMotor& motor : arm.motors) {
      if (motor.drive().bus == static_cast<int>(bus) && motor.handle(frame, &reply))
        arm.motor_ends[bus]->send(reply);
    }
  }
  return frames;
}

TEST(LockstepTest, TickFollowsTheCommandsAndTheTockCompletesTheCycle) {
  FakeArm arm(test_robot(4, 2), /*lockstep=*/true);
  for (std::int64_t k = 0; k < 20; ++k) {
    arm.driver->transmit(k * 1'000'000, 0);
    for (std::size_t bus = 0; bus < 2; ++bus) {
      const std::vector<CanFrame> frames = take_all(arm, bus);
      ASSERT_EQ(frames.size(), 3U);
      EXPECT_TRUE(frames[2].extended);
      EXPECT_EQ(frames[2].id, 0x1FFFFFF0U);
      EXPECT_EQ(frames[2].data[0], k);
    }
    arm.driver->poll();
    EXPECT_FALSE(arm.driver->complete());  // all replies are there, the simulator has not advanced
    arm.motor_ends[0]->send(lockstep::tock(k));
    arm.driver->poll();
    EXPECT_FALSE(arm.driver->complete());
    arm.motor_ends[1]->send(lockstep::tock(k - 1));  // of the cycle before: repeated, late
    arm.driver->poll();
    EXPECT_FALSE(arm.driver->complete());
    arm.motor_ends[1]->send(lockstep::tock(k));
    arm.driver->poll();
    EXPECT_TRUE(arm.driver->complete());
    EXPECT_EQ(arm.driver->finish_cycle().seq, k);
  }
  EXPECT_EQ(arm.read_status().frames_foreign[0], 0);
  EXPECT_EQ(arm.read_status().replies_lost[0], 0);
}

TEST(LockstepTest, ARepeatedTickHasTheSameNumberAndGoesWhereNoTockCame) {
  FakeArm arm(test_robot(4, 2), /*lockstep=*/true);
  arm.driver->transmit(0, 0);
  take_all(arm, 0);
  take_all(arm, 1);
  arm.motor_ends[0]->send(lockstep::tock(0));
  arm.driver->poll();
  for (int i = 0; i < 3; ++i) {
    arm.driver->repeat_tick();
    EXPECT_TRUE(take_all(arm, 0).empty());
    const std::vector<CanFrame> again = take_all(arm, 1);
    ASSERT_EQ(again.size(), 1U);
    EXPECT_TRUE(lockstep::is_tick(again[0]));
    EXPECT_EQ(lockstep::sequence(again[0]), 0);
  }
  arm.motor_ends[1]->send(lockstep::tock(0));
  arm.motor_ends[1]->send(lockstep::tock(0));  // the answer to the repetition
  arm.driver->poll();
  EXPECT_TRUE(arm.driver->complete());
  EXPECT_EQ(arm.driver->finish_cycle().age_cycles[0], 0);
}

TEST(LockstepTest, AReplyThatIsMissingAtTheTockIsLost) {
  FakeArm arm(test_robot(2), /*lockstep=*/true);
  arm.motors[1].silent = true;
  for (std::int64_t k = 0; k < 3; ++k) {  // in the start-up an answer may take two cycles
    arm.driver->transmit(k * 1'000'000, k * 1'000'000);
    take_all(arm, 0);
    arm.motor_ends[0]->send(lockstep::tock(k));
    arm.driver->poll();
    EXPECT_TRUE(arm.driver->complete());
    arm.driver->finish_cycle();
  }
  EXPECT_EQ(arm.read_status().replies_lost[0], 0);
  EXPECT_EQ(arm.read_status().replies_lost[1], 1);
}

TEST(LockstepTest, InRealtimeThereAreNoTicksAndTheRepliesCompleteTheCycle) {
  FakeArm arm(test_robot(2));
  arm.driver->transmit(0, 0);
  EXPECT_FALSE(arm.driver->complete());
  for (const CanFrame& frame : take_all(arm, 0)) EXPECT_FALSE(frame.extended);
  arm.driver->poll();
  EXPECT_TRUE(arm.driver->complete());
}

// Through start-up, ON, a refused command, HOLD, DAMP and FAULT.
class AllocationTest : public ::testing::Test {
 protected:
  void cycles(testing::DrivenArm* arm, int expected_state) {
    for (int i = 0; i < 1000; ++i) cycle(arm);
    EXPECT_EQ(arm->state->drive_state, expected_state);
  }

  std::int64_t by_driver = 0;

 private:
  void cycle(testing::DrivenArm* arm) {
    std::int64_t before = allocations();
    arm->driver->transmit(++arm->cycle * 1'000'000, 0);
    by_driver += allocations() - before;
    arm->answer();
    before = allocations();
    arm->driver->poll();
    arm->state = &arm->driver->finish_cycle();
    arm->command.request = joint_command_t::REQUEST_ON;
    arm->answer_state();
    arm->driver->fill_status(&arm->status);
    by_driver += allocations() - before;
  }
};

TEST_F(AllocationTest, NoCycleAllocates) {
  FakeArm arm(test_robot(7));
  for (testing::FakeMotor& motor : arm.motors) motor.frames.reserve(20'000);
  cycles(&arm, joint_state_t::DRIVE_ON);
  arm.command.tau[0] = 100.0;
  cycles(&arm, joint_state_t::DRIVE_HOLD);
  arm.set_speed(2, 6.0);
  cycles(&arm, joint_state_t::DRIVE_DAMP);
  for (testing::FakeMotor& motor : arm.motors) motor.silent = true;
  cycles(&arm, joint_state_t::DRIVE_FAULT);
  EXPECT_EQ(by_driver, 0);
}

// One joint with two motors, one with a torque loop and all sensors.
TEST_F(AllocationTest, NoCycleWithCia402DrivesAllocates) {
  Robot robot = testing::cia402_robot();
  JointConfig& pair = robot.joints[0];
  pair.has_antagonist = true;
  pair.transmission.kind = TransmissionKind::kAntagonistic;
  pair.transmission.preload_max_rad = 0.5;
  pair.drive.peak_torque_Nm = 14.0;
  pair.antagonist = pair.drive;
  pair.antagonist.command_id = 0x205;
  pair.antagonist.reply_id = 0x185;
  testing::Cia402Arm arm(robot);
  JointConfig second = pair;
  second.drive = pair.antagonist;
  arm.motors.emplace_back(second);
  arm.command.tau_preload[0] = 5.0;
  cycles(&arm, joint_state_t::DRIVE_ON);
  EXPECT_NE(arm.state->joint_flags[0] & joint_state_t::JOINT_TWO_MOTORS, 0);
  arm.command.tau_preload[0] = 100.0;
  cycles(&arm, joint_state_t::DRIVE_HOLD);
  constexpr int kCountsPerTurn = 1 << 16;
  arm.motors[0].velocity = 4 * kCountsPerTurn;
  arm.motors[2].velocity = -4 * kCountsPerTurn;
  cycles(&arm, joint_state_t::DRIVE_DAMP);
  for (testing::FakeCia402& motor : arm.motors) motor.silent = true;
  cycles(&arm, joint_state_t::DRIVE_FAULT);
  EXPECT_EQ(by_driver, 0);
}

}  // namespace
}  // namespace limber::test_lockstep
