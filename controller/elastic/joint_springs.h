// The springs of an arm's joints, as robot.yaml has them.
#pragma once

#include <vector>

#include "common/types.h"
#include "robots/loader/robot.h"

#pragma GCC visibility push(default)
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

  /// K, n x n at the joints, N m/rad (K_q, or J^T K_x J), over the most that the links can be given
  /// through springs K_J: kHighestShare K_J, less what the weight takes in the directions in which
  /// it would buckle them. dg_dq: gradient of the weight that the law carries, n x n; zero if it
  /// carries none. `most`: the joint whose spring is asked most of. In the cycle.
  static double taken(const MatrixJ& K, const VectorJ& K_J, const MatrixJ& dg_dq,
                      Eigen::Index* most = nullptr) noexcept;
  /// Share of K that the springs allow, at most 1. In the cycle.
  static double allowed_share(const MatrixJ& K, const VectorJ& K_J, const MatrixJ& dg_dq) noexcept;
  /// K_q, n x n diagonal, or as much of it as the springs allow. In the cycle.
  static MatrixJ within(const MatrixJ& K_q, const VectorJ& K_J, const MatrixJ& dg_dq) noexcept;

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
#pragma GCC visibility pop
