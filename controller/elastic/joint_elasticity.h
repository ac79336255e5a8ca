// The springs of the joints as a design of damping needs them.
#pragma once

#include "common/types.h"
#include "controller/elastic/joint_springs.h"
#include "controller/gains/law_settings.h"

namespace limber::controller {

struct JointElasticity {
  /// Springs at rest, for a law that receives the motors' position.
  JointElasticity(const Robot& robot, const JointSprings& springs);

  VectorJ K_J;  ///< n, N m/rad; rigid joints: JointSprings::kRigid_Nm_per_rad
  VectorJ D_J;  ///< of the dampers beside the springs, n, N m s/rad
  PositionFeedback position = PositionFeedback::kMotor;  ///< that the law receives; never kAuto
  double period_s;                                       ///< of the controller
  /// False for rigid arms, and for pairs of motors, whose springs change with the preload.
  bool designed_for;
};

}  // namespace limber::controller
