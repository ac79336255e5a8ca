// How much torque the friction of a joint may hold.
#pragma once

#include <algorithm>

#include "robots/loader/robot.h"

namespace limber::controller {

/// Of robot.yaml, whose figures are often guessed, or this share of the joint's torque limit.
inline constexpr double kFrictionShare = 0.05;

/// N m (N); for set-up.
inline double friction_bound(const JointConfig& joint) {
  const double known =
      std::max(joint.friction.coulomb_Nm, joint.friction.static_Nm) * joint.motors() +
      std::max(joint.link_friction.coulomb_Nm, joint.link_friction.static_Nm);
  return std::max(known, kFrictionShare * joint.torque_limit_Nm);
}

}  // namespace limber::controller
