// A joint as one of its motors sees it.
#pragma once

#include "robots/robot.h"

namespace limber {

/// What a drive is told of its joint: the joint itself for the first motor (0); for the second one
/// (1) of an antagonistic joint the same with that motor's drive, which has neither link encoder
/// nor torque sensor. Its angle counts positively where it winds up its spring. Set-up only.
JointConfig motor_view(const JointConfig& joint, int motor);

/// Furthest from zero that a motor of an antagonistic joint gets: the link's end, and wound up. rad
double winding_limit(const JointConfig& joint) noexcept;

}  // namespace limber
