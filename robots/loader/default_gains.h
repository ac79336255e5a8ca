// The gains a robot starts with.
#pragma once

#include <limber/compliance_gains_t.hpp>

#include "robots/loader/robot.h"

namespace limber {

/// The table's defaults and robot.yaml's: K_x = diag(translation, rotation), law empty (keep the
/// present one), no ramp. Throws ConfigError unless robot.yaml gives one value a joint. Set-up
/// only.
compliance_gains_t default_gains(const Robot& robot);

}  // namespace limber
