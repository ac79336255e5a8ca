// FALLBACK and DAMP of one drive: its command while the driver holds the arm without the
// controller.
//
//   first 100 ms:  tau = held - kd theta_dot,  held: from the torque before, by the joint's
//                                              torque rate, to the motor's part of gravity, or
//                                              of the torque at rest (rest_torque.h), and preload
//   then:          tau = held + kp (theta_hold - theta) - kd theta_dot,
//                                              theta_hold: the angle reached by then
//   DAMP:          tau = held - kd theta_dot,  held: likewise to 0
//
// kd is the drive's hold_kd, and less where that would take tau beyond the joint's torque limit, or
// what is held and damped in one cycle further than its torque rate.
//
// The motor is held, not the link: behind a spring that is as stiff as the spring, and passive.
// A joint whose replies are missing gets no position to hold, as its angle is unknown: it keeps the
// held torque, and brakes.
#pragma once

#include <cstdint>

#include "drivers/drive/joint_link.h"

namespace limber {

/// What of the joint's motion the driver may rely on.
struct KnownMotion {
  bool angle = true;
  bool velocity = true;
};

/// Allowed inside the cycle.
class Fallback {
 public:
  /// `torque_step`: most by which what is held and damped changes in a cycle, N m.
  explicit Fallback(double torque_step) noexcept : torque_step_(torque_step) {}

  /// Begins with the motor making `present`, and goes to `held`, N m.
  void start(double present, double held) noexcept {
    damped_ = held_ = present;
    held_in_the_end_ = held;
    holding_ = false;
  }
  /// From where it is to another `held`.
  void go_on_to(double held) noexcept { held_in_the_end_ = held; }

  /// `settling`: within the first 100 ms. A joint whose angle is known again is held where it is
  /// then. The spring gives way: theta_hold follows a joint that is pushed so far that spring and
  /// held torque together would exceed the joint's torque limit. Once a cycle.
  JointCommand hold(const JointLink& link, bool settling, KnownMotion known) noexcept;
  /// Braking alone. Once a cycle.
  JointCommand damp(const JointLink& link) noexcept { return hold(link, true, {}); }

 private:
  double torque_step_;
  double damped_ = 0.0;  ///< held_ and damping of the last cycle, by the speed read before
  double held_ = 0.0;
  double held_in_the_end_ = 0.0;
  double theta_hold_ = 0.0;
  bool holding_ = false;
};

}  // namespace limber
