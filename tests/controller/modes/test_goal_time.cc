// A goal that is valid for a time: without another one the arm comes to rest, and is held.
#include "tests/controller/modes/supervisor_bench.h"

namespace limber::controller::test_goal_time {
namespace {

using namespace supervisor_bench;

constexpr double kValid_s = 0.1;
constexpr std::int64_t kCycles = 100;

class GoalTime : public SupervisorBench {
 protected:
  void to_active() {
    to_hold();
    ASSERT_EQ(ask(Request::REQUEST_ACTIVE), "");
  }
  Mode after(std::int64_t cycles) {
    states(cycles, State::DRIVE_ON);
    return supervisor_.mode();
  }
};

TEST_F(GoalTime, TheArmStopsInTheCycleInWhichItIsOver) {
  to_active();
  supervisor_.take_goal(kValid_s);
  EXPECT_EQ(after(kCycles - 1), Mode::kActive);
  EXPECT_EQ(after(1), Mode::kSoftStop);
  EXPECT_EQ(supervisor_.reason(), +Reasons::REASON_CLIENT_SILENT);
  EXPECT_EQ(after(kSoftStop_ns / kPeriod_ns), Mode::kHold);
  EXPECT_EQ(supervisor_.reason(), +Reasons::REASON_CLIENT_SILENT);
}

TEST_F(GoalTime, EveryGoalBeginsItAnew) {
  to_active();
  for (int goal = 0; goal < 5; ++goal) {
    supervisor_.take_goal(kValid_s);
    ASSERT_EQ(after(kCycles - 1), Mode::kActive);
  }
  supervisor_.take_goal(0.0);
  EXPECT_EQ(after(100 * kCycles), Mode::kActive) << "that one lasts";
}

TEST_F(GoalTime, WhatEndsTheMotionEndsTheTime) {
  to_active();
  supervisor_.take_goal(kValid_s);
  ASSERT_EQ(ask(Request::REQUEST_STOP), "");
  ASSERT_EQ(after(kSoftStop_ns / kPeriod_ns), Mode::kHold);
  EXPECT_EQ(supervisor_.reason(), +Reasons::REASON_STOP_REQUESTED);
  ASSERT_EQ(ask(Request::REQUEST_ACTIVE), "");
  EXPECT_EQ(after(10 * kCycles), Mode::kActive) << "no goal since";
}

}  // namespace
}  // namespace limber::controller::test_goal_time
