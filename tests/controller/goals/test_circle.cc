// Round and round from rest, and away from the circle without a jump.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "controller/goals/goal_generator.h"
#include "controller/goals/interpolation.h"
#include "controller/model/rotation.h"
#include "tests/controller/arms.h"

namespace limber::controller::test_circle {
namespace {

const Eigen::Vector3d kStart(0.4, -0.1, 0.3);
const Eigen::Vector3d kAxis = Eigen::Vector3d(1.0, -2.0, 0.5).normalized();
const Eigen::Vector3d kRadius = 0.1 * kAxis.cross(Eigen::Vector3d::UnitX()).normalized();
constexpr double kPeriod_s = 1.4;

struct Point {
  Point(const CircleMotion& motion, double t) { motion.at(t, &x, &v, &a); }
  Eigen::Vector3d x;
  Eigen::Vector3d v;
  Eigen::Vector3d a;
};

CircleMotion circle() { return {kStart, kStart - kRadius, kAxis, kPeriod_s}; }

TEST(CircleMotion, StartsFromRest) {
  const Point start(circle(), 0.0);
  EXPECT_LT((start.x - kStart).norm(), 1e-15);
  EXPECT_EQ(start.v.norm(), 0.0);
  EXPECT_EQ(start.a.norm(), 0.0);
}

TEST(CircleMotion, RatesAreTheDerivatives) {
  constexpr double h = 1e-5;
  for (double t = 0.05; t < 3.0 * kPeriod_s; t += 0.1) {
    const Point above(circle(), t + h);
    const Point below(circle(), t - h);
    const Point here(circle(), t);
    EXPECT_LT(((above.x - below.x) / (2 * h) - here.v).norm(), 1e-8) << t;
    EXPECT_LT(((above.v - below.v) / (2 * h) - here.a).norm(), 1e-7) << t;
  }
}

TEST(CircleMotion, StaysOnTheCircleAndTurnsOnceAPeriod) {
  for (double t = 0.0; t < 4.0 * kPeriod_s; t += 0.03) {
    const Point here(circle(), t);
    const Eigen::Vector3d r = here.x - (kStart - kRadius);
    EXPECT_NEAR(r.norm(), 0.1, 1e-12);
    EXPECT_NEAR(r.dot(kAxis), 0.0, 1e-12);
    if (t < kPeriod_s) continue;
    EXPECT_NEAR(here.v.norm(), 0.1 * 2.0 * std::numbers::pi / kPeriod_s, 1e-12);
    EXPECT_GT(kAxis.dot(r.cross(here.v)), 0.0) << "right-handed about the axis";
    EXPECT_LT((Point(circle(), t + kPeriod_s).x - here.x).norm(), 1e-12);
  }
}

// A centre that is off the plane through the start counts by its axis.
TEST(CircleMotion, CentreIsTheFootOfTheStartOnTheAxis) {
  const CircleMotion moved(kStart, kStart - kRadius + 0.3 * kAxis, kAxis, kPeriod_s);
  EXPECT_LT((Point(moved, 2.0).x - Point(circle(), 2.0).x).norm(), 1e-12);
}

// Taken over by a motion to a pose, or stopped: pose, twist and acceleration go on.
TEST(PoseMotion, LeavesACircleWithoutAJump) {
  for (const bool stops : {false, true}) {
    for (const double when : {0.3, 0.9, 2.0}) {
      PoseMotion motion;
      motion.reset({kStart, exp_rotation({0.3, 0.1, -0.2})});
      motion.circle(kStart - kRadius, kAxis, kPeriod_s);
      for (double t = 0.0; t < when; t += 1e-3) motion.advance(1e-3);
      EXPECT_TRUE(motion.moving());
      const PoseMotion before = motion;
      if (stops) {
        motion.stop(0.3);
      } else {
        motion.start({kStart, exp_rotation({0.0, 0.5, 0.0})}, 1.0);
      }
      motion.advance(1e-8);
      EXPECT_LT((motion.X_BD.p - before.X_BD.p).norm(), 1e-7);
      EXPECT_LT((motion.V_BD - before.V_BD).norm(), 1e-6);
      EXPECT_LT((motion.A_BD - before.A_BD).norm(), 1e-5);
      for (int i = 0; i < 1100; ++i) motion.advance(1e-3);
      EXPECT_FALSE(motion.moving());
      EXPECT_EQ(motion.V_BD.norm(), 0.0);
    }
  }
}

class CircleGoal : public ::testing::Test {
 protected:
  CircleGoal() : robot(limber::testing::seven_joint_arm()), goals(robot.robot) {
    goals.reset(Pose{}, VectorJ::Zero(7));
    message.num_joints = 7;
    message.kind = compliance_goal_t::GOAL_CIRCLE;
    message.offset[0] = 0.1;
    message.offset[5] = 3.0;  // any length
    message.duration_s = 1.0;
  }
  LoadedRobot robot;
  GoalGenerator goals;
  compliance_goal_t message{};
};

TEST_F(CircleGoal, GoesRoundUntilTheNextGoal) {
  ASSERT_EQ(goals.set(message, GoalType::kPose), nullptr);
  for (int i = 0; i < 5500; ++i) goals.advance(1e-3, 0);
  // Half a turn in the first period, one in each that follows.
  EXPECT_LT((goals.goal().X_BD.p).norm(), 1e-9);
  EXPECT_NEAR(goals.goal().V_BD.norm(), 0.1 * 2.0 * std::numbers::pi, 1e-9);
}

TEST_F(CircleGoal, WrongOnesAreRefused) {
  struct Case {
    const char* reason;
    void (*spoil)(compliance_goal_t*);
  };
  const Case cases[] = {
      {"the period must be at least 0.2 s", [](compliance_goal_t* g) { g->duration_s = 0.1; }},
      {"the circle has no centre or axis", [](compliance_goal_t* g) { g->offset[0] = 0.0; }},
      {"the circle has no centre or axis", [](compliance_goal_t* g) { g->offset[5] = 0.0; }},
      {"the circle has no centre or axis", [](compliance_goal_t* g) { g->offset[1] = NAN; }},
      {"the circle is faster than 1 m/s", [](compliance_goal_t* g) { g->offset[0] = 0.2; }},
  };
  for (const Case& c : cases) {
    compliance_goal_t goal = message;
    c.spoil(&goal);
    EXPECT_STREQ(goals.set(goal, GoalType::kPose), c.reason);
  }
  ASSERT_EQ(goals.set(message, GoalType::kPose), nullptr);
  goals.advance(0.1, 0);
  EXPECT_STREQ(goals.set(message, GoalType::kPose), "a circle starts from a goal at rest");
}

}  // namespace
}  // namespace limber::controller::test_circle
