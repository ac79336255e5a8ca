// The words of the inputs that choose something.
#pragma once

#include "controller/kinds/law_settings.h"
#include "lecture/eval/inputs.h"

namespace limber::eval {

/// How the rotation error is measured; `log` if nothing is said.
inline controller::Orientation orientation(Inputs& in) {
  using controller::Orientation;
  return in.choice<Orientation>("mode",
                                {{"log", Orientation::kLog},
                                 {"quat", Orientation::kQuat},
                                 {"log_simple", Orientation::kLogSimple},
                                 {"quat_simple", Orientation::kQuatSimple},
                                 {"rpy", Orientation::kRollPitchYaw}},
                                Orientation::kLog);
}

/// The model torque; what the law adds by itself if nothing is said.
inline controller::ModelCompensation model_compensation(Inputs& in) {
  using controller::ModelCompensation;
  return in.choice<ModelCompensation>("bias",
                                      {{"none", ModelCompensation::kNone},
                                       {"gravity", ModelCompensation::kGravity},
                                       {"gravity+coriolis", ModelCompensation::kGravityCoriolis}},
                                      ModelCompensation::kLawDefault);
}

}  // namespace limber::eval
