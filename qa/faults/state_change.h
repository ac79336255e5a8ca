// Another angle or speed in a drive's state reply.
#pragma once

#include "drivers/can/can_frame.h"
#include "robots/loader/robot.h"

namespace limber::faults {

/// Of the drive, rad and rad/s, before joint sign and offset.
struct MotionChange {
  double angle_rad = 0.0;
  double speed_rad_per_s = 0.0;
};

/// The reply with `change` added; replies, or parts of one, that hold neither come back unchanged.
/// `fd`: of the bus. Identifier and time stamp stay.
CanFrame with_motion(const CanFrame& reply, const JointConfig& joint, bool fd,
                     const MotionChange& change);

}  // namespace limber::faults
