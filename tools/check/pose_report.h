// What limber-check notes of the poses that a scenario starts from and goes to.
#pragma once

#include <string>
#include <vector>

#include "robots/loader/load_robot.h"
#include "scenarios/loader/scenario.h"

namespace limber {

/// Joints that start in their soft wall or at its edge, and which way continuous joints turn by
/// more than half a turn; empty if there is nothing to tell.
std::vector<std::string> pose_notes(const Scenario& scenario, const Robot& robot);

}  // namespace limber
