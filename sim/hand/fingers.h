// The simulated fingers: one degree of freedom behind the motor.
//
//   (B + m_f s^2 / 2) theta'' = tau_m - tau_f - tau_stop + s F,   s = dw/dtheta
//   F = k (w_o - w) - d w'  where the object between them is wider than w, and F > 0
//
// Both fingers, of mass m_f each, move by half of the width w. The step is implicit in friction,
// end stop and object, so that it is stable however hard these are. The table's pieces are
// straight: the inertia's change between them is left out.
#pragma once

#include "robots/loader/robot.h"
#include "sim/joints/end_stop.h"
#include "sim/joints/motor.h"

namespace limber::sim {

/// What the fingers press; none where it has no stiffness.
struct Squeezed {
  double width_m = 0.0;
  double stiffness_N_per_m = 0.0;
  double damping_Ns_per_m = 0.0;
};

/// After construction every member is allowed in the cycle.
class Fingers {
 public:
  /// At rest, open. The drive believes in a torque constant, N m/A.
  Fingers(const HandConfig& hand, double believed_torque_constant, bool friction);

  void step(const DriveLaw& law, const Squeezed& object, double h) noexcept;

  double theta() const noexcept { return theta_; }
  double theta_dot() const noexcept { return theta_dot_; }
  double width() const noexcept { return travel_.width(theta_); }
  double speed() const noexcept { return travel_.slope(theta_) * theta_dot_; }
  /// With which each finger presses the object, N.
  double force() const noexcept { return force_; }
  MotorPoint point() const noexcept { return {theta_, theta_dot_, theta_, theta_dot_}; }
  const Motor& motor() const noexcept { return motor_; }

 private:
  void move(const Squeezed* object, double h) noexcept;

  HandTravel travel_;
  double rotor_inertia_;
  double finger_mass_;
  Motor motor_;
  EndStop stop_;
  double theta_;
  double theta_dot_ = 0.0;
  double force_ = 0.0;
};

}  // namespace limber::sim
