// Kinematics and dynamics of the arm at one state: everything the laws need, computed once a cycle.
// The equations are in dynamics/arm_kernel.h.
#pragma once

#include "common/types.h"
#include "controller/kinds/pose.h"
#include "controller/model/singularity.h"
#include "dynamics/arm_kernel.h"

namespace KDL {
class Chain;
}
#pragma GCC visibility push(default)
namespace limber {
struct LoadedRobot;  // robots/loader/load_robot.h
}

namespace limber::controller {

/// The rigid arm with rotors: (M + diag(B)) a + C v + g = tau + J^T F_ext. Base frame B, tip frame
/// T. Twists and wrenches: base axes, reference point at the tip origin, linear part first.
struct ArmTerms {
  explicit ArmTerms(int joints);

  Pose X_BT;
  Vector6 V_BT;    ///< J v
  Matrix6J J;      ///< 6 x n
  Vector6 Jdot_v;  ///< (dJ/dt) v: tip acceleration at zero joint acceleration
  MatrixJ M;       ///< link inertia, n x n, kg m^2
  VectorJ B;       ///< rotor inertia behind the gear and the drive's torque loop; of two motors the
                   ///< sum, which their equilibrium has; kg m^2 (constant)
  MatrixJ M_total;   ///< M + diag(B): what a rigidly geared joint has to accelerate
  MatrixJ6 Minv_JT;  ///< M_total^-1 J^T, n x 6: joint acceleration by a wrench at the tip
  TipInertia tip;    ///< by M_total: the tip's inertia, and its inverse J Minv_JT
  VectorJ Cv;        ///< Coriolis and centrifugal torque, N m
  VectorJ CTv;       ///< C^T v = (dM/dt) v - C v: what momentum has and acceleration has not, N m
  VectorJ g;         ///< torque that holds the arm still against gravity, N m
  VectorJ g_slope;   ///< dg_i/dq_i: turned by x about its axis alone, g_i cos x + g_slope_i sin x

  /// v^T M_total v / 2, J.
  double kinetic_energy(const VectorJ& v) const noexcept { return 0.5 * v.dot(M_total * v); }
};

/// What is to be evaluated anew in a cycle.
struct TermsDue {
  bool jacobian = true;  ///< J, Jdot_v
  bool inertia = true;   ///< M, M_total, Minv_JT, tip.G
  bool coriolis = true;  ///< Cv, CTv
  /// tip.Lambda wherever tip.G is; else what needs it makes it.
  bool tip_inertia = true;
};

/// Computes the terms, for 1 to kMaxJoints joints, revolute and prismatic. All members but the
/// constructor may be called in the cycle.
class ArmModel {
 public:
  /// Gravity is the acceleration in axes of the chain's base, m/s^2. Throws ConfigError as
  /// body_chain() does; the chain has as many joints as `rotor_inertia`.
  ArmModel(const KDL::Chain& chain, const double gravity[3],
           const std::vector<double>& rotor_inertia);
  explicit ArmModel(const LoadedRobot& robot);

  int size() const noexcept { return size_; }
  const VectorJ& rotor_inertia() const noexcept { return rotor_inertia_; }

  /// All terms at (q, v), both of length size().
  void evaluate(const VectorJ& q, const VectorJ& v, ArmTerms* terms) noexcept;
  /// Only what is due; the rest stays as it was evaluated last. The tip's pose, V_BT = J v and
  /// gravity are always of this instant.
  void evaluate(const VectorJ& q, const VectorJ& v, const TermsDue& due, ArmTerms* terms) noexcept;

  // Single terms, for laws that look at other states than the present one.
  Pose tip_pose(const VectorJ& q) noexcept;
  Matrix6J jacobian(const VectorJ& q) noexcept;
  struct Tip {
    Pose X_BT;
    Matrix6J J;
  };
  Tip tip(const VectorJ& q) noexcept;
  /// (dJ/dt) v.
  Vector6 jacobian_rate(const VectorJ& q, const VectorJ& v) noexcept;
  MatrixJ mass(const VectorJ& q) noexcept;
  /// C(q, v) v.
  VectorJ coriolis(const VectorJ& q, const VectorJ& v) noexcept;
  /// (M + diag(B)) a + C v + g by recursive Newton-Euler (Luh, Walker, Paul 1980).
  VectorJ inverse_dynamics(const VectorJ& q, const VectorJ& v, const VectorJ& a) noexcept;
  /// Torque that holds the arm still, g.
  VectorJ gravity(const VectorJ& q) noexcept;
  /// dg/dq, symmetric, n x n, N m/rad. Its greatest norm over the workspace is what a motor-side
  /// position law has to exceed.
  MatrixJ gravity_gradient(const VectorJ& q) noexcept;
  /// What torques at rest depend on, X_BT, J and g; the other terms stay as they are.
  void evaluate_statics(const VectorJ& q, ArmTerms* terms) noexcept;

 private:
  Pose placed_tip() const noexcept;

  VectorJ rotor_inertia_;
  VectorJ zero_;
  int size_;
  dynamics::AnyArmKernel kernel_;
};

}  // namespace limber::controller
#pragma GCC visibility pop
