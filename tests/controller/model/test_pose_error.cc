// Rotation vectors and pose errors against their definitions.
#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "controller/model/pose_error.h"
#include "controller/model/rotation.h"
#include "tests/controller/arms.h"

namespace limber::controller::test_pose_error {
namespace {

constexpr double kPi = std::numbers::pi;

// From nothing to just short of half a turn.
constexpr double kAngles[] = {0.0, 1e-12, 1e-9, 1e-6, 1e-4, 9.9e-3,     1.01e-2,   0.1,
                              0.7, 1.5,   2.5,  3.0,  3.1,  kPi - 1e-4, kPi - 1e-7};

Eigen::Vector3d random_axis(std::mt19937& generator) {
  return limber::testing::random_six(1.0, generator).head<3>().normalized();
}

TEST(Rotation, LogIsTheInverseOfExp) {
  std::mt19937 generator(1);
  for (const double angle : kAngles) {
    const Eigen::Vector3d phi = angle * random_axis(generator);
    const Eigen::Quaterniond Q = exp_rotation(phi);
    EXPECT_NEAR(Q.norm(), 1.0, 1e-15);
    EXPECT_LT((log_rotation(Q) - phi).norm(), 4e-15 * (1.0 + angle)) << angle;
    const Eigen::Quaterniond other(-Q.w(), -Q.x(), -Q.y(), -Q.z());
    EXPECT_LT((log_rotation(other) - phi).norm(), 4e-15 * (1.0 + angle)) << "sign at " << angle;
    const Eigen::AngleAxisd reference(
        angle, angle > 0.0 ? Eigen::Vector3d(phi.normalized()) : Eigen::Vector3d::UnitX());
    EXPECT_LT((Q.toRotationMatrix() - reference.toRotationMatrix()).norm(), 1e-14) << angle;
  }
}

TEST(Rotation, HalfATurnHasOneOfItsTwoLogs) {
  const Eigen::Vector3d log = log_rotation(Eigen::Quaterniond(0.0, 0.6, 0.0, 0.8));
  EXPECT_NEAR(log.norm(), kPi, 1e-15);
  EXPECT_NEAR(std::abs(log.x()), 0.6 * kPi, 1e-15);
}

TEST(Rotation, LeftJacobianRelatesRatesToAngularVelocity) {
  std::mt19937 generator(2);
  constexpr double h = 1e-6;
  for (const double angle : kAngles) {
    const Eigen::Vector3d phi = angle * random_axis(generator);
    const Eigen::Vector3d rate = random_axis(generator);
    const Eigen::Vector3d omega =
        log_rotation(exp_rotation(phi + h * rate) * exp_rotation(phi - h * rate).conjugate()) /
        (2 * h);
    EXPECT_LT((left_jacobian(phi) * rate - omega).norm(), 1e-9) << angle;
    EXPECT_LT(
        (left_jacobian(phi) * left_jacobian_inverse(phi) - Eigen::Matrix3d::Identity()).norm(),
        2e-14)
        << angle;
    const Eigen::Matrix3d change =
        (left_jacobian(phi + h * rate) - left_jacobian(phi - h * rate)) / (2 * h);
    EXPECT_LT((left_jacobian_rate(phi, rate) - change).norm(), 1e-9) << angle;
  }
}

class PoseErrorModes : public ::testing::TestWithParam<Orientation> {};
INSTANTIATE_TEST_SUITE_P(All, PoseErrorModes,
                         ::testing::Values(Orientation::kLog, Orientation::kQuat));

// e' = A V with the target at rest, by central difference along V.
TEST_P(PoseErrorModes, RateMatrixIsTheDerivative) {
  std::mt19937 generator(3);
  constexpr double h = 1e-6;
  for (const double angle : kAngles) {
    if (angle > 3.14) continue;  // a step of h must not cross the jump
    const Pose X_BD{Eigen::Vector3d(0.3, -0.2, 0.5), exp_rotation(2.0 * random_axis(generator))};
    const Pose X_BT{X_BD.p + 0.1 * random_axis(generator),
                    exp_rotation(angle * random_axis(generator)) * X_BD.Q};
    const Vector6 V = limber::testing::random_six(1.0, generator);
    const auto moved = [&](double t) {
      return Pose{X_BT.p + t * V.head<3>(), exp_rotation(t * V.tail<3>()) * X_BT.Q};
    };
    const Vector6 rate =
        (pose_error(moved(h), X_BD, GetParam()).e - pose_error(moved(-h), X_BD, GetParam()).e) /
        (2 * h);
    EXPECT_LT((pose_error(X_BT, X_BD, GetParam()).A * V - rate).norm(), 2e-8) << angle;
  }
}

TEST_P(PoseErrorModes, SignOfAQuaternionMeansNothing) {
  const Pose X_BD{Eigen::Vector3d::Zero(), exp_rotation({0.3, 0.1, -0.4})};
  const Pose X_BT{Eigen::Vector3d::UnitX(), exp_rotation({-0.5, 0.9, 1.2})};
  Pose other = X_BT;
  other.Q.coeffs() *= -1.0;
  const PoseError a = pose_error(X_BT, X_BD, GetParam());
  const PoseError b = pose_error(other, X_BD, GetParam());
  EXPECT_EQ(a.e, b.e);
  EXPECT_EQ(a.A, b.A);
}

// One-axis moments of a spring k: k phi for log, k sin(phi) for quat; the error itself is actual
// minus desired.
TEST(PoseError, MomentOfAnIsotropicSpring) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, 3).normalized();
  for (const double phi : {1e-5, 0.2, 1.0, 2.0, 3.0}) {
    const Pose X_BD;
    const Pose X_BT{Eigen::Vector3d(0.01, 0, 0), exp_rotation(phi * axis)};
    const PoseError log = pose_error(X_BT, X_BD, Orientation::kLog);
    const PoseError quat = pose_error(X_BT, X_BD, Orientation::kQuat);
    EXPECT_LT(((log.A.transpose() * log.e).tail<3>() - phi * axis).norm(), 1e-13);
    EXPECT_LT(((quat.A.transpose() * quat.e).tail<3>() - std::sin(phi) * axis).norm(), 1e-13);
    EXPECT_EQ(log.e.head<3>(), Eigen::Vector3d(0.01, 0, 0));
  }
}

}  // namespace
}  // namespace limber::controller::test_pose_error
