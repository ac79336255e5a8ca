// Other CAN addresses than those of robot.yaml, as the command line gives them.
#pragma once

#include <map>
#include <string>

#include "robots/loader/robot.h"

namespace limber {

/// Replaces the address of each bus named in `addresses` (name -> address, see
/// common/can_address.h). Throws ConfigError if the robot has no bus of such a name. Set-up only.
void choose_buses(const std::map<std::string, std::string>& addresses, Robot* robot);

/// A robot.yaml that names a real interface is meant for a real arm: a simulator goes there only if
/// the user gave it that address. Throws ConfigError otherwise. Set-up only.
void require_simulated_buses(const std::map<std::string, std::string>& addresses,
                             const Robot& robot);

}  // namespace limber
