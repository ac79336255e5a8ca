#include "controller/pose_error.h"

#include "controller/rotation.h"

namespace limber::controller {

PoseError pose_error(const Pose& X_BT, const Pose& X_BD, Orientation orientation) noexcept {
  PoseError error;
  error.A.setIdentity();
  error.e.head<3>() = X_BT.p - X_BD.p;
  Eigen::Quaterniond difference = X_BT.Q * X_BD.Q.conjugate();
  if (difference.w() < 0.0) difference.coeffs() *= -1.0;
  if (orientation == Orientation::kLog) {
    error.e.tail<3>() = log_rotation(difference);
    error.A.bottomRightCorner<3, 3>() = left_jacobian_inverse(error.e.tail<3>());
  } else {
    error.e.tail<3>() = 2.0 * difference.vec();
    error.A.bottomRightCorner<3, 3>() =
        difference.w() * Eigen::Matrix3d::Identity() - cross_matrix(difference.vec());
  }
  return error;
}

}  // namespace limber::controller
