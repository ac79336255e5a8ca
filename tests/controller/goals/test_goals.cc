// Motion of the goal: minimum jerk, continuous through changes of mind, within the speed limits.
#include <gtest/gtest.h>

#include <cmath>

#include "controller/goals/goal_generator.h"
#include "controller/goals/interpolation.h"
#include "controller/model/rotation.h"
#include "tests/controller/arms.h"
#include "tools/allocations/allocations.h"

namespace limber::controller::test_goals {
namespace {

constexpr double kStep = 1e-3;

double minimum_jerk(double s) { return s * s * s * (10.0 - 15.0 * s + 6.0 * s * s); }

TEST(QuinticMotion, FromRestIsMinimumJerk) {
  QuinticMotion<Eigen::Vector3d> motion(Eigen::Vector3d(1, 2, 3));
  const Eigen::Vector3d end(1.5, 1.0, 3.0);
  motion.start(end, 2.0);
  double fastest = 0.0;
  double strongest = 0.0;
  for (int i = 1; i <= 2000; ++i) {
    motion.advance(kStep);
    const Eigen::Vector3d expected =
        Eigen::Vector3d(1, 2, 3) + minimum_jerk(i * kStep / 2.0) * (end - Eigen::Vector3d(1, 2, 3));
    ASSERT_LT((motion.x - expected).norm(), 1e-12);
    fastest = std::max(fastest, motion.v.norm());
    strongest = std::max(strongest, motion.a.norm());
  }
  const double distance = std::sqrt(0.25 + 1.0);
  EXPECT_NEAR(fastest, 1.875 * distance / 2.0, 1e-6);
  EXPECT_NEAR(strongest, 10.0 / std::sqrt(3.0) * distance / 4.0, 1e-5);
  EXPECT_FALSE(motion.moving());
  motion.advance(kStep);
  EXPECT_EQ(motion.x, end);
  EXPECT_EQ(motion.v.norm(), 0.0);
  EXPECT_EQ(motion.a.norm(), 0.0);
}

TEST(QuinticMotion, RatesAreTheDerivatives) {
  QuinticMotion<Eigen::Vector3d> motion(Eigen::Vector3d::Zero());
  motion.v << 0.3, -0.2, 0.1;
  motion.a << -1.0, 2.0, 0.5;
  motion.start(Eigen::Vector3d(0.1, 0.2, -0.3), 0.8);
  constexpr double h = 1e-5;
  for (double t = 0.01; t < 0.79; t += 0.07) {
    auto at = [&](double time) {
      auto copy = motion;
      copy.advance(time);
      return copy;
    };
    EXPECT_LT(((at(t + h).x - at(t - h).x) / (2 * h) - at(t).v).norm(), 1e-8);
    EXPECT_LT(((at(t + h).v - at(t - h).v) / (2 * h) - at(t).a).norm(), 1e-7);
  }
  motion.advance(1e-9);
  EXPECT_LT((motion.v - Eigen::Vector3d(0.3, -0.2, 0.1)).norm(), 1e-7) << "continues";
}

TEST(QuinticMotion, StopTakesTheVelocityAwayAlongACubic) {
  QuinticMotion<Eigen::Vector3d> motion(Eigen::Vector3d::Zero());
  motion.v << 1.0, 0.0, -2.0;
  motion.stop(0.3);
  for (int i = 1; i <= 300; ++i) {
    motion.advance(kStep);
    const double s = i / 300.0;
    EXPECT_NEAR(motion.v[0], 1.0 - s * s * (3.0 - 2.0 * s), 1e-9);
  }
  EXPECT_NEAR(motion.x[0], 0.15, 1e-12);
  EXPECT_NEAR(motion.x[2], -0.3, 1e-12);
}

TEST(PoseMotion, FromRestTurnsAboutOneAxis) {
  PoseMotion motion;
  const Pose start{Eigen::Vector3d(0.1, 0, 0), exp_rotation({0.2, -0.5, 0.3})};
  const Eigen::Vector3d turn(0.8, 1.1, -0.9);
  const Pose end{Eigen::Vector3d(0.1, 0.3, 0), exp_rotation(turn) * start.Q};
  motion.reset(start);
  motion.start({end.p, Eigen::Quaterniond(-end.Q.coeffs())}, 1.5);  // -Q is the same orientation
  for (int i = 1; i <= 1500; ++i) {
    motion.advance(kStep);
    const double s = minimum_jerk(i * kStep / 1.5);
    ASSERT_LT(log_rotation(motion.X_BD.Q * (exp_rotation(s * turn) * start.Q).conjugate()).norm(),
              1e-12);
    ASSERT_LT(motion.V_BD.tail<3>().cross(turn).norm(), 1e-12);
  }
  EXPECT_LT(log_rotation(motion.X_BD.Q * end.Q.conjugate()).norm(), 1e-14);
  EXPECT_EQ(motion.V_BD.norm(), 0.0);
}

// Pose, twist and acceleration stay continuous when the goal changes on the way, and the twist is
// the derivative of the pose all along.
TEST(PoseMotion, ChangesItsMindSmoothly) {
  std::mt19937 generator(1);
  PoseMotion motion;
  motion.reset(Pose{});
  PoseMotion before = motion;
  for (int i = 0; i < 4000; ++i) {
    if (i % 370 == 0) {
      const Vector6 x = limber::testing::random_six(1.0, generator);
      motion.start({x.head<3>(), exp_rotation(2.0 * x.tail<3>())}, 1.2);
      EXPECT_LT((motion.X_BD.p - before.X_BD.p).norm(), 1e-12);
      motion.advance(1e-9);
      EXPECT_LT((motion.V_BD - before.V_BD).norm(), 1e-6);
      EXPECT_LT((motion.A_BD - before.A_BD).norm(), 1e-5);
    }
    if (i == 3900) motion.stop(0.05);
    before = motion;
    motion.advance(1e-5);
    Vector6 rate;
    rate << motion.X_BD.p - before.X_BD.p, log_rotation(motion.X_BD.Q * before.X_BD.Q.conjugate());
    rate /= 1e-5;
    ASSERT_LT((rate - 0.5 * (motion.V_BD + before.V_BD)).norm(), 1e-6) << i;
    ASSERT_LT(((motion.V_BD - before.V_BD) / 1e-5 - 0.5 * (motion.A_BD + before.A_BD)).norm(),
              1e-4);
    motion.advance(kStep);
    before = motion;
  }
  EXPECT_EQ(motion.V_BD.norm(), 0.0);
}

class Goals : public ::testing::Test {
 protected:
  Goals() : robot(limber::testing::seven_joint_arm()), goals(robot.robot) {
    goals.reset(Pose{}, VectorJ::Zero(7));
    message.num_joints = 7;
    message.kind = compliance_goal_t::GOAL_OFFSET;
    message.quat_BD[0] = 1.0;
  }

