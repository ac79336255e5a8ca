// A joint as one of its motors sees it.
#pragma once

#include "robots/loader/robot.h"

namespace limber {

/// The joint as the configuration of one drive: the joint itself if it has one motor. Of two, each
/// may do what its drive can, as they also hold their preload against each other; the second one
/// (1) has neither link encoder nor torque sensor, and counts positively where it winds up its
/// spring. Set-up only.
JointConfig motor_view(const JointConfig& joint, int motor);

/// Most that one of two motors may make, N m.
double pulling_limit(const DriveConfig& drive) noexcept;

/// Furthest from zero that a motor of an antagonistic joint gets: the link's end, and wound up. rad
double winding_limit(const JointConfig& joint) noexcept;

}  // namespace limber
