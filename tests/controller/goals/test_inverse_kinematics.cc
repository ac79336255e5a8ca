// Joints that follow a goal at the tip.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "controller/goals/interpolation.h"
#include "controller/goals/inverse_kinematics.h"
#include "controller/model/pose_error.h"
#include "tests/controller/arms.h"
#include "tools/allocations/allocations.h"

namespace limber::controller::test_inverse_kinematics {
namespace {

constexpr double kPeriod_s = 1e-3;

// A goal at the tip on its way, and the joints that follow it.
struct Follower {
  Follower(const LoadedRobot& robot, const Matrix6& K_x, const VectorJ& q)
      : model(robot), rows(K_x), kinematics(model), goal(model.size()), terms(model.size()) {
    motion.reset(model.tip_pose(q));
    kinematics.reset(q);
    goal.q_null = q;
    step(0.0);
  }
  void step(double dt) {
    motion.advance(dt);
    goal.X_BD = motion.X_BD;
    goal.V_BD = motion.V_BD;
    goal.A_BD = motion.A_BD;
    kinematics.track(rows, kPeriod_s, &goal);
    model.evaluate(goal.q_d, goal.v_d, &terms);
  }
  // Of the task's rows.
  double error() {
    const Vector6 e = pose_error(terms.X_BT, goal.X_BD, Orientation::kLog).e;
    double sum = 0.0;
    for (int i = 0; i < 6; ++i) sum += rows.stiff[i] ? e[i] * e[i] : 0.0;
    return std::sqrt(sum);
  }

