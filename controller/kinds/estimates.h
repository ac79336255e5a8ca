// What the observers know of the world.
#pragma once

#include "common/types.h"

namespace limber::controller {

/// Estimates of this instant; zero where LawSettings::contact names no source.
struct Estimates {
  explicit Estimates(int joints) : tau_ext(VectorJ::Zero(joints)) {}

  VectorJ tau_ext;                  ///< torque of the world on the joints, N m
  Vector6 F_ext = Vector6::Zero();  ///< wrench of the world on the tip, base axes, N and N m
  Vector6 A_BT = Vector6::Zero();   ///< dV_BT/dt, filtered, m/s^2 and rad/s^2
};

}  // namespace limber::controller
