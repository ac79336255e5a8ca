// A scenario as limber-check resolves it, for programs in other languages.
#pragma once

#include <string>

#include "scenarios/loader/scenario.h"
#include "tools/check/json.h"

namespace limber {

/// What is in the file, with the robot (robot_json()), the gains as they hold from each time on,
/// and the timeline in order of time. Format limber-resolved-scenario/1.
json::Members scenario_members(const Scenario& scenario, const LoadedRobot& robot);

}  // namespace limber
