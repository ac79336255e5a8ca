#include "drivers/motor_view.h"

#include <algorithm>
#include <cmath>

namespace limber {

JointConfig motor_view(const JointConfig& joint, int motor) {
  JointConfig view = joint;
  if (joint.has_antagonist)
    view.torque_limit_Nm = pulling_limit(motor == 0 ? joint.drive : joint.antagonist);
  if (motor == 0) return view;
  view.name += " (antagonist)";
  view.drive = joint.antagonist;
  view.link_encoder.present = false;
  view.torque_sensor.present = false;
  view.torque_loop = {};
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
