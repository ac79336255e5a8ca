// The springs of the joints as a design of damping needs them.
#pragma once

#include "common/types.h"
#include "controller/elastic/joint_springs.h"
#include "controller/kinds/law_settings.h"

#pragma GCC visibility push(default)
namespace limber::controller {

struct JointElasticity {
  /// Springs at rest, for a law that receives the motors' position. Two motors a joint are one
  /// rotor of both, which their equilibrium has, and one spring: that of the preload and of the
  /// deflection there are. Every law but the one that has no damping to design keeps the preload at
  /// rest.
  JointElasticity(const Robot& robot, const JointSprings& springs);

  VectorJ K_J;  ///< n, N m/rad; rigid joints: JointSprings::kRigid_Nm_per_rad
  VectorJ D_J;  ///< of the dampers beside the springs, n, N m s/rad
  PositionFeedback position = PositionFeedback::kMotor;  ///< that the law receives; never kAuto
  double period_s;                                       ///< of the controller
};

}  // namespace limber::controller
#pragma GCC visibility pop
