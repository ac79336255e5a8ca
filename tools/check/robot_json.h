// A robot as limber-check resolves it: robot.yaml and its URDF for programs in other languages.
// SI; units in names hold for rotary joints, for prismatic ones read m and N; null: no limit.
#pragma once

#include <string>

#include "robots/loader/load_robot.h"
#include "tools/check/json.h"

namespace limber {

/// Name, files, ends of the chain, figures of the whole arm, notes.
json::Members robot_members(const LoadedRobot& loaded);
json::Members joint_members(const Robot& robot, const JointConfig& joint);
json::Members bus_members(const BusConfig& bus);
const char* type_name(JointType type);

/// All of it, with the gains a law starts with and the URDF's tree: one object, format
/// limber-resolved-robot/1.
std::string robot_json(const LoadedRobot& loaded);

}  // namespace limber
