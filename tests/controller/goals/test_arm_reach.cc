// Goals beyond the stretched arm are refused with the distance missing; none within reach is.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "controller/goals/arm_reach.h"
#include "controller/goals/goal_tracker.h"
#include "tests/controller/arms.h"

namespace limber::controller::test_arm_reach {
namespace {

using limber::testing::kTextbook;

TEST(ArmReach, OfATwoLinkArmIsTheSumOfItsLengths) {
  ArmReach reach(limber::testing::planar_arm(kTextbook));
  EXPECT_NEAR(reach.longest_m(), kTextbook.a1 + kTextbook.a2, 1e-12);
  EXPECT_EQ(reach.check(reach.origin() + Eigen::Vector3d(2.0, 0.0, 0.0)), nullptr);
  EXPECT_STREQ(
      reach.check(reach.origin() + Eigen::Vector3d(0.0, 2.25, 0.0)),
      "the goal is 2.250 m from the first joint, 0.250 m beyond the arm's reach of 2.000 m");
  const auto circle = [&](double z, double radius) {
    const Eigen::Vector3d centre = reach.origin() + Eigen::Vector3d(0.0, 1.5, 0.0);
    return reach.check_circle(centre, {0.0, z == 0.0 ? 2.0 : 0.0, z}, radius);
  };
  EXPECT_EQ(circle(1.0, 0.5), nullptr);
  EXPECT_NE(circle(1.0, 0.51), nullptr) << "farthest in its plane: 1.5 + r";
  const double across = std::sqrt(4.0 - 2.25);
  EXPECT_EQ(circle(0.0, across), nullptr) << "about the line to it: a right angle";
  EXPECT_NE(circle(0.0, across + 1e-3), nullptr);
}

// Whatever the joints: where the tip can be is within reach.
TEST(ArmReach, NoPoseOfTheArmIsBeyondIt) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    LoadedRobot robot = limber::testing::random_arm(1 + static_cast<int>(seed % 8), seed, true);
    std::mt19937 generator(seed);
    const double most = 2.0;
    for (JointConfig& joint : robot.robot.joints) {
      joint.position_min = -most;
      joint.position_max = most;
    }
    ArmReach reach(robot);
    ArmModel model(robot);
    for (int i = 0; i < 200; ++i) {
      VectorJ q = limber::testing::random_vector(model.size(), 1.0, generator);
      q = q.cwiseMax(-most).cwiseMin(most);
      ASSERT_EQ(reach.check(model.tip_pose(q).p), nullptr) << seed;
    }
  }
}

TEST(ArmReach, RefusedOnARealBusWarnedOfElsewhere) {
  const LoadedRobot robot = limber::testing::planar_arm(kTextbook);
  ArmModel model(robot);
  for (const bool simulated : {true, false}) {
    GoalTracker tracker(robot, &model, simulated);
    tracker.reset({Eigen::Vector3d(1.0, 0.0, 0.0), Eigen::Quaterniond::Identity()},
                  VectorJ::Zero(2));
    compliance_goal_t goal{};
    goal.num_joints = 2;
    goal.kind = compliance_goal_t::GOAL_OFFSET;
    goal.offset[0] = 1.5;
    const Refusal far = tracker.set(goal, GoalType::kPose).refusal;
    const char* text = simulated ? far.warning : far.reason;
    ASSERT_NE(text, nullptr);
    EXPECT_NE(std::string(text).find("beyond the arm's reach of 2.000 m"), std::string::npos)
        << text;
    EXPECT_EQ(far.code, simulated ? +request_answer_t::REFUSED_NOTHING
                                  : +request_answer_t::REFUSED_GOAL_LIMIT);
    tracker.reset({Eigen::Vector3d(1.0, 0.0, 0.0), Eigen::Quaterniond::Identity()},
                  VectorJ::Zero(2));
    goal.offset[0] = 0.9;
    const Refusal near = tracker.set(goal, GoalType::kPose).refusal;
    EXPECT_EQ(near.reason, nullptr);
    EXPECT_EQ(near.warning, nullptr);
  }
}

}  // namespace
}  // namespace limber::controller::test_arm_reach
