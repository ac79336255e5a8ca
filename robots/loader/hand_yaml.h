// The `hand:` section of robot.yaml.
#pragma once

#include <map>
#include <string>

#include "common/yaml_reader.h"
#include "robots/loader/robot.h"

namespace limber {

/// Sets robot->hand, checked against its motor and against what else is on its bus. Joints and
/// buses are known. Throws ConfigError with every complaint. Set-up only.
void read_hand(const YamlMap& yaml, const std::map<std::string, DriveConfig>& motors, Robot* robot);

}  // namespace limber
