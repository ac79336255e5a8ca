// The virtual mass, spring and damper of an admittance controller: a force in, a motion out.
#pragma once

#include <Eigen/Cholesky>

#include "common/types.h"
#include "controller/kinds/pose.h"

namespace limber::controller {

/// M v' + D v + K x = F (Hogan 1985), x the deviation of the commanded from the desired pose, by
/// the implicit step
///   v+ = (M + T D + T^2 K)^-1 (M v + T (F - K x)),   x+ = x + T v+,
/// which is stable for every T, and passive. m x m matrices, m <= kMaxJoints: six for a tip, with
/// x = [displacement; rotation vector], n for joints.
class AdmittanceFilter {
 public:
  /// M, D, K symmetric, T in s. Throws ConfigError unless M + T D + T^2 K is positive definite.
  AdmittanceFilter(const MatrixJ& M, const MatrixJ& D, const MatrixJ& K, double T);

  /// At rest without deviation. May be called in the cycle.
  void reset() noexcept;
  /// Takes other values from the next step on; false, and nothing changes, if the constructor would
  /// refuse them. May be called in the cycle.
  bool set(const MatrixJ& M, const MatrixJ& D, const MatrixJ& K) noexcept;
  /// F: external and feed-forward force, m, N and N m. A force that is not finite counts as none.
  /// May be called in the cycle.
  void update(const VectorJ& F) noexcept;

  const VectorJ& x() const noexcept { return x_; }
  const VectorJ& v() const noexcept { return v_; }

 private:
  double T_;
  MatrixJ M_;
  MatrixJ K_;
  Eigen::LLT<MatrixJ> step_;
  VectorJ x_;
  VectorJ v_;
};

/// What the inner position loop follows.
struct CompliantPose {
  Pose X_BC;
  Vector6 V_BC;
};

/// x_c = x_d (+) x:  p_BC = p_BD + x_p,  R_BC = Exp(x_o) R_BD,
/// V_BC = [v_d + x_p'; J_l(x_o) x_o' + Exp(x_o) w_d]. For a tip that follows exactly, the pose
/// error to D (kLog) is x. May be called in the cycle.
CompliantPose compose(const Pose& X_BD, const Vector6& V_BD, const Vector6& x,
                      const Vector6& v) noexcept;

}  // namespace limber::controller
