// The `tip_sensor:` section of robot.yaml.
#pragma once

#include "common/yaml_reader.h"
#include "robots/loader/robot.h"

namespace limber {

/// Fills robot->tip_sensor from the section `yaml`; buses and drives of the robot are known.
/// Identifiers must be free on their bus, and none that a drive there accepts; robotous_rft needs a
/// classic bus (its nodes would answer FD frames with error frames), limber_ft an FD one. Throws
/// ConfigError. Set-up only.
void read_tip_sensor(const YamlMap& yaml, Robot* robot);

}  // namespace limber