  ArmModel model;
  TaskRows rows;
  InverseKinematics kinematics;
  PoseMotion motion;
  Goal goal;
  ArmTerms terms;
};

Matrix6 first_rows(int count) {
  Matrix6 K = Matrix6::Zero();
  K.diagonal().head(count).setConstant(100.0);
  return K;
}

Follower planar() {
  return {limber::testing::planar_arm(limber::testing::kDesktop), first_rows(2),
          (VectorJ(2) << 0.3, 1.3).finished()};
}

TEST(InverseKinematics, PlanarArmFollowsACircleWithItsRates) {
  Follower arm = planar();
  arm.motion.circle(Eigen::Vector3d(-0.08, 0.02, 0.0) + arm.motion.X_BD.p, Eigen::Vector3d::UnitZ(),
                    1.0);
  VectorJ q[3];
  VectorJ v[3];
  for (int i = 0; i < 2500; ++i) {
    arm.step(kPeriod_s);
    ASSERT_LT(arm.error(), 1e-9) << i;
    for (VectorJ* history : {q, v}) {
      history[0] = history[1];
      history[1] = history[2];
    }
    q[2] = arm.goal.q_d;
    v[2] = arm.goal.v_d;
    if (i < 2) continue;
    const VectorJ rate = (q[2] - q[0]) / (2.0 * kPeriod_s);
    ASSERT_LT((rate - v[1]).norm(), 1e-3 * (1.0 + v[1].norm())) << i;
  }
  EXPECT_GT(v[1].norm(), 0.5);
  const Vector6 A = arm.terms.J * arm.goal.a_d + arm.terms.Jdot_v;
  EXPECT_LT((A - arm.goal.A_BD).head<2>().norm(), 1e-9);
}

TEST(InverseKinematics, RedundantArmFollowsACircleWhileItsPostureMoves) {
  // Far from singular: the least singular value of J stays above 0.15.
  const VectorJ q = (VectorJ(7) << -0.2, -1.3, 1.2, -1.5, 0.7, 0.1, 0.0).finished();
  Follower arm(limber::testing::seven_joint_arm(), Matrix6::Identity(), q);
  arm.motion.circle(Eigen::Vector3d(0.05, 0.0, 0.0) + arm.motion.X_BD.p,
                    Eigen::Vector3d(0, 1, 1).normalized(), 2.0);
  arm.goal.q_null = q + VectorJ::Constant(7, 0.4);
  VectorJ before = q;
  double travelled = 0.0;
  for (int i = 0; i < 2000; ++i) {
    arm.step(kPeriod_s);
    ASSERT_LT(arm.error(), 1e-9) << i;
    ASSERT_LT((arm.terms.J * arm.goal.v_d - arm.goal.V_BD).norm(), 1e-9) << i;
    const Vector6 A = arm.terms.J * arm.goal.a_d + arm.terms.Jdot_v;
    ASSERT_LT((A - arm.goal.A_BD).norm(), 1e-8) << i;
    if (i > 0) {
      ASSERT_LT(((arm.goal.q_d - before) / kPeriod_s - arm.goal.v_d).norm(), 0.02) << i;
    }
    travelled += (arm.goal.q_d - before).norm();
    before = arm.goal.q_d;
  }
  EXPECT_GT(travelled, 0.3);
}

// The goal leaves the arm's reach and comes back: the joints stay bounded and find it again.
TEST(InverseKinematics, IsBoundedThroughASingularity) {
  Follower arm = planar();
  const Pose home = arm.motion.X_BD;
  VectorJ before = arm.goal.q_d;
  for (const Pose& end : {Pose{{0.9, 0.1, 0.0}, home.Q}, home}) {
    arm.motion.start(end, 1.5);
    for (int i = 0; i < 2000; ++i) {
      arm.step(kPeriod_s);
      ASSERT_TRUE(arm.goal.q_d.allFinite() && arm.goal.v_d.allFinite() && arm.goal.a_d.allFinite());
      ASSERT_LE((arm.goal.q_d - before).cwiseAbs().maxCoeff(), 0.31) << i;
      // |J^+| <= 1 / (2 lambda_max) where it is damped, 1 / sigma_0 elsewhere.
      ASSERT_LE(arm.goal.v_d.norm(), arm.goal.V_BD.norm() / 0.05 + 2.0) << i;
      before = arm.goal.q_d;
    }
  }
  EXPECT_LT(arm.error(), 1e-9);
}

TEST(InverseKinematics, DoesNotAllocate) {
  for (const int n : {1, 2, 6, 7, 16}) {
    Follower arm(limber::testing::random_arm(n, 3, true), Matrix6::Identity(),
                 VectorJ::Constant(n, 0.3));
    const auto before = limber::allocations();
    arm.kinematics.reset(arm.goal.q_d);
    arm.step(kPeriod_s);
    EXPECT_EQ(limber::allocations(), before);
  }
}

TEST(DampedInverse, IsThePseudoInverseAwayFromSingularities) {
  std::mt19937 generator(2);
  for (const int n : {2, 6, 9}) {
    Matrix6J J = Matrix6J::Zero(6, n);
    for (int i = 0; i < n; ++i) J.col(i) = limber::testing::random_six(1.0, generator);
    const Eigen::MatrixXd full = J;
    const DampedInverse found = damped_inverse(J, 1e-6, 0.1);
    EXPECT_EQ(found.lambda, 0.0);
    EXPECT_NEAR(found.sigma_min, full.jacobiSvd().singularValues().minCoeff(), 1e-9);
    EXPECT_LT((found.inverse - full.completeOrthogonalDecomposition().pseudoInverse()).norm(),
              1e-6);
  }
}

// J = diag(1, s): 1/s without damping, s / (s^2 + lambda^2) with it, at most 1 / (2 lambda).
TEST(DampedInverse, IsDampedBelowItsThreshold) {
  for (const double s : {0.04, 0.01, 1e-4}) {
    Matrix6J J = Matrix6J::Zero(6, 2);
    J(0, 0) = 1.0;
    J(1, 1) = s;
    const DampedInverse found = damped_inverse(J, 0.05, 0.1);
    const double lambda = 0.1 * std::sqrt(1.0 - s * s / (0.05 * 0.05));
    EXPECT_NEAR(found.lambda, lambda, 1e-9);
    EXPECT_NEAR(found.inverse(1, 1), s / (s * s + lambda * lambda), 1e-9);
    EXPECT_NEAR(found.inverse(0, 0), 1.0 / (1.0 + lambda * lambda), 1e-9);
    EXPECT_LE(found.inverse.row(1).norm(), 1.0 / (2.0 * lambda));
  }
}

}  // namespace
}  // namespace limber::controller::test_inverse_kinematics
