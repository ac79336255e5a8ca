// What the simulator refuses to start with.
#pragma once

#include <cstddef>
#include <vector>

#include "common/types.h"
#include "robots/loader/robot.h"

namespace limber::sim {

// All throw ConfigError. Set-up only.

/// No drives, a drive or sensor on a bus that does not exist, too many joints or buses, a step or
/// rate out of range.
void check_setup(const Robot& robot, std::size_t buses, double step_s);

/// A plant with other joints, motors or tip sensor than the robot.
void check_plant(const Robot& robot, const Robot& plant);

/// Joint positions to start at: `start_q`, or home if that is empty. Refuses what is outside the
/// joint limits.
VectorJ start_position(const Robot& robot, const std::vector<double>& start_q);

}  // namespace limber::sim
