// An arm that moves away while it is held: how far each joint may move, to the last bit.
#include <gtest/gtest.h>

#include <cmath>

#include "controller/watches/start_watch.h"

namespace limber::controller::test_start_watch_edges {
namespace {

/// Joint 0 is rigid, joint 1 has a spring; both from -1 to 1.
Robot two_joints() {
  Robot robot;
  robot.joints.resize(2);
  for (JointConfig& joint : robot.joints) {
    joint.position_min = -1.0;
    joint.position_max = 1.0;
  }
  robot.joints[1].transmission.kind = TransmissionKind::kElastic;
  return robot;
}

/// The joint that is found after one at rest at `start` has moved by `by`.
int strayed(int joint, double start, double by, double fastest = 0.0) {
  StartWatch watch(two_joints());
  joint_state_t state{};
  state.num_joints = 2;
  state.theta[joint] = start;
  state.theta_dot[1 - joint] = fastest;
  watch.begin(state);
  state.theta[joint] += by;
  return watch.strayed(state);
}

TEST(StartWatchEdges, ATenthOfARadianThreeWithASpring) {
  for (const double sign : {1.0, -1.0}) {
    EXPECT_EQ(strayed(0, 0.0, sign * 0.1), -1);
    EXPECT_EQ(strayed(0, 0.0, sign * std::nextafter(0.1, 1.0)), 0);
    EXPECT_EQ(strayed(1, 0.0, sign * 0.3), -1);
    EXPECT_EQ(strayed(1, 0.0, sign * std::nextafter(0.3, 1.0)), 1);
  }
}

TEST(StartWatchEdges, ThreeTenthsWithinATenthOfAnEnd) {
  const double least = -1.0 + 0.1;
  const double most = 1.0 - 0.1;
  for (const double free : {least, 0.0, most}) EXPECT_EQ(strayed(0, free, 0.2), 0) << free;
  for (const double near : {std::nextafter(least, -1.0), -1.5, std::nextafter(most, 1.0), 1.5}) {
    EXPECT_EQ(strayed(0, near, 0.29), -1) << near;
    EXPECT_EQ(strayed(0, near, 0.31), 0) << near;
  }
}

TEST(StartWatchEdges, TheFastestJointsWayInThreeTenthsOfASecondIsAdded) {
  for (const double speed : {0.5, -0.5}) {
    EXPECT_EQ(strayed(0, 0.0, 0.249, speed), -1);
    EXPECT_EQ(strayed(0, 0.0, 0.251, speed), 0);
    EXPECT_EQ(strayed(1, 0.0, 0.449, speed), -1);
    EXPECT_EQ(strayed(1, 0.0, 0.451, speed), 1);
  }
}

TEST(StartWatchEdges, AStartThatIsNoNumberIsNoPlaceToStay) {
  EXPECT_EQ(strayed(0, std::nan(""), 0.0), 0);
}

TEST(StartWatchEdges, JointsBeyondTheArmsAreNobodys) {
  StartWatch watch(two_joints());
  joint_state_t state{};
  state.num_joints = 2;
  watch.begin(state);
  state.theta[2] = 5.0;
  EXPECT_EQ(watch.strayed(state), -1);
}

TEST(StartWatchEdges, OneSecondFromItsBeginning) {
  StartWatch watch(two_joints());
  joint_state_t state{};
  state.num_joints = 2;
  state.time_ns = 5'000'000'000;
  watch.begin(state);
  state.theta[0] = 0.5;
  EXPECT_EQ(watch.strayed(state), 0);
  state.time_ns += 1'000'000'001;
  EXPECT_EQ(watch.strayed(state), -1);
  state.time_ns = 5'000'000'000;
  EXPECT_EQ(watch.strayed(state), -1) << "it is over for good";
}

}  // namespace
}  // namespace limber::controller::test_start_watch_edges
