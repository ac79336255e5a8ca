// Variable stiffness: the pair's inverse map, and how near diagonal joint stiffness comes.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "controller/elastic/nnls.h"
#include "controller/elastic/vsa_stiffness.h"
#include "lecture/eval/vsa_pair.h"
#include "tests/controller/arms.h"
#include "tools/allocations/allocations.h"

namespace limber::controller::test_vsa {
namespace {

using namespace limber::eval;  // the pair in closed form

constexpr double kK2 = 400.0;

TEST(VsaPair, InverseGivesBackWhatWasAsked) {
  for (const double tau : {-9.0, 0.0, 3.0, 17.9}) {
    const VsaJoint wanted{tau, 120.0};  // carries up to 120^2 / 800 = 18 N m
    ASSERT_TRUE(vsa_feasible(wanted, kK2));
    const VsaMotors motors = vsa_inverse(wanted, 0.4, kK2);
    const VsaJoint got = vsa_forward(motors, 0.4, kK2);
    EXPECT_NEAR(got.tau, tau, 1e-12);
    EXPECT_NEAR(got.sigma, 120.0, 1e-12);
    // Stiffness is the slope of the torque over the link's motion.
    const double h = 1e-6;
    const double slope =
        (vsa_forward(motors, 0.4 - h, kK2).tau - vsa_forward(motors, 0.4 + h, kK2).tau) / (2 * h);
    EXPECT_NEAR(slope, 120.0, 1e-6);
  }
}

TEST(VsaPair, CarryingTorqueNeedsStiffness) {
  EXPECT_TRUE(vsa_feasible({-18.0 + 1e-9, 120.0}, kK2)) << "sqrt(2 k2 18 N m) = 120 N m/rad";
  EXPECT_FALSE(vsa_feasible({18.1, 120.0}, kK2));
  EXPECT_FALSE(vsa_feasible({-18.1, 120.0}, kK2));
  EXPECT_FALSE(vsa_feasible({0.0, 0.0}, kK2));
  EXPECT_FALSE(vsa_feasible({NAN, 120.0}, kK2));
  EXPECT_FALSE(vsa_feasible({0.0, NAN}, kK2));
  // Beyond it one tendon is slack: the other alone gives its own torque and stiffness.
  const VsaJoint got = vsa_forward(vsa_inverse({24.0, 120.0}, 0.0, kK2), 0.0, kK2);
  const double stretch = 120.0 / 800.0 + 24.0 / 120.0;
  EXPECT_NEAR(got.sigma, kK2 * stretch, 1e-12);
  EXPECT_NEAR(got.tau, 0.5 * kK2 * stretch * stretch, 1e-12);
}

// The optimum is the one point with x >= 0, slope h - G x <= 0 and x . slope = 0.
TEST(NonnegativeLeastSquares, MeetsTheOptimalityConditions) {
  std::mt19937 generator(9);
  int held = 0;
  for (const int n : {1, 4, 7, 16}) {
    for (int i = 0; i < 50; ++i) {
      MatrixJ A(n, n);
      for (int k = 0; k < n; ++k) A.col(k) = limber::testing::random_vector(n, 1.0, generator);
      const MatrixJ G = A.transpose() * A;
      const VectorJ h = limber::testing::random_vector(n, 5.0, generator);
      const VectorJ x = nonnegative_least_squares(G, h);
      const VectorJ slope = h - G * x;
      const double size = G.norm() * x.norm() + h.norm();
      EXPECT_GE(x.minCoeff(), 0.0);
      EXPECT_LT(slope.maxCoeff(), 1e-9 * size);
      EXPECT_LT(std::abs(x.dot(slope)), 1e-9 * size * (1.0 + x.norm()));
      held += static_cast<int>((x.array() == 0.0).count());
    }
  }
  EXPECT_GT(held, 100) << "the bound matters";
}

// The planar arm at elbow angle q2: J and the closed form of the share that a diagonal stiffness
// misses of an isotropic request.
TaskJacobian planar_jacobian(double q1, double q2, double l1, double l2) {
  TaskJacobian J(2, 2);
  J << -l1 * std::sin(q1) - l2 * std::sin(q1 + q2), -l2 * std::sin(q1 + q2),
      l1 * std::cos(q1) + l2 * std::cos(q1 + q2), l2 * std::cos(q1 + q2);
  return J;
}

TEST(JointStiffness, MissesOfAnIsotropicRequestWhatTheFormulaSays) {
  constexpr double l1 = 0.5;
  constexpr double l2 = 0.4;
  const TaskMatrix K_x = 300.0 * TaskMatrix::Identity(2, 2);
  for (const double q2 : {0.3, 1.2, std::acos(-0.8), 2.8}) {
    const TaskJacobian J = planar_jacobian(0.4, q2, l1, l2);
    const JointFit fit = nearest_joint_stiffness(J, K_x, MatrixJ::Zero(2, 2));
    const double pp = J.col(0).squaredNorm();
    const double p2 = J.col(0).dot(J.col(1));
    const double residual =
        std::sqrt(2.0) * std::abs(p2) / std::sqrt(pp * pp + 2.0 * p2 * p2 + std::pow(l2, 4));
    EXPECT_NEAR(fit.residual, residual, 1e-12);
    EXPECT_NEAR(fit.value[0], 300.0 * pp, 1e-10);
    EXPECT_NEAR(fit.value[1], 300.0 * l2 * l2, 1e-10);
  }
  // With cos q2 = -l2 / l1 nothing is missed, by either fit, and the tip presents K_x.
  const TaskJacobian J = planar_jacobian(0.4, std::acos(-l2 / l1), l1, l2);
  const MatrixJ none = MatrixJ::Zero(2, 2);
  EXPECT_NEAR(nearest_joint_stiffness(J, K_x, none).residual, 0.0, 1e-12);
  const JointFit compliance = nearest_joint_compliance(J, K_x);
  EXPECT_NEAR(compliance.residual, 0.0, 1e-10);
  const VectorJ sigma = compliance.value.cwiseInverse();
  const TaskMatrix missed = presented_compliance(J, sigma, none) - K_x.inverse();
  EXPECT_LT(missed.norm(), 1e-12);
}

TEST(JointStiffness, FindsTheJointsBehindACompliance) {
  std::mt19937 generator(3);
  TaskJacobian J(6, 7);
  for (int i = 0; i < 7; ++i) J.col(i) = limber::testing::random_six(1.0, generator);
  VectorJ s = VectorJ::Constant(7, 2e-3) + limber::testing::random_vector(7, 1e-3, generator);
  const TaskMatrix C = J * s.asDiagonal() * J.transpose();
  const JointFit fit = nearest_joint_compliance(J, C.inverse());
  EXPECT_LT((fit.value - s).norm(), 1e-9);
  EXPECT_LT(fit.residual, 1e-8);
}

TEST(JointStiffness, LoadEntersThroughTheGeometricStiffness) {
  const TaskJacobian J = planar_jacobian(0.2, 1.1, 0.5, 0.4);
  MatrixJ K_G(2, 2);
  K_G << -8.0, -3.0, -3.0, -2.0;
  const VectorJ sigma = (VectorJ(2) << 60.0, 30.0).finished();
  const Eigen::Matrix2d inverse = Eigen::Matrix2d(J).inverse();
  const Eigen::Matrix2d joint =
      Eigen::Vector2d(sigma).asDiagonal().toDenseMatrix() - Eigen::Matrix2d(K_G);
  const Eigen::Matrix2d K_c = inverse.transpose() * joint * inverse;
  EXPECT_LT((presented_compliance(J, sigma, K_G) * K_c - TaskMatrix::Identity(2, 2)).norm(), 1e-12);
  const TaskMatrix K_x = 100.0 * TaskMatrix::Identity(2, 2);
  const VectorJ with = nearest_joint_stiffness(J, K_x, K_G).value;
  const VectorJ without = nearest_joint_stiffness(J, K_x, MatrixJ::Zero(2, 2)).value;
  EXPECT_LT((with - without - K_G.diagonal()).norm(), 1e-12);
}

TEST(JointStiffness, DoesNotAllocate) {
  TaskJacobian J = TaskJacobian::Ones(6, 16);
  J.leftCols(6) += TaskMatrix::Identity(6, 6);
  const TaskMatrix K_x = TaskMatrix::Identity(6, 6);
  const MatrixJ K_G = MatrixJ::Zero(16, 16);
  const auto before = limber::allocations();
  const double sum = nearest_joint_stiffness(J, K_x, K_G).residual +
                     nearest_joint_compliance(J, K_x).residual +
                     presented_compliance(J, VectorJ::Ones(16), K_G).norm();
  EXPECT_EQ(limber::allocations(), before);
  EXPECT_TRUE(std::isfinite(sum));
}

}  // namespace
}  // namespace limber::controller::test_vsa
