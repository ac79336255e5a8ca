// The hand's law: a spring towards a width that moves with bounded speed, within a force.
//
//   F   = clamp(K (w_d - w) - D w', +-F_most)      N at each finger, positive opens
//   tau = F dw/dtheta                              N m at the motor, its change bounded
//
// F_most: of the goal; once something is grasped at most hold_force_N; of the heat (hand_heat.h).
// w_d goes to the goal with the goal's speed, and stops kLead_m beyond the width at which the
// spring has the force that it may have: fingers that come free close with that speed, too, after
// the way by which w_d leads, over which spring and damper alone bound it, |w'| < K (w_d - w) / D.
//
// Grasped: for 0.1 s |w'| < 2 mm/s, |F| >= 0.8 F_most, and w is more than 2 mm from w_d and more
// than 0.5 mm from closed and open. Lost: w comes within 1 mm of w_d.
#pragma once

#include "controller/hand/hand_heat.h"
#include "robots/loader/robot.h"

namespace limber::controller {

/// Checked by who makes it: finite, within the hand's limits.
struct HandGoal {
  double width_m = 0.0;  ///< down to -kPress_m
  double force_N = 0.0;
  double speed_m_per_s = 0.0;
};

/// Of the motor, behind its gear, as its drive reports it.
struct HandReading {
  double angle_rad = 0.0;
  double rate_rad_per_s = 0.0;
};

/// Every member but the constructor is allowed in the cycle.
class HandLaw {
 public:
  /// Goals may lie so far beyond closed, so that thin things are pressed, too.
  static constexpr double kPress_m = 0.02;

  explicit HandLaw(const HandConfig& hand);

  /// The law takes over from `torque`, N m: its goal is the width whose spring makes it.
  void begin(const HandReading& at, double torque) noexcept;
  /// Acts from the next step on; may be called in every cycle.
  void set_goal(const HandGoal& goal) noexcept { goal_ = goal; }
  /// The goal is where the target is now: what is held is held on, what moves comes to rest.
  void stay() noexcept { goal_.width_m = target_m_; }
  /// N m at the motor, `dt_s` after the last.
  double step(const HandReading& at, double dt_s) noexcept;
  /// No law ran for dt_s; the drive made `torque`.
  void rest(const HandReading& at, double torque, double dt_s) noexcept;

  const HandGoal& goal() const noexcept { return goal_; }
  const HandHeat& heat() const noexcept { return heat_; }
  double target_m() const noexcept { return target_m_; }
  double bound_N() const noexcept { return bound_N_; }
  bool grasped() const noexcept { return grasped_; }
  /// On its way, or not yet sure whether it grasps.
  bool moving() const noexcept {
    return still_s_ < kStill_s || travelling_ || (pressed_s_ > 0.0 && !grasped_);
  }

 private:
  static constexpr double kStill_s = 0.1;
  static constexpr double kLead_m = 4e-3;

  void advance_target(double width, double dt_s) noexcept;
  void judge_grasp(double width, double speed, double force, double dt_s) noexcept;
  double bound(double slope) const noexcept;

  HandTravel travel_;
  double stiffness_;
  double damping_;
  double hold_force_N_;
  double torque_limit_Nm_;
  double torque_rate_Nm_per_s_;
  HandHeat heat_;
  HandGoal goal_;
  double target_m_ = 0.0;
  double bound_N_ = 0.0;
  double torque_ = 0.0;
  double still_s_ = 0.0;
  double pressed_s_ = 0.0;
  bool grasped_ = false;
  bool travelling_ = false;
};

}  // namespace limber::controller
