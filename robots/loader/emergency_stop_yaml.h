// Section `emergency_stop` of robot.yaml.
#pragma once

#include "common/yaml_reader.h"
#include "robots/loader/robot.h"

namespace limber {

/// Fills robot->emergency_stop. Buses and joints are known. Throws ConfigError. Set-up only.
void read_emergency_stop(const YamlMap& yaml, Robot* robot);

}  // namespace limber
