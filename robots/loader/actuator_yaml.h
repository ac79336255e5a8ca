// Reads what makes torque of a drive's command.
#pragma once

#include "common/yaml_reader.h"
#include "robots/loader/joint_chain.h"

namespace limber {

/// `actuator` of a motor, given at the joint. Throws ConfigError. Set-up only.
ActuatorConfig read_actuator(const YamlMap& yaml);

}  // namespace limber
