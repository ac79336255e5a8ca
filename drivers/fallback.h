// What one drive does while the driver holds the arm by itself.
//
//   first 100 ms:  tau = gravity of the last accepted command - kd v
//   then:          tau = gravity + kp (q_hold - q) - kd v,  q_hold: the angle reached by then
//
// A joint whose replies are missing gets no position to hold, as nobody knows where it is: it goes
// on floating on that gravity torque, and braking.
#pragma once

#include <cstdint>

#include "drivers/joint_link.h"

namespace limber {

/// Allowed inside the cycle.
class JointHold {
 public:
  void start(double gravity) noexcept {
    gravity_ = gravity;
    holding_ = false;
  }

  /// `settling`: within the first 100 ms. `trusted`: the measured angle is good; a joint that comes
  /// back is held where it is then.
  /// The spring gives way: q_hold follows a joint that is pushed so far that spring and gravity
  /// together would exceed the joint's torque limit.
  JointCommand command(const JointLink& link, bool settling, bool trusted) noexcept;

 private:
  double gravity_ = 0.0;
  double q_hold_ = 0.0;
  bool holding_ = false;
};

/// Braking alone: tau = -kd v.
inline JointCommand damp(const JointLink& link) noexcept {
  return {link.q(), 0.0, link.joint().drive.hold_kd_Nms_per_rad, 0.0};
}

}  // namespace limber
