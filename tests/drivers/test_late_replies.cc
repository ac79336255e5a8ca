// Replies that come late are a cycle old, not lost; what only looks new is recognised by its stamp.
#include <gtest/gtest.h>

#include "tests/drivers/fake_arm.h"

namespace limber::test_late_replies {
namespace {

using testing::FakeArm;
using testing::test_robot;

constexpr std::int64_t kPeriod_ns = 1'000'000;

/// Replies of the first joint are stamped `delay_ns` after the start of their cycle.
class DelayedArm final : public FakeArm {
 public:
  using FakeArm::FakeArm;

  void answer() override {
    CanFrame frame;
    while (motor_ends[0]->receive(std::span(&frame, 1)) == 1) {
      for (std::size_t i = 0; i < motors.size(); ++i) {
        CanFrame reply;
        if (!motors[i].handle(frame, &reply)) continue;
        reply.timestamp_ns = cycle * kPeriod_ns + (i == 0 ? delay_ns : 200'000);
        motor_ends[0]->send(reply);
      }
    }
  }

  std::int64_t delay_ns = 200'000;
};

DelayedArm switched_on() {
  DelayedArm arm(test_robot(2));
  arm.driver->set_least_round_trip(100'000);
  EXPECT_TRUE(arm.switch_on());
  return arm;
}

void run(DelayedArm* arm, int cycles) {
  for (int i = 0; i < cycles; ++i) arm->cycle_with(joint_command_t::REQUEST_KEEP);
}

TEST(LateReplies, WithinTheWindowAreOfThisCycle) {
  DelayedArm arm = switched_on();
  arm.delay_ns = arm.driver->reply_window_ns();
  run(&arm, 50);
  EXPECT_EQ(arm.state->age_cycles[0], 0);
  EXPECT_EQ(arm.read_status().replies_late[0], 0);
}

TEST(LateReplies, BehindTheWindowAreACycleOldAndNotLost) {
  DelayedArm arm = switched_on();
  arm.delay_ns = arm.driver->reply_window_ns() + 1;
  run(&arm, 2000);
  EXPECT_EQ(arm.state->drive_state, +joint_state_t::DRIVE_ON);
  EXPECT_EQ(arm.state->age_cycles[0], 1);
  EXPECT_EQ(arm.state->age_cycles[1], 0);
  EXPECT_GT(arm.read_status().replies_late[0], 1990);
  EXPECT_LE(arm.read_status().replies_lost[0], 1) << "the one that is under way";
}

TEST(LateReplies, OfAWholePeriodAreRecognisedByTheirStamp) {
  DelayedArm arm = switched_on();
  arm.delay_ns = kPeriod_ns + 50'000;
  run(&arm, 100);
  EXPECT_EQ(arm.state->age_cycles[0], 1) << "50 us after its start nothing can answer this cycle";
}

TEST(LateReplies, AngleOfALateReplyIsTheOneOfItsCycle) {
  DelayedArm arm = switched_on();
  run(&arm, 10);
  arm.set_angle(0, 0.004);
  arm.delay_ns = arm.driver->reply_window_ns() + 1;
  arm.half_cycle();
  EXPECT_NE(arm.state->q[0], 0.004);
  arm.half_cycle();
  EXPECT_NEAR(arm.state->q[0], 0.004, 1e-3);
}

TEST(LateReplies, SilenceIsStillLost) {
  DelayedArm arm = switched_on();
  arm.motors[0].silent = true;
  run(&arm, 3);
  EXPECT_NE(arm.state->drive_state, +joint_state_t::DRIVE_ON);
  EXPECT_EQ(arm.state->fault, +joint_state_t::FAULT_REPLY_LOST);
}

}  // namespace
}  // namespace limber::test_late_replies
