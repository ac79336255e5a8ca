#include "controller/observers/admittance_filter.h"

#include "controller/model/positive.h"
#include "controller/model/rotation.h"

namespace limber::controller {

AdmittanceFilter::AdmittanceFilter(const MatrixJ& M, const MatrixJ& D, const MatrixJ& K, double T)
    : T_(positive(T, "the sample time")),
      M_(M),
      K_(K),
      step_(M.rows()),
      x_(VectorJ::Zero(M.rows())),
      v_(x_) {
  if (!set(M, D, K)) {
    throw ConfigError("an admittance needs a positive definite M + T D + T^2 K");
  }
}

void AdmittanceFilter::reset() noexcept {
  x_.setZero();
  v_.setZero();
}

bool AdmittanceFilter::set(const MatrixJ& M, const MatrixJ& D, const MatrixJ& K) noexcept {
  const MatrixJ A = M + T_ * D + T_ * T_ * K;
  if (!A.allFinite()) return false;
  const Eigen::LLT<MatrixJ> step(A);
  if (step.info() != Eigen::Success) return false;
  M_ = M;
  K_ = K;
  step_ = step;
  return true;
}

void AdmittanceFilter::update(const VectorJ& F) noexcept {
  VectorJ impulse = M_ * v_ - T_ * (K_ * x_);
  if (F.allFinite()) impulse += T_ * F;
  v_ = step_.solve(impulse);
  x_ += T_ * v_;
}

CompliantPose compose(const Pose& X_BD, const Vector6& V_BD, const Vector6& x,
                      const Vector6& v) noexcept {
  const Eigen::Vector3d phi = x.tail<3>();
  const Eigen::Quaterniond turn = exp_rotation(phi);
  CompliantPose pose;
  pose.X_BC = {X_BD.p + x.head<3>(), (turn * X_BD.Q).normalized()};
  pose.V_BC << V_BD.head<3>() + v.head<3>(),
      left_jacobian(phi) * v.tail<3>() + turn * Eigen::Vector3d(V_BD.tail<3>());
  return pose;
}

}  // namespace limber::controller
