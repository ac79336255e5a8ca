// FALLBACK and DAMP of one drive: its command while the driver holds the arm without the
// controller.
//
//   first 100 ms:  tau = held - kd theta_dot,  held: from the torque before, by the joint's
//                                              torque rate, to the motor's part of gravity and
//                                              preload
//   then:          tau = held + kp (theta_hold - theta) - kd theta_dot,
//                                              theta_hold: the angle reached by then
//
// The motor is held, not the link: behind a spring that is as stiff as the spring, and passive.
// A joint whose replies are missing gets no position to hold, as its angle is unknown: it keeps the
// held torque, and brakes.
#pragma once

#include <cstdint>

#include "drivers/drive/joint_link.h"

namespace limber {

/// Allowed inside the cycle.
class Fallback {
 public:
  /// `torque_step`: most by which the held torque changes in a cycle, N m.
  explicit Fallback(double torque_step) noexcept : torque_step_(torque_step) {}

  /// FALLBACK begins with the motor making `present`, and goes to `held`, N m.
  void start(double present, double held) noexcept {
    held_ = present;
    held_in_the_end_ = held;
    holding_ = false;
  }

  /// `settling`: within the first 100 ms. `trusted`: the measured angle is good; a joint whose
  /// replies return is held where it is then. The spring gives way: theta_hold follows a joint that
  /// is pushed so far that spring and held torque together would exceed the joint's torque limit.
  /// Once a cycle.
  JointCommand command(const JointLink& link, bool settling, bool trusted) noexcept;

 private:
  double torque_step_;
  double held_ = 0.0;
  double held_in_the_end_ = 0.0;
  double theta_hold_ = 0.0;
  bool holding_ = false;
};

/// Braking alone: tau = -kd theta_dot.
inline JointCommand damp(const JointLink& link) noexcept {
  return {link.theta(), 0.0, link.joint().drive.hold_kd_Nms_per_rad, 0.0};
}

}  // namespace limber
