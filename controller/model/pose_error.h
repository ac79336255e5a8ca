// How far the tip is from where it shall be, and how that changes with the tip's twist.
#pragma once

#include "common/types.h"
#include "controller/model/pose.h"

namespace limber::controller {

/// How the rotation error e_o is measured (numbers of compliance_gains_t).
enum class Orientation : std::int8_t {
  /// e_o = Log(R R_d^T): an isotropic spring k pulls with k phi up to half a turn, where it jumps.
  kLog = 0,
  /// e_o = 2 epsilon of Q Q_d^-1 with eta >= 0: pulls with k sin phi, weakest beyond 90 degrees,
  /// without a jump of the torque at half a turn.
  kQuat = 1,
  /// The same errors with A = I, as often published: conservative for equal stiffness only.
  kLogSimple = 2,
  kQuatSimple = 3,
  /// Differences of roll, pitch and yaw (R = Rz(y) Ry(p) Rx(r)), each within +-pi: singular at a
  /// pitch of 90 degrees, where its rate is bounded.
  kRollPitchYaw = 4,
};

/// e = [p - p_d; e_o], actual minus desired, base axes, m and rad, and A with e' = A V for a target
/// at rest: A = blkdiag(I, A_o), A_o = J_l(e_o)^-1 for kLog, eta I - [epsilon]x for kQuat, the
/// inverse of the roll-pitch-yaw rate matrix for kRollPitchYaw.
/// The wrench of a spring is -A^T K e, the exact gradient of e^T K e / 2.
struct PoseError {
  Vector6 e;
  Matrix6 A;
};

/// X_BT where the tip is, X_BD where it shall be. May be called in the cycle.
PoseError pose_error(const Pose& X_BT, const Pose& X_BD, Orientation orientation) noexcept;

}  // namespace limber::controller
