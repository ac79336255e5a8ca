// The dynamics of a serial arm, one algorithm for all terms. Every line below is one line of
// arm_kernel.cc, which runs over all joints at once; what is summed along the arm, and the poses
// X_i = X_(i-1) X_fixed,i X_joint,i(q_i), go over 1, 2, 4, ... neighbours.
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

#include <variant>

#include "common/types.h"
#include "dynamics/body_chain.h"
#include "dynamics/joint_rows.h"

#pragma GCC visibility push(default)
namespace limber::dynamics {

/// For arms of at most N joints. place() comes first; each of the others says what it needs
/// besides. Results have as many entries as the arm has joints. After construction all may be
/// called in the cycle.
template <int N>
class ArmKernel {
 public:
  /// Gravity: acceleration in base axes, m/s^2.
  ArmKernel(const BodyChain& chain, const Eigen::Vector3d& gravity);
  /// Another mass of a body, from the next place() on.
  void set_mass(int body, const MassProperties& mass) noexcept;

  /// Poses of all bodies, S, c and h.
  void place(const VectorJ& q) noexcept;
  Eigen::Matrix3d rotation(int body) const noexcept;
  Eigen::Vector3d position(int body) const noexcept { return X_.p.at(body); }
  Eigen::Vector3d centre_of_mass(int body) const noexcept { return c_.at(body); }
  Eigen::Vector3d axis(int body) const noexcept { return X_.R_z.at(body); }
  const Eigen::Matrix3d& tip_rotation() const noexcept { return R_tip_; }
  const Eigen::Vector3d& tip_position() const noexcept { return p_tip_; }
  /// Of the tip.
  void jacobian(Matrix6J* J) const noexcept;
  /// tau_i += S_i . F for the joints that carry the body; F is a wrench at the base origin.
  void add_wrench(int body, const Vector6& F, VectorJ* tau) const noexcept;
  /// Of gravity, zero with every mass at the height of the base origin, J.
  double potential_energy() const noexcept;
  void gravity(VectorJ* g) const noexcept;
  void gravity_gradient(MatrixJ* slope) const noexcept;
  /// Its diagonal.
  void gravity_slope(VectorJ* slope) const noexcept;

  /// I_O of each body.
  void weigh() noexcept;
  /// After weigh().
  void mass(MatrixJ* M) const noexcept;

  /// V and A.
  void move(const VectorJ& v, const VectorJ& a) noexcept;
  /// After move(): V of a body.
  Vector6 twist(int body) const noexcept;
  /// After move(): of the tip, taken at its origin.
  Vector6 tip_twist() const noexcept;
  /// After move(): acceleration of the tip, which moves with the twist V_BT.
  Vector6 tip_acceleration(const Vector6& V_BT) const noexcept;
  /// After weigh() and move(): M a + C v, and C^T v unless that is null.
  void torque(VectorJ* tau, VectorJ* CTv) const noexcept;

 private:
  // What the members of these names do, over rows; compiled for each kind of processor.
  void place_rows(const VectorJ& q) noexcept;
  void spread_rows() noexcept;
  void weigh_rows() noexcept;
  void move_rows(const VectorJ& v, const VectorJ& a) noexcept;
  void gravity_rows(VectorJ* g) const noexcept;
  void mass_rows(MatrixJ* M) const noexcept;
  void torque_rows(VectorJ* tau, VectorJ* CTv) const noexcept;
  void place_tip() noexcept;
  Row3<N> linear_momentum() const noexcept;

  // Of the chain.
  BodyChain chain_;
  int size_;
  Eigen::Vector3d gravity_;
  Row<N> m_, carried_m_;   // of the body; of all bodies that its joint carries
  Row<N> turns_, slides_;  // 1 for a joint of the kind, else 0
  RowPose<N> fixed_;       // in the body before, at joint position zero
  Row3<N> com_;            // in body axes
  RowSymmetric<N> I_C_;    // about the centre of mass, body axes
  // Of the present state.
  RowPose<N> X_;
  Row6<N> S_;
  Row3<N> c_, h_, carried_h_;
  RowSymmetric<N> I_O_;
  Row6<N> V_, V_x_S_, A_;
  Eigen::Matrix3d R_tip_;
  Eigen::Vector3d p_tip_;
};

/// The smaller one that has room for the chain.
using AnyArmKernel = std::variant<ArmKernel<8>, ArmKernel<16>>;
AnyArmKernel arm_kernel(const BodyChain& chain, const Eigen::Vector3d& gravity);

}  // namespace limber::dynamics
#pragma GCC visibility pop
