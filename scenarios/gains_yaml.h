// `gains:` of a scenario's timeline.
#pragma once

#include <limber/compliance_gains_t.hpp>

#include "common/yaml_reader.h"
#include "robots/robot.h"

namespace limber {

/// The gains a robot starts with, as a message: K_x = diag(translation, rotation), law empty (keep
/// the present one), no ramp. Set-up only.
compliance_gains_t default_gains(const Robot& robot);

/// Changes what the entry names and keeps the rest; the law's name and the ramp are of this entry
/// alone. `K_x_translation_N_per_m` and `K_x_rotation_Nm_per_rad` (one number or three) set their
/// diagonal block and clear the coupling between translation and rotation; `K_x` sets all of it.
/// K_x must be symmetric and positive semidefinite. Set-up only.
void read_gains_entry(const YamlMap& yaml, const Robot& robot, compliance_gains_t* gains);

}  // namespace limber
