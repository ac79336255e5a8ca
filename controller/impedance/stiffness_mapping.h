// A Cartesian stiffness and damping in joint coordinates (Salisbury 1980; Chen and Kao 2000;
// Albu-Schaeffer and Hirzinger 2002). With e the pose error, A its rate matrix, W = A^T K_x e the
// wrench that holds the deviation, and U = e^T K_x e / 2:
//   K_1 = J^T A^T K_x A J                           first term, rank of the task
//   K_G(W) = (dJ^T/dq) W, W fixed                   geometric term, vanishes with the load
//   K_q = d(J^T A^T K_x e)/dq = Hessian of U        full tangent, symmetric
// Position-only tasks have K_q = K_1 + K_G(W). Matrices are n x n, N m/rad. Everything here may be
// called in the cycle.
#pragma once

#include "common/types.h"
#include "controller/kinds/gains.h"
#include "controller/kinds/goal.h"
#include "controller/model/arm_terms.h"
#include "controller/model/pose_error.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// K_1.
MatrixJ first_term(const Matrix6J& J, const PoseError& error, const Matrix6& K_x) noexcept;

/// K_G for a wrench W on the tip of the arm, base axes; from J alone, since column i of J holds the
/// axis of joint i (zero for prismatic joints) and the velocity of the tip about it:
///   K_G[i][k] = (z_a x J_v,b) . f + [k < i] (z_k x z_i) . mu,  a = min(i, k), b = max(i, k).
MatrixJ geometric_term(const Matrix6J& J, const Vector6& W) noexcept;

/// The joint torque J^T A^T K_x e that holds the deviation, N m.
VectorJ holding_torque(ArmModel* model, const VectorJ& q, const Pose& X_BD, const Matrix6& K_x,
                       Orientation orientation) noexcept;

/// K_q = K_G(W) + J^T (dW/dx) J, made symmetric for those orientation errors that have a potential:
/// by the tip's position W changes with A^T K_x; by its rotation, found by central differences.
MatrixJ full_tangent(ArmModel* model, const VectorJ& q, const Pose& X_BD, const Matrix6& K_x,
                     Orientation orientation) noexcept;

/// The terms asked for, at the pose q and with the load it has there.
MatrixJ joint_stiffness(StiffnessTerms terms, ArmModel* model, const VectorJ& q, const Pose& X_BD,
                        const Matrix6& K_x, Orientation orientation) noexcept;

/// Derivative of the damping torque J^T D_x J v with respect to q, v fixed, by its two parts,
/// N m/rad: (dJ^T/dq) (D_x J v) and J^T D_x d(J v)/dq. Its derivative with respect to v is
/// J^T D_x J exactly.
struct DampingTangent {
  MatrixJ transpose_part;
  MatrixJ velocity_part;
};
DampingTangent damping_tangent(ArmModel* model, const VectorJ& q, const VectorJ& v,
                               const Matrix6& D_x) noexcept;

/// Pose at which the joint stiffness of a finite joint error q_d - q is evaluated.
enum class MappingPose { kCurrent, kGoal, kMid, kMean };

/// Where the partial derivative of the damping torque with respect to the joint angles goes.
enum class DampingPartials {
  kNone,         ///< left out, as usual
  kInStiffness,  ///< part of the stiffness, where its unit belongs
  kPrinted,      ///< added to the damping, as printed (lecture equation 6); may feed energy in
};

struct MappingChoice {
  MappingPose pose = MappingPose::kMid;
  DampingPartials damping_partials = DampingPartials::kNone;
};

/// Joint gains of a Cartesian impedance for the joint error q_d - q, with the terms that the
/// settings name and at the pose chosen: K_p at q, q_d, the middle between, or the mean of both
/// ends; the load W = A^T K_x e is that of the pose it is evaluated at. K_v = J^T D_x J at q.
struct MappedGains {
  MatrixJ K_p;
  MatrixJ K_v;
};
MappedGains mapped_gains(ArmModel* model, const VectorJ& q, const VectorJ& v, const Goal& goal,
                         const Gains& gains, const Matrix6& D_x,
                         const MappingChoice& choice) noexcept;

}  // namespace limber::controller
#pragma GCC visibility pop
