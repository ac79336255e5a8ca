// Damping design, null space and what happens to both near singularities.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <complex>

#include "controller/gains/read_gains.h"
#include "controller/impedance/damping_design.h"
#include "controller/impedance/nullspace.h"
#include "controller/model/singularity.h"
#include "tests/controller/arms.h"
#include "tools/allocations/allocations.h"

namespace limber::controller::test_damping {
namespace {

using limber::testing::random_vector;

struct Pendulum {
  explicit Pendulum(const LoadedRobot& robot) : model(robot), terms(model.size()) {}
  const ArmTerms& at(const VectorJ& q) {
    model.evaluate(q, VectorJ::Zero(q.size()), &terms);
    return terms;
  }
  ArmModel model;
  ArmTerms terms;
};

// Damping ratios of all modes of M s^2 + D s + K that oscillate or are overdamped (s = 0 left out).
std::vector<double> modal_ratios(const Eigen::MatrixXd& M, const Eigen::MatrixXd& D,
                                 const Eigen::MatrixXd& K) {
  const auto n = M.rows();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  A.topRightCorner(n, n).setIdentity();
  A.bottomLeftCorner(n, n) = -M.inverse() * K;
  A.bottomRightCorner(n, n) = -M.inverse() * D;
  std::vector<double> ratios;
  for (const std::complex<double>& s : A.eigenvalues()) {
    if (std::abs(s) > 0.1) ratios.push_back(-s.real() / std::abs(s));
  }
  return ratios;
}

TEST(DampingDesign, EveryJointModeHasTheRatio) {
  std::mt19937 generator(1);
  for (const double ratio : {0.2, 0.7}) {
    for (const int n : {1, 2, 7, 16}) {
      Pendulum arm(limber::testing::random_arm(n, 3, true));
      const MatrixJ M = arm.at(random_vector(n, 1.0, generator)).M_total;
      MatrixJ K = MatrixJ::Zero(n, n);
      K.diagonal() = VectorJ::Constant(n, 60.0) + random_vector(n, 50.0, generator);
      const MatrixJ D = joint_damping(DampingDesign::kDoubleDiagonalisation, M, K, ratio);
      EXPECT_LT((D - D.transpose()).norm(), 1e-12 * D.norm());
      const auto ratios = modal_ratios(M, D, K);
      EXPECT_EQ(std::ssize(ratios), 2 * n);
      for (const double found : ratios) EXPECT_NEAR(found, ratio, 1e-6);
    }
  }
}

TEST(DampingDesign, EveryTipModeHasTheRatio) {
  std::mt19937 generator(2);
  Pendulum arm(limber::testing::seven_joint_arm());
  for (int i = 0; i < 20; ++i) {
    const ArmTerms& terms = arm.at(VectorJ::Constant(7, 0.6) + random_vector(7, 0.3, generator));
    const Matrix6 K = limber::testing::random_stiffness(500.0, 20.0, generator);
    const Matrix6 D =
        tip_damping(DampingDesign::kDoubleDiagonalisation, tip_mobility(terms.tip.G), K, 0.7);
    const Matrix6 Lambda = (terms.J * terms.Minv_JT).inverse();
    const auto ratios = modal_ratios(Lambda, D, K);
    EXPECT_EQ(ratios.size(), 12u);
    for (const double found : ratios) EXPECT_NEAR(found, 0.7, 1e-6);
  }
}

// An arm that cannot reach all six directions, whatever the spring says there: what counts is the
// motion it has.
TEST(DampingDesign, ModesOfAPlanarArmHaveTheRatio) {
  std::mt19937 generator(3);
  Pendulum arm(limber::testing::planar_arm(limber::testing::kDesktop));
  for (int i = 0; i < 20; ++i) {
    const VectorJ q = (VectorJ(2) << 0.3, 1.2).finished() + random_vector(2, 0.4, generator);
    const ArmTerms& terms = arm.at(q);
    const Matrix6 K = limber::testing::random_stiffness(500.0, 20.0, generator);
    const Matrix6 D =
        tip_damping(DampingDesign::kDoubleDiagonalisation, tip_mobility(terms.tip.G), K, 0.6);
    EXPECT_TRUE(D.allFinite());
    EXPECT_LT(D.cwiseAbs().maxCoeff(), 1e4) << "nothing grows without bound out of reach";
    const auto ratios = modal_ratios(terms.M_total, terms.J.transpose() * D * terms.J,
                                     terms.J.transpose() * K * terms.J);
    EXPECT_EQ(ratios.size(), 4u);
    for (const double found : ratios) EXPECT_NEAR(found, 0.6, 1e-6);
  }
}

TEST(DampingDesign, IsPositiveSemidefiniteEvenWithoutStiffness) {
  Pendulum arm(limber::testing::seven_joint_arm());
  const ArmTerms& terms = arm.at(VectorJ::Constant(7, 0.6));
  const TipMobility mobility = tip_mobility(terms.tip.G);
  EXPECT_EQ(
      tip_damping(DampingDesign::kDoubleDiagonalisation, mobility, Matrix6::Zero(), 0.7).norm(),
      0.0);
  Matrix6 K = Matrix6::Zero();
  K.topLeftCorner<3, 3>().diagonal().setConstant(500.0);
  const Matrix6 D = tip_damping(DampingDesign::kDoubleDiagonalisation, mobility, K, 0.7);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6>(D).eigenvalues().minCoeff(), -1e-9 * D.norm());
}

TEST(DampingFloor, ActsWhereThereIsNoStiffnessOnly) {
  EXPECT_LT(
      (tip_damping_floor(Matrix6::Zero()).diagonal().head<3>() - Eigen::Vector3d::Constant(5.0))
          .norm(),
      1e-12);
  EXPECT_NEAR(tip_damping_floor(Matrix6::Zero())(5, 5), 0.2, 1e-12);
  Matrix6 K = Matrix6::Zero();
  K.diagonal() << 500.0, 500.0, 10.0, 20.0, 20.0, 0.9;
  EXPECT_EQ(tip_damping_floor(K).norm(), 0.0);
  // A stiffness across the axes: the free direction between them is damped, the stiff one is not.
  K.setZero();
  K.topLeftCorner<2, 2>() << 250.0, 250.0, 250.0, 250.0;
  const Matrix6 D = tip_damping_floor(K);
  const Eigen::Vector2d stiff = Eigen::Vector2d(1, 1).normalized();
  const Eigen::Vector2d free = Eigen::Vector2d(1, -1).normalized();
  EXPECT_NEAR(stiff.dot(D.topLeftCorner<2, 2>() * stiff), 0.0, 1e-12);
  EXPECT_NEAR(free.dot(D.topLeftCorner<2, 2>() * free), 5.0, 1e-12);

  const MatrixJ M = 0.4 * MatrixJ::Identity(2, 2);
  MatrixJ K_q = MatrixJ::Zero(2, 2);
  K_q(1, 1) = 30.0;
  const VectorJ floor = joint_damping_floor(M, K_q);
  EXPECT_NEAR(floor[0], 0.8, 1e-12);
  EXPECT_EQ(floor[1], 0.0);
}

TEST(Mobility, IsTheTipsInverseInertia) {
  Pendulum arm(limber::testing::seven_joint_arm());
  const ArmTerms& terms = arm.at(VectorJ::Constant(7, 0.6));
  const TipMobility mobility = tip_mobility(terms.tip.G);
  const Matrix6 Lambda = damped_tip_inertia(mobility, mobility.threshold(1e-9));
  EXPECT_LT((Lambda * terms.J * terms.Minv_JT - Matrix6::Identity()).norm(), 1e-9);
}

TEST(Mobility, InertiaStaysBoundedAndContinuousThroughASingularity) {
  Pendulum arm(limber::testing::planar_arm(limber::testing::kDesktop));
  Matrix6 before = Matrix6::Zero();
  for (double elbow = 0.3; elbow > -0.3; elbow -= 1e-4) {
    const ArmTerms& terms = arm.at((VectorJ(2) << 0.2, elbow).finished());
    const TipMobility mobility = tip_mobility(terms.tip.G);
    const double threshold = mobility.threshold(1e-3);
    const Matrix6 Lambda = damped_tip_inertia(mobility, threshold);
    ASSERT_TRUE(Lambda.allFinite());
    ASSERT_LE(Lambda.norm(), 4.0 / threshold);
    if (before.norm() > 0.0) {
      ASSERT_LT((Lambda - before).norm(), 0.05 / threshold);
    }
    before = Lambda;
  }
}

TEST(NullSpace, DoesNotAccelerateTheTip) {
  std::mt19937 generator(4);
  Pendulum arm(limber::testing::seven_joint_arm());
  const TaskRows all(Matrix6::Identity());
  for (int i = 0; i < 20; ++i) {
    const ArmTerms& terms = arm.at(VectorJ::Constant(7, 0.6) + random_vector(7, 0.3, generator));
    const VectorJ tau_0 = random_vector(7, 10.0, generator);
    const VectorJ tau = (null_space_projector(terms, all, Projector::kDynamic) * tau_0);
    EXPECT_LT((terms.Minv_JT.transpose() * tau).norm(), 1e-9);
    EXPECT_GT(tau.norm(), 1e-3);
    EXPECT_LT(((null_space_projector(terms, all, Projector::kDynamic) * tau) - tau).norm(), 1e-9)
        << "a projection";
    // The null vector's share of a torque is untouched: z^T N = z^T.
    const Eigen::MatrixXd J = terms.J;
    const Eigen::VectorXd z = J.fullPivLu().kernel().col(0);
    EXPECT_NEAR(z.dot(tau), z.dot(tau_0), 1e-9 * z.norm() * tau_0.norm());
  }
}

TEST(NullSpace, IsEmptyWhereNothingIsLeftOver) {
  Pendulum arm(limber::testing::planar_arm(limber::testing::kDesktop));
  const ArmTerms& terms = arm.at((VectorJ(2) << 0.3, 1.2).finished());
  const VectorJ tau_0 = (VectorJ(2) << 3.0, -2.0).finished();
  EXPECT_LT(
      (null_space_projector(terms, TaskRows(Matrix6::Identity()), Projector::kDynamic) * tau_0)
          .norm(),
      1e-12);
  Matrix6 x_only = Matrix6::Zero();
  x_only(0, 0) = 100.0;
  const VectorJ tau = (null_space_projector(terms, TaskRows(x_only), Projector::kDynamic) * tau_0);
  EXPECT_NEAR(terms.Minv_JT.col(0).dot(tau), 0.0, 1e-12) << "x is the task";
  EXPECT_GT(tau.norm(), 0.1) << "y is free";
  EXPECT_EQ((null_space_projector(terms, TaskRows(Matrix6::Zero()), Projector::kDynamic) * tau_0),
            tau_0);
}

TEST(NullSpace, TorqueIsLimitedAndContinuousThroughASingularity) {
  const LoadedRobot robot = limber::testing::seven_joint_arm();
  Pendulum arm(robot);
  ControlPoint state(7);
  Goal goal(7);
  Gains gains = default_gains(robot.robot, {});
  gains.K_null.setConstant(1e4);
  const VectorJ limit = VectorJ::Constant(7, 2.0);
  const TaskRows rows(gains.K_x);
  VectorJ before;
  for (double bend = 0.3; bend > -0.3; bend -= 2e-4) {
    state.q.setConstant(bend);  // passes the stretched arm
    goal.q_null = state.q + VectorJ::Constant(7, 0.5);
    const VectorJ tau = null_space_torque(state, arm.at(state.q), goal, gains, rows, limit);
    ASSERT_TRUE(tau.allFinite());
    ASSERT_LT(tau.norm(), 60.0);
    if (before.size() > 0) {
      ASSERT_LT((tau - before).norm(), 0.5) << "at " << bend;
    }
    before = tau;
  }
}

TEST(Design, DoesNotAllocate) {
  for (const int n : {1, 2, 7, 16}) {
    Pendulum arm(limber::testing::random_arm(n, 3, false));
    const ArmTerms& terms = arm.at(VectorJ::Constant(n, 0.5));
    const VectorJ ones = VectorJ::Ones(n);
    const MatrixJ K = MatrixJ::Identity(n, n);
    const auto before = limber::allocations();
    const TipMobility mobility = tip_mobility(terms.tip.G);
    const Matrix6 D =
        tip_damping(DampingDesign::kDoubleDiagonalisation, mobility, Matrix6::Identity(), 0.7);
    const MatrixJ D_q = joint_damping(DampingDesign::kDoubleDiagonalisation, terms.M_total, K, 0.7);
    const VectorJ tau = (null_space_projector(terms, TaskRows(D), Projector::kDynamic) * ones);
    EXPECT_EQ(limber::allocations(), before);
    EXPECT_TRUE(D_q.allFinite() && tau.allFinite());
  }
}

}  // namespace
}  // namespace limber::controller::test_damping
