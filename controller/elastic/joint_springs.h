// The springs of an arm's joints, as robot.yaml has them.
#pragma once

#include <vector>

#include "common/types.h"
#include "robots/loader/robot.h"

namespace limber::controller {

class JointSprings {
 public:
  /// What a rigid joint counts as, N m/rad: bends by nothing that an encoder sees.
  static constexpr double kRigid_Nm_per_rad = 1e8;
  /// Springs that are all but slack are not divided by.
  static constexpr double kLeast_Nm_per_rad = 1.0;
  /// Share of its spring's stiffness up to which the link can be given one. The motor has to be
  /// K_d K_J / (K_J - K_d) stiff for it: ten times K_d at this share.
  static constexpr double kHighestShare = 0.9;

  explicit JointSprings(const Robot& robot);

  /// Some joint is not rigid.
  bool any() const noexcept { return any_; }

  /// Stiffness that gives the torque, tau = K (theta - q), n, N m/rad: for linear springs their
  /// stiffness, for quadratic pairs 2 k2 c, both local too; for others the secant at this
  /// deflection. d = theta - q and preload, n, rad. In the cycle.
  VectorJ stiffness(const VectorJ& d, const VectorJ& preload) const noexcept;
  /// The torque itself, of the springs on the links, n, N m; zero for rigid joints. In the cycle.
  VectorJ torque(const VectorJ& d, const VectorJ& preload) const noexcept;
  /// The stiffness of unloaded joints at the preload they rest at.
  const VectorJ& at_rest() const noexcept { return at_rest_; }

  /// nullptr if the link can be given K_q, n x n diagonal, else why not. In the cycle.
  const char* check(const MatrixJ& K_q, const VectorJ& K_J) const noexcept;
  /// K_q, or as much of it as the springs allow. In the cycle.
  MatrixJ within(const MatrixJ& K_q, const VectorJ& K_J) const noexcept;

  /// Share of a stiffness at the tip, 6 x 6, N/m and N m/rad, that the springs allow, at most 1:
  /// kHighestShare over the greatest eigenvalue of K_J^-1/2 J^T K_x J K_J^-1/2. In the cycle.
  static double allowed_share(const Matrix6& K_x, const Matrix6J& J, const VectorJ& K_J) noexcept;
  /// nullptr if the link can be given K_x, else why not. In the cycle.
  const char* check(const Matrix6& K_x, const Matrix6J& J, const VectorJ& K_J) const noexcept;

 private:
  struct OneJoint {
    TransmissionKind kind;
    SpringConfig spring;
    double preload_rad;
  };
  static double stiffness_of(const OneJoint& joint, double d, double preload) noexcept;

  std::vector<OneJoint> joints_;
  VectorJ at_rest_;
  bool any_ = false;
};

}  // namespace limber::controller