  struct Peak {
    double seconds = 0.0;
    double speed = 0.0;
    double turn = 0.0;
    double joint = 0.0;
  };
  Peak run_to_rest() {
    Peak peak;
    for (int i = 0; i < 20000; ++i) {
      goals.advance(kStep, 0);
      const Goal& now = goals.goal();
      if (now.V_BD.norm() + now.v_d.norm() == 0.0) break;
      peak.seconds += kStep;
      peak.speed = std::max(peak.speed, now.V_BD.head<3>().norm());
      peak.turn = std::max(peak.turn, now.V_BD.tail<3>().norm());
      peak.joint = std::max(peak.joint, now.v_d.cwiseAbs().maxCoeff());
    }
    return peak;
  }

  LoadedRobot robot;
  GoalGenerator goals;
  compliance_goal_t message{};
};

TEST_F(Goals, NoDurationMeansTheDefaultSpeed) {
  message.offset[0] = 0.5;
  ASSERT_EQ(goals.set(message, GoalType::kPose), nullptr);
  EXPECT_NEAR(run_to_rest().speed, 0.25, 1e-5);
  message.offset[0] = 0.0;
  message.offset[4] = 1.5;
  ASSERT_EQ(goals.set(message, GoalType::kPose), nullptr);
  EXPECT_NEAR(run_to_rest().turn, 1.0, 1e-5);
}

TEST_F(Goals, DurationIsKeptUnlessTooFast) {
  message.offset[1] = 0.3;
  message.duration_s = 2.0;
  ASSERT_EQ(goals.set(message, GoalType::kPose), nullptr);
  EXPECT_NEAR(run_to_rest().seconds, 2.0, 2e-3);
  message.duration_s = 0.01;
  ASSERT_EQ(goals.set(message, GoalType::kPose), nullptr);
  EXPECT_NEAR(run_to_rest().speed, 1.0, 1e-3);
}

TEST_F(Goals, JointGoalsKeepToTheJointsSpeed) {
  message.kind = compliance_goal_t::GOAL_JOINT;
  message.q[2] = 1.2;
  ASSERT_EQ(goals.set(message, GoalType::kJoints), nullptr);
  EXPECT_NEAR(run_to_rest().joint, 0.1 * 20.0, 1e-3);
  EXPECT_EQ(goals.goal().q_d[2], 1.2);
}

TEST_F(Goals, OffsetsAddUpFromTheEndOfTheMotion) {
  message.offset[0] = 0.1;
  message.offset[5] = 0.2;
  goals.set(message, GoalType::kPose);
  goals.advance(0.05, 0);
  goals.set(message, GoalType::kPose);
  run_to_rest();
  EXPECT_NEAR(goals.goal().X_BD.p.x(), 0.2, 1e-12);
  EXPECT_NEAR(log_rotation(goals.goal().X_BD.Q).z(), 0.4, 1e-12);
}

TEST_F(Goals, WrenchComesAndGoesSmoothlyAndLeavesTheMotionAlone) {
  message.offset[0] = 0.1;
  goals.set(message, GoalType::kPose);
  goals.advance(0.3, 0);
  const Vector6 V = goals.goal().V_BD;
  message.kind = compliance_goal_t::GOAL_WRENCH;
  message.F_ff[2] = 10.0;
  ASSERT_EQ(goals.set(message, GoalType::kPose), nullptr);
  goals.advance(1e-6, 0);
  EXPECT_LT((goals.goal().V_BD - V).norm(), 1e-4);
  double before = goals.goal().F_ff[2];
  for (int i = 0; i < 200; ++i) {
    goals.advance(kStep, 0);
    EXPECT_LT(goals.goal().F_ff[2] - before, 0.2);
    before = goals.goal().F_ff[2];
  }
  EXPECT_EQ(before, 10.0);
  run_to_rest();
  EXPECT_NEAR(goals.goal().X_BD.p.x(), 0.1, 1e-12);
}

TEST_F(Goals, PostureMovesAlong) {
  message.use_posture = 1;
  message.q[3] = 0.5;
  ASSERT_EQ(goals.set(message, GoalType::kPose), nullptr);
  for (int i = 0; i < 2000; ++i) goals.advance(kStep, 0);
  EXPECT_EQ(goals.goal().q_null[3], 0.5);
  EXPECT_EQ(goals.goal().q_d[3], 0.0) << "the joint goal is another thing";
}

TEST_F(Goals, OnlyWhatTheLawFollows) {
  EXPECT_NE(goals.set(message, GoalType::kNone), nullptr);
  EXPECT_EQ(goals.set(message, GoalType::kJoints), nullptr) << "by inverse kinematics";
  EXPECT_TRUE(goals.at_tip());
  message.kind = compliance_goal_t::GOAL_JOINT;
  EXPECT_NE(goals.set(message, GoalType::kPose), nullptr);
  EXPECT_EQ(goals.set(message, GoalType::kJoints), nullptr);
  EXPECT_FALSE(goals.at_tip());
  message.F_ff[0] = 1.0;
  EXPECT_NE(goals.set(message, GoalType::kJoints), nullptr) << "nobody would exert it";
  EXPECT_EQ(goals.set(message, GoalType::kJointsAndWrench), nullptr);
}

TEST_F(Goals, NothingAllocates) {
  message.offset[0] = 0.1;
  message.use_posture = 1;
  const auto before = limber::allocations();
  goals.set(message, GoalType::kPose);
  goals.advance(0.01, 0);
  goals.stop(0.3);
  goals.advance(0.01, 0);
  EXPECT_EQ(limber::allocations(), before);
}

}  // namespace
}  // namespace limber::controller::test_goals
