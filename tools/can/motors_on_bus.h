// The motors of an arm one by one, as their drives know them.
#pragma once

#include <string>
#include <vector>

#include "robots/loader/robot.h"
#include "robots/loader/second_motor.h"

namespace limber::bus_tools {

struct Motor {
  std::string name;       ///< of its joint, with /2 for a second motor
  JointConfig joint;      ///< `drive` is this motor's
  std::string node = {};  ///< its name in a DBC file, each once on a bus; see dbc_messages()
};

struct BusFacts {
  bool fd = false;
  double period_s = 0.0;  ///< of the commands
};
inline BusFacts facts_of(const Robot& robot, int bus) {
  return {robot.buses[static_cast<std::size_t>(bus)].fd, 1.0 / robot.rate_hz};
}

inline std::vector<Motor> motors_on_bus(const Robot& robot, int bus) {
  std::vector<Motor> motors;
  for (const JointConfig& joint : robot.driven()) {
    if (joint.drive.bus == bus) motors.push_back({joint.name, joint});
    if (joint.has_antagonist && joint.antagonist.bus == bus)
      motors.push_back({joint.name + "/2", second_motor(joint)});
  }
  return motors;
}

}  // namespace limber::bus_tools
