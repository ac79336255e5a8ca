#include "drivers/drive/motor_view.h"

#include <algorithm>
#include <cmath>

#include "robots/loader/second_motor.h"

namespace limber {

JointConfig motor_view(const JointConfig& joint, int motor) {
  JointConfig view = motor == 0 ? joint : second_motor(joint);
  if (joint.has_antagonist) view.torque_limit_Nm = pulling_limit(view.drive);
  if (motor != 0) view.name += " (antagonist)";
  return view;
}

double pulling_limit(const DriveConfig& drive) noexcept {
  return std::min(drive.peak_torque_Nm, drive.range.torque_Nm);
}

double winding_limit(const JointConfig& joint) noexcept {
  return std::max(std::abs(joint.position_min), std::abs(joint.position_max)) +
         joint.transmission.preload_max_rad;
}

}  // namespace limber
