// Whether the controller would take what a scenario requests.
#pragma once

#include <string>
#include <vector>

#include "robots/loader/load_robot.h"
#include "scenarios/loader/scenario.h"

namespace limber {

/// One line for each mode, goal or gains entry that the controller refuses, with code and reason,
/// and for each goal that it takes in simulation only, since no arm can reach it. The timeline is
/// played to the controller itself, at an arm that follows every request of its drives and stands
/// still at its start pose; what comes after an injected fault is not judged. Throws ConfigError if
/// the robot's own gains do not fit its arm.
std::vector<std::string> doubtful_requests(const Scenario& scenario, const LoadedRobot& robot);

}  // namespace limber
