// Poses to check an arm in: the same on every machine.
#pragma once

#include <vector>

#include "robots/loader/robot.h"

namespace limber {

/// A pose within the limits (within half a turn where there are none) from a sequence that fills
/// the joint space evenly. `index` 0, 1, 2, ... Set-up only.
std::vector<double> sample_pose(const Robot& robot, unsigned index);

}  // namespace limber
