// The `joints:` section of robot.yaml.
#pragma once

#include <map>
#include <string>

#include "common/yaml_reader.h"
#include "robots/loader/robot.h"

namespace limber {

/// Whether the limits of a joint count as robot.yaml has them, without the URDF's.
bool ignores_urdf_limits(const YamlMap& joint);

/// Fills drives, friction, tighter limits and homes of robot->joints, whose names and limits come
/// from the URDF and whose buses are known. Every joint must be there, no other.
/// Throws ConfigError with every joint's complaint. Set-up only.
void read_joints(const YamlMap& yaml, const std::map<std::string, DriveConfig>& motors,
                 Robot* robot);

/// Motor, address, mounting, friction and hold of the hand, whose name and way `drive` has.
/// Likewise.
void read_hand_drive(const YamlMap& yaml, const std::map<std::string, DriveConfig>& motors,
                     Robot* robot, JointConfig* drive);

}  // namespace limber
