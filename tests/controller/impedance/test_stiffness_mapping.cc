// A Cartesian stiffness in joint coordinates, against finite differences and the planar closed
// form.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "controller/impedance/stiffness_mapping.h"
#include "controller/model/pose_error.h"
#include "tests/controller/arms.h"

namespace limber::controller::test_stiffness_mapping {
namespace {

using limber::testing::random_arm;
using limber::testing::random_six;
using limber::testing::random_stiffness;
using limber::testing::random_vector;

constexpr double kStep = 1e-5;

// d f / dq by central differences, one column a joint.
template <typename Function>
Eigen::MatrixXd slope(const VectorJ& q, Function f) {
  const auto n = q.size();
  Eigen::MatrixXd result(f(q).size(), n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const VectorJ step = kStep * VectorJ::Unit(n, k);
    result.col(k) = (f(q + step) - f(q - step)) / (2.0 * kStep);
  }
  return result;
}

// A pose within half a turn of where the arm is.
Pose near(const Pose& X, std::mt19937& generator) {
  const Vector6 x = random_six(1.0, generator);
  return {X.p + 0.2 * x.head<3>(),
          (Eigen::AngleAxisd(1.2, x.tail<3>().normalized()) * X.Q).normalized()};
}

TEST(GeometricTerm, IsTheSlopeOfTheTransposedJacobian) {
  std::mt19937 generator(1);
  for (int n = 1; n <= 16; ++n) {
    ArmModel model(random_arm(n, static_cast<unsigned>(n), n % 2 == 0));
    const VectorJ q = random_vector(n, 1.5, generator);
    const Vector6 W = random_six(10.0, generator);
    const MatrixJ K_G = geometric_term(model.jacobian(q), W);
    const Eigen::MatrixXd expected =
        slope(q, [&](const VectorJ& at) -> VectorJ { return model.jacobian(at).transpose() * W; });
    EXPECT_LT((K_G - expected).norm(), 1e-7 * (1.0 + expected.norm())) << n << " joints";
  }
}

TEST(GeometricTerm, OfAPlanarArmIsThatOfTheTextbooks) {
  const auto lengths = limber::testing::kDesktop;
  ArmModel model(limber::testing::planar_arm(lengths));
  const VectorJ q = (VectorJ(2) << 0.4, 1.1).finished();
  const Vector6 W = (Vector6() << 30.0, -20.0, 0, 0, 0, 0).finished();
  const Eigen::Vector2d f = W.head<2>();
  const Eigen::Vector2d p2 = lengths.a2 * Eigen::Vector2d(std::cos(1.5), std::sin(1.5));
  const Eigen::Vector2d p = p2 + lengths.a1 * Eigen::Vector2d(std::cos(0.4), std::sin(0.4));
  Eigen::Matrix2d expected;
  expected << p.dot(f), p2.dot(f), p2.dot(f), p2.dot(f);
  EXPECT_LT((geometric_term(model.jacobian(q), W) + expected).norm(), 1e-12 * expected.norm());
}

TEST(FullTangent, OfAPositionIsFirstPlusGeometricTerm) {
  std::mt19937 generator(2);
  for (int n = 1; n <= 16; ++n) {
    ArmModel model(random_arm(n, static_cast<unsigned>(n), n % 2 == 0));
    const VectorJ q = random_vector(n, 1.5, generator);
    const Pose X_BD = near(model.tip_pose(q), generator);
    Matrix6 K = random_stiffness(500.0, 20.0, generator);
    K.rightCols<3>().setZero();
    K.bottomRows<3>().setZero();
    const PoseError error = pose_error(model.tip_pose(q), X_BD, Orientation::kLog);
    const Matrix6J J = model.jacobian(q);
    const MatrixJ sum = J.transpose() * K * J + geometric_term(J, K * error.e);
    const MatrixJ K_q = full_tangent(&model, q, X_BD, K, Orientation::kLog);
    EXPECT_LT((K_q - sum).norm(), 1e-6 * (1.0 + sum.norm())) << n << " joints";
    EXPECT_LT(
        (joint_stiffness(StiffnessTerms::kGeometric, &model, q, X_BD, K, Orientation::kLog) - sum)
            .norm(),
        1e-12 * sum.norm());
  }
}

// The torque that holds the deviation is the gradient of e^T K e / 2, and its slope symmetric, for
// the errors that have a potential; the simple ones have none.
TEST(FullTangent, IsSymmetricWhereThereIsAPotential) {
  std::mt19937 generator(3);
  for (int i = 0; i < 20; ++i) {
    const int n = 2 + i % 8;
    ArmModel model(random_arm(n + 5, static_cast<unsigned>(i), false));
    const VectorJ q = random_vector(n + 5, 1.0, generator);
    const Pose X_BD = near(model.tip_pose(q), generator);
    const Matrix6 K = random_stiffness(500.0, 50.0, generator);
    for (const auto orientation : {Orientation::kLog, Orientation::kQuat, Orientation::kLogSimple,
                                   Orientation::kQuatSimple}) {
      const Eigen::MatrixXd expected = slope(
          q, [&](const VectorJ& at) { return holding_torque(&model, at, X_BD, K, orientation); });
      const double skew = (expected - expected.transpose()).norm() / expected.norm();
      const bool simple =
          orientation == Orientation::kLogSimple || orientation == Orientation::kQuatSimple;
      if (simple) {
        EXPECT_GT(skew, 1e-3) << i;
      } else {
        EXPECT_LT(skew, 1e-7) << i;
        const Eigen::MatrixXd gradient = slope(q, [&](const VectorJ& at) {
          const Vector6 e = pose_error(model.tip_pose(at), X_BD, orientation).e;
          return Eigen::Matrix<double, 1, 1>(0.5 * e.dot(K * e));
        });
        const VectorJ torque = holding_torque(&model, q, X_BD, K, orientation);
        EXPECT_LT((gradient.transpose() - torque).norm(), 1e-6 * (1.0 + torque.norm())) << i;
      }
      const MatrixJ K_q = full_tangent(&model, q, X_BD, K, orientation);
      EXPECT_LT((K_q - expected).norm(), 1e-6 * expected.norm()) << i;
    }
  }
}

TEST(DampingTangent, IsTheSlopeOfTheDampingTorque) {
  std::mt19937 generator(4);
  for (int n = 1; n <= 16; ++n) {
    ArmModel model(random_arm(n, static_cast<unsigned>(n), n % 2 == 0));
    const VectorJ q = random_vector(n, 1.5, generator);
    const VectorJ v = random_vector(n, 1.0, generator);
    const Matrix6 D = random_stiffness(30.0, 2.0, generator);
    const DampingTangent tangent = damping_tangent(&model, q, v, D);
    const Eigen::MatrixXd expected = slope(q, [&](const VectorJ& at) -> VectorJ {
      const Matrix6J J = model.jacobian(at);
      return J.transpose() * (D * (J * v));
    });
    EXPECT_LT((tangent.transpose_part + tangent.velocity_part - expected).norm(),
              1e-6 * (1.0 + expected.norm()))
        << n << " joints";
    const Vector6 F = D * (model.jacobian(q) * v);
    EXPECT_LT((tangent.transpose_part - geometric_term(model.jacobian(q), F)).norm(),
              1e-6 * (1.0 + expected.norm()))
        << n << " joints";
  }
}

}  // namespace
}  // namespace limber::controller::test_stiffness_mapping
