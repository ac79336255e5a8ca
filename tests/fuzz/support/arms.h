// The arms that the targets are tried on: read once a process.
#pragma once

#include <string>

#include "robots/loader/load_robot.h"
#include "tests/support/source_path.h"

namespace limber::fuzz {

/// A robot of tests/robots/data, or a shipped one. The first call loads it.
inline LoadedRobot load(const std::string& name) {
  const bool shipped = name.find('/') == std::string::npos;
  return load_robot(source_path(shipped ? "robots/" + name : name));
}

inline const JointConfig& joint_of(const Robot& robot, std::size_t joint) {
  return robot.joints.at(joint % robot.joints.size());
}

inline bool on_fd(const Robot& robot, const JointConfig& joint) {
  return robot.buses.at(static_cast<std::size_t>(joint.drive.bus)).fd;
}

}  // namespace limber::fuzz
