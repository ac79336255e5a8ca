// The antagonist of a joint by itself.
#pragma once

#include "robots/loader/robot.h"

namespace limber {

/// The joint as its second motor's drive knows it: that drive, and none of the sensors and loops,
/// which belong to the first. Set-up only.
inline JointConfig second_motor(const JointConfig& joint) {
  JointConfig view = joint;
  view.drive = joint.antagonist;
  view.link_encoder.present = false;
  view.torque_sensor.present = false;
  view.torque_loop = {};
  return view;
}

}  // namespace limber
