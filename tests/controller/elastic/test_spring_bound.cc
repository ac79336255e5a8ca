// How stiff an arm may be made through its springs while these carry its weight.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <string>

#include "controller/elastic/joint_springs.h"
#include "tests/controller/rig.h"

namespace limber::controller::test_spring_bound {
namespace {

// The arm of antagonist2r: rods of 0.5 and 0.4 m, 4 kg at 0.25 m and 2.5 kg at 0.2 m.
struct TwoRods {
  double a, b;  // of the rods against the horizontal
  TwoRods(double q1, double q2) : a(q1), b(q1 + q2) {}

  Eigen::Matrix2d tip_stiffness(double k) const {
    Eigen::Matrix2d J;
    J << -0.5 * std::sin(a) - 0.4 * std::sin(b), -0.4 * std::sin(b),  //
        0.5 * std::cos(a) + 0.4 * std::cos(b), 0.4 * std::cos(b);
    return k * J.transpose() * J;
  }
  Eigen::Matrix2d gravity_gradient() const {
    const double far = -9.81 * 2.5 * 0.2 * std::sin(b);
    const double near = -9.81 * (4.0 * 0.25 + 2.5 * 0.5) * std::sin(a);
    return (Eigen::Matrix2d() << near + far, far, far, far).finished();
  }
};

constexpr double kSpring = 2.0 * 400.0 * 0.25;  // 2 k2 c at the preload of robot.yaml

// Both rods point up, so that the weight buckles in every direction.
TEST(SpringBound, LeavesTheWeightItsShare) {
  const TwoRods arm(0.5, 1.0);
  const Eigen::Matrix2d K = arm.tip_stiffness(250.0);
  const Eigen::Matrix2d most = 0.9 * kSpring * Eigen::Matrix2d::Identity() + arm.gravity_gradient();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d> eigen(K, most);
  const VectorJ K_J = VectorJ::Constant(2, kSpring);
  Eigen::Index joint = -1;
  const double taken = JointSprings::taken(K, K_J, arm.gravity_gradient(), &joint);
  EXPECT_NEAR(taken, eigen.eigenvalues().maxCoeff(), 1e-9);
  EXPECT_EQ(joint, 0);
  EXPECT_NEAR(JointSprings::allowed_share(K, K_J, arm.gravity_gradient()), 1.0 / taken, 1e-9);
  // A weight that hangs makes nothing stiffer than its spring.
  EXPECT_NEAR(JointSprings::taken(K, K_J, -arm.gravity_gradient()),
              JointSprings::taken(K, K_J, MatrixJ::Zero(2, 2)), 1e-9);
}

TEST(SpringBound, RefusesWithHowMuchWhereAndWhatToDo) {
  limber::testing::Rig rig(load_robot("antagonist2r"), "cartesian_impedance");
  ArmController& controller = rig.controller;
  compliance_gains_t gains = rig.gains();
  EXPECT_EQ(controller.on_gains(gains), nullptr);
  for (int i = 0; i < 3; ++i) gains.K_x[i][i] = 250.0F;
  const Refusal stiff = controller.on_gains(gains);
  EXPECT_EQ(stiff.code, +request_answer_t::REFUSED_SPRINGS);
  const TwoRods arm(0.5, 1.0);
  const Eigen::Matrix2d most = 0.9 * kSpring * Eigen::Matrix2d::Identity() + arm.gravity_gradient();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::Matrix2d> eigen(arm.tip_stiffness(250.0),
                                                                        most);
  const auto percent = std::to_string(std::lround(100.0 * eigen.eigenvalues().maxCoeff() - 100.0));
  EXPECT_STREQ(stiff.reason, ("K_x is " + percent +
                              " % more than the joints' springs, less the weight, allow in this "
                              "pose (shoulder most): lower it, or choose position_feedback motor, "
                              "which takes more in series with them")
                                 .c_str());
  gains.position_feedback = compliance_gains_t::POSITION_MOTOR;
  EXPECT_EQ(controller.on_gains(gains), nullptr);
}

// Whatever the pose: springs, weight and what is allowed of K_x together hold the link, and no more
// of it would leave a tenth of the springs.
TEST(SpringBound, WhatItAllowsLeavesATenthOfTheSprings) {
  const VectorJ K_J = VectorJ::Constant(2, kSpring);
  int reduced = 0;
  for (double q1 = -3.0; q1 < 3.0; q1 += 0.1) {
    for (double q2 = -3.0; q2 < 3.0; q2 += 0.1) {
      const TwoRods arm(q1, q2);
      const Eigen::Matrix2d K = arm.tip_stiffness(300.0);
      const double share = JointSprings::allowed_share(K, K_J, arm.gravity_gradient());
      const auto least_left = [&](double of_K) {
        const Eigen::Matrix2d left =
            kSpring * Eigen::Matrix2d::Identity() + arm.gravity_gradient() - of_K * K;
        return left.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff();
      };
      ASSERT_GE(least_left(share), 0.1 * kSpring - 1e-6) << q1 << ' ' << q2;
      if (share < 1.0 && q1 > 0.0 && q2 > 0.0 && q1 + q2 < 3.0) {
        ++reduced;
        ASSERT_NEAR(least_left(share), 0.1 * kSpring, 1e-6) << q1 << ' ' << q2;
      }
    }
  }
  EXPECT_GT(reduced, 50);
}

}  // namespace
}  // namespace limber::controller::test_spring_bound
