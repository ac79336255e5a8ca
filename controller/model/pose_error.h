// How far the tip is from where it shall be, and how that changes with the tip's twist.
#pragma once

#include "common/types.h"
#include "controller/kinds/law_settings.h"
#include "controller/kinds/pose.h"

#pragma GCC visibility push(default)
namespace limber::controller {

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
#pragma GCC visibility pop
