// Whether the controller would take the gains a scenario asks for.
#pragma once

#include <string>
#include <vector>

#include "robots/loader/load_robot.h"
#include "scenarios/loader/scenario.h"

namespace limber {

/// One line for each gains entry that the controller refuses, with its reason, entry after entry as
/// in a run. What depends on the pose (K_x against the joints' springs) is judged in the run alone.
/// Throws ConfigError if the robot's own gains do not fit its arm.
std::vector<std::string> refused_gains(const Scenario& scenario, const LoadedRobot& robot);

}  // namespace limber
