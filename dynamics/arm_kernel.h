// The dynamics of a serial arm, one algorithm for all terms. Every line below is one line of
// row_kernel.h, which runs over all joints at once; the poses X_i = X_(i-1) X_fixed,i
// X_joint,i(q_i) alone are multiplied joint by joint.
//
// All vectors are in base axes. Twists, momenta and wrenches are taken at the base origin, linear
// part first; z_i is the axis of joint i and p_i a point on it. Body i has mass m, centre of mass
// c, first moment h = m c and, about the base origin, the inertia I_O.
//   S_i = (p_i x z_i, z_i), prismatic (z_i, 0)       twist of joint i at unit rate
//   I V     = (m v + w x h, I_O w + h x v)           momentum of a body with the twist V = (v, w)
//   V x S   = (w x s_v + v x s_w, w x s_w)           rate of a twist S = (s_v, s_w) fixed to it
//   V x* H  = (w x l, w x k + v x l)                 rate of a momentum H = (l, k) fixed to it
// Summed from the base:
//   V_i = sum S_k v_k,  A_i = sum ((V_k x S_k) v_k + S_k a_k)        twist and its rate, k <= i
// Summed from the tip, over the bodies k >= i that joint i carries:
//   P_i = (sum I_k) S_i                              M_ij = S_i . P_j  (i <= j)
//   F_i = sum (I_k A_k + V_k x* I_k V_k)             (M a + C v)_i = S_i . F_i
//   L_i = sum I_k V_k                                (C^T v)_i = (V_i x S_i) . L_i
//   l_i = linear part of P_i                         g_i = -gravity . l_i
//                                                    dg_i/dq_j = (w_j x gravity) . l_i  (j <= i)
// Source of M and M a + C v: R. Featherstone, Rigid Body Dynamics Algorithms (2008), chapters 5 and
// 6. C^T v: the momentum p = M v of the joints changes by dp_i/dt = S_i . F_i + (V_i x S_i) . L_i
// at a = 0, and dM/dt = C + C^T. dg/dq: with joint j all of l_i turns about its axis; w_j is the
// angular part of S_j.
#pragma once

#include <memory>
#include <utility>

#include "common/types.h"
#include "dynamics/body_chain.h"

#pragma GCC visibility push(default)
namespace limber::dynamics {

/// place() comes first; each of the others says what it needs besides. Results have as many entries
/// as the arm has joints. All may be called in the cycle.
class ArmKernel {
 public:
  virtual ~ArmKernel() = default;
  /// Allocates: set-up only.
  virtual std::unique_ptr<ArmKernel> copy() const = 0;
  /// Another mass of a body, from the next place() on.
  virtual void set_mass(int body, const MassProperties& mass) noexcept = 0;

  /// Poses of all bodies, S, c and h.
  virtual void place(const VectorJ& q) noexcept = 0;
  virtual Eigen::Matrix3d rotation(int body) const noexcept = 0;
  virtual Eigen::Vector3d position(int body) const noexcept = 0;
  virtual Eigen::Vector3d centre_of_mass(int body) const noexcept = 0;
  virtual Eigen::Vector3d axis(int body) const noexcept = 0;
  const Eigen::Matrix3d& tip_rotation() const noexcept { return R_tip_; }
  const Eigen::Vector3d& tip_position() const noexcept { return p_tip_; }
  /// Of the tip.
  virtual void jacobian(Matrix6J* J) const noexcept = 0;
  /// tau_i += S_i . F for the joints that carry the body; F is a wrench at the base origin.
  virtual void add_wrench(int body, const Vector6& F, VectorJ* tau) const noexcept = 0;
  /// Of gravity, zero with every mass at the height of the base origin, J.
  virtual double potential_energy() const noexcept = 0;
  /// And the diagonal of gravity_gradient() unless that is null.
  virtual void gravity(VectorJ* g, VectorJ* slope) const noexcept = 0;
  virtual void gravity_gradient(MatrixJ* slope) const noexcept = 0;

  /// I_O of each body.
  virtual void weigh() noexcept = 0;
  /// After weigh().
  virtual void mass(MatrixJ* M) const noexcept = 0;

  /// V and A.
  virtual void move(const VectorJ& v, const VectorJ& a) noexcept = 0;
  /// After move(): V of a body.
  virtual Vector6 twist(int body) const noexcept = 0;
  /// After move(): of the tip, taken at its origin.
  virtual Vector6 tip_twist() const noexcept = 0;
  /// After move(): acceleration of the tip, which moves with the twist V_BT.
  virtual Vector6 tip_acceleration(const Vector6& V_BT) const noexcept = 0;
  /// After weigh() and move(): M a + C v, and C^T v unless that is null.
  virtual void torque(VectorJ* tau, VectorJ* CTv) const noexcept = 0;

 protected:
  Eigen::Matrix3d R_tip_;
  Eigen::Vector3d p_tip_;
};

/// Copied with its holder, in set-up only.
class AnyArmKernel {
 public:
  explicit AnyArmKernel(std::unique_ptr<ArmKernel> kernel) : kernel_(std::move(kernel)) {}
  AnyArmKernel(const AnyArmKernel& other) : kernel_(other.kernel_->copy()) {}
  AnyArmKernel& operator=(AnyArmKernel other) noexcept {
    kernel_ = std::move(other.kernel_);
    return *this;
  }
  ArmKernel* operator->() noexcept { return kernel_.get(); }
  const ArmKernel* operator->() const noexcept { return kernel_.get(); }

 private:
  std::unique_ptr<ArmKernel> kernel_;
};

/// With the least room for the chain, for this processor. Gravity: acceleration in base axes,
/// m/s^2. Set-up only.
AnyArmKernel arm_kernel(const BodyChain& chain, const Eigen::Vector3d& gravity);

}  // namespace limber::dynamics
#pragma GCC visibility pop
