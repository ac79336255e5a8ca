#include "controller/model/pose_error.h"

#include <cmath>
#include <numbers>

#include "controller/model/rotation.h"

namespace limber::controller {
namespace {

// Closest the cosine of the pitch may come to zero in the rate matrix.
constexpr double kSmallestCosine = 1e-6;

Eigen::Vector3d roll_pitch_yaw(const Eigen::Matrix3d& R) noexcept {
  return {std::atan2(R(2, 1), R(2, 2)), std::atan2(-R(2, 0), std::hypot(R(2, 1), R(2, 2))),
          std::atan2(R(1, 0), R(0, 0))};
}

Eigen::Matrix3d roll_pitch_yaw_rate(const Eigen::Vector3d& rpy) noexcept {
  const double sy = std::sin(rpy[2]);
  const double cy = std::cos(rpy[2]);
  const double cosine = std::cos(rpy[1]);
  const double cp = std::copysign(std::max(std::abs(cosine), kSmallestCosine), cosine);
  const double tp = std::sin(rpy[1]) / cp;
  Eigen::Matrix3d rate;
  rate << cy / cp, sy / cp, 0.0, -sy, cy, 0.0, cy * tp, sy * tp, 1.0;
  return rate;
}

void rotation_error(const Eigen::Quaterniond& Q, const Eigen::Quaterniond& Q_d,
                    Orientation orientation, PoseError* error) noexcept {
  auto e = error->e.tail<3>();
  auto A = error->A.bottomRightCorner<3, 3>();
  Eigen::Quaterniond difference = Q * Q_d.conjugate();
  if (difference.w() < 0.0) difference.coeffs() *= -1.0;
  switch (orientation) {
    case Orientation::kLog:
      e = log_rotation(difference);
      A = left_jacobian_inverse(e);
      return;
    case Orientation::kLogSimple:
      e = log_rotation(difference);
      return;
    case Orientation::kQuat:
      e = 2.0 * difference.vec();
      A = difference.w() * Eigen::Matrix3d::Identity() - cross_matrix(difference.vec());
      return;
    case Orientation::kQuatSimple:
      e = 2.0 * difference.vec();
      return;
    case Orientation::kRollPitchYaw: {
      const Eigen::Vector3d rpy = roll_pitch_yaw(Q.toRotationMatrix());
      const Eigen::Vector3d from = roll_pitch_yaw(Q_d.toRotationMatrix());
      e = (rpy - from).unaryExpr([](double x) {
        return std::remainder(x, 2.0 * std::numbers::pi);
      });
      A = roll_pitch_yaw_rate(rpy);
      return;
    }
  }
}

}  // namespace

PoseError pose_error(const Pose& X_BT, const Pose& X_BD, Orientation orientation) noexcept {
  PoseError error;
  error.A.setIdentity();
  error.e.head<3>() = X_BT.p - X_BD.p;
  rotation_error(X_BT.Q, X_BD.Q, orientation, &error);
  return error;
}

}  // namespace limber::controller
