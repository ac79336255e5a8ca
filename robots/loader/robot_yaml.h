// What robot.yaml adds to a URDF: buses, motors, drives, tighter limits, home, gains.
#pragma once

#include <set>
#include <string>

#include "common/yaml_reader.h"
#include "robots/loader/robot.h"

namespace limber {

/// What must be known before the URDF can be read.
struct RobotHeader {
  std::string name;
  std::string urdf;  ///< relative to the folder of robot.yaml
  std::string base;
  std::string tip;
  double gravity_R[3] = {0.0, 0.0, -9.81};    ///< m/s^2, axes of the URDF's root link
  std::set<std::string> ignored_urdf_limits;  ///< joints with urdf_limits: ignore
};

RobotHeader read_robot_header(const YamlMap& yaml);

/// Fills rate, buses, drives, friction, homes and gains of a robot whose joints and limits come
/// from the URDF. The tightest of URDF, motor and robot.yaml is the limit; a robot.yaml that asks
/// for more than the other two allow is refused. Throws ConfigError. Set-up only.
void read_robot_yaml(const YamlMap& yaml, Robot* robot);

}  // namespace limber
