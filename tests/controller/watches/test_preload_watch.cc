// ACTIVE waits until the springs between two motors are wound up.
#include <gtest/gtest.h>

#include <limits>

#include "tests/controller/modes/supervisor_bench.h"

namespace limber::controller::test_preload_watch {
namespace {

using namespace supervisor_bench;

/// One motor, then two with 0.25 rad of preload at rest, 0.75 rad at most: a tenth of that may be
/// missing.
Robot robot() {
  Robot made;
  made.joints.resize(2);
  made.joints[1].has_antagonist = true;
  made.joints[1].transmission.preload_rad = 0.25;
  made.joints[1].transmission.preload_max_rad = 0.75;
  return made;
}

bool slack(double first, double second) {
  joint_state_t state{};
  state.num_joints = 2;
  state.preload[0] = first;
  state.preload[1] = second;
  return PreloadWatch(robot()).slack(state);
}

TEST(PreloadWatch, ATenthOfTheGreatestMayBeMissing) {
  EXPECT_FALSE(slack(0.0, 0.25));
  EXPECT_FALSE(slack(0.0, 0.1751));
  EXPECT_TRUE(slack(0.0, 0.1749));
  EXPECT_TRUE(slack(0.0, -1.8)) << "motors that a falling link has turned";
  EXPECT_FALSE(slack(0.0, 0.7)) << "more than at rest carries as well";
  EXPECT_FALSE(slack(-5.0, 0.25)) << "a joint with one motor has none";
  EXPECT_TRUE(slack(0.0, std::numeric_limits<double>::quiet_NaN()));
}

TEST(PreloadWatch, SpringsThatPullWithoutPreloadMayRestAtNone) {
  Robot linear = robot();
  linear.joints[1].transmission.preload_rad = 0.0;
  joint_state_t state{};
  state.num_joints = 2;
  state.preload[1] = -0.07;
  EXPECT_FALSE(PreloadWatch(linear).slack(state));
  state.preload[1] = -0.08;
  EXPECT_TRUE(PreloadWatch(linear).slack(state));
}

TEST(PreloadWatch, ThatMuchIsEnough) {
  Robot none = robot();
  none.joints[1].transmission.preload_rad = none.joints[1].transmission.preload_max_rad = 0.0;
  joint_state_t state{};
  state.num_joints = 2;
  EXPECT_FALSE(PreloadWatch(none).slack(state));
}

class ActiveWaits : public SupervisorBench {
 protected:
  ActiveWaits() {
    Robot one = robot();
    one.joints.erase(one.joints.begin());
    JointFlags flags{};
    flags[0] = State::JOINT_TWO_MOTORS;
    supervisor_ = Supervisor(1, 2, flags, PreloadWatch(one));
  }
  void on(double preload, std::int8_t drives = State::DRIVE_ON) {
    joint_state_t made = state(drives);
    made.joint_flags[0] |= State::JOINT_TWO_MOTORS;
    made.preload[0] = preload;
    supervisor_.on_state(made);
  }
  bool active_waits() { return supervisor_.not_yet(made(Request::REQUEST_ACTIVE)); }
};

TEST_F(ActiveWaits, ForThePreloadInHoldAndNowhereElse) {
  for (int i = 0; i < Supervisor::kSteadyStates; ++i) on(-1.0, State::DRIVE_OFF);
  EXPECT_TRUE(ask(Request::REQUEST_ACTIVE).starts_with("ACTIVE is entered from HOLD")) << "IDLE";
  EXPECT_FALSE(active_waits()) << "IDLE";
  EXPECT_EQ(ask(Request::REQUEST_HOLD), "") << "HOLD is what winds up";
  on(-1.0);
  ASSERT_TRUE(supervisor_.engaged());
  EXPECT_TRUE(ask(Request::REQUEST_ACTIVE).starts_with("the springs between two motors are slack"));
  EXPECT_EQ(supervisor_.mode(), Mode::kHold);
  EXPECT_TRUE(active_waits());
  EXPECT_FALSE(supervisor_.not_yet(made(Request::REQUEST_IDLE)));
  on(0.2);
  EXPECT_FALSE(active_waits());
  EXPECT_EQ(ask(Request::REQUEST_ACTIVE), "");
  on(0.1);
  EXPECT_EQ(supervisor_.mode(), Mode::kActive) << "a law may choose less";
  EXPECT_EQ(ask(Request::REQUEST_ACTIVE), "");
}

TEST_F(ActiveWaits, OtherRequestsDoNot) {
  for (int i = 0; i < Supervisor::kSteadyStates; ++i) on(-1.0, State::DRIVE_OFF);
  ASSERT_EQ(ask(Request::REQUEST_HOLD), "");
  on(-1.0);
  ASSERT_EQ(supervisor_.mode(), Mode::kHold);
  EXPECT_EQ(ask(Request::REQUEST_IDLE), "");
  EXPECT_EQ(supervisor_.mode(), Mode::kIdle);
}

}  // namespace
}  // namespace limber::controller::test_preload_watch
