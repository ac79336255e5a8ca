// What makes torque of a drive's command: current loop, winding and magnets, or a valve.
//
// Electric, everything at the joint (behind the gear), as one equivalent d.c. winding:
//   tau = k_t (1 + a_m (T - 25)) i + c sin(n theta)     magnets and cogging
//   L i' = u - R(T) i - k_e theta',  |u| <= U           R(T) = R (1 + a_c (T - 25))
//   C T' = R(T) i^2 - (T - 25) / R_th                   25 degC around it
// Current drive: lag_s i' = tau_cmd / k_t,believed - i, as far as the voltage suffices. Voltage
// drive: u = R tau_cmd / k_t,believed, so that k_t k_e / R is added to the joint's damping.
// Source: Spong, Hutchinson, Vidyasagar, Robot Modeling and Control (2006), ch. 6.
//
// Hydraulic: tau' = K_h (c_l u - D_h theta' - c_l tau), u = tau_cmd: a lag 1 / (K_h c_l) and a
// damping D_h / c_l. Source: Merritt, Hydraulic Control Systems (1967), linearised valve.
#pragma once

#include "robots/loader/robot.h"

namespace limber::sim {

/// One motor. A value; after construction every member is allowed in the cycle.
class Actuator {
 public:
  /// Ideal: the torque is the command.
  Actuator() = default;
  /// `real` is the motor as it is; the drive takes its torque constant for the believed one (N m/A
  /// at the joint, above 0) and knows the resistance at 25 degC.
  Actuator(const DriveConfig& real, double believed_torque_constant_Nm_per_A);

  /// The torque is exactly the command, always.
  bool ideal() const noexcept { return ideal_; }

  /// Lets h > 0 seconds pass with command (N m) and speed (rad/s) held. Returns the mean torque on
  /// the rotor over the step, N m at the joint, before friction. A command that is not finite is
  /// taken for zero.
  double step(double command_Nm, double theta, double theta_dot, double h) noexcept;

  double torque() const noexcept { return torque_; }      ///< of the last step
  double current_A() const noexcept { return current_; }  ///< at the end of the step
  double winding_degC() const noexcept { return kAmbient_degC + warmth_; }
  void reset() noexcept;  ///< at rest, cold

 private:
  static constexpr double kAmbient_degC = 25.0;

  double electric(double command, double theta, double theta_dot, double h) noexcept;
  double resistance() const noexcept;

  ActuatorConfig config_;
  double torque_constant_ = 1.0;
  double believed_torque_constant_ = 1.0;
  bool ideal_ = true;
  double current_ = 0.0;
  double pressure_torque_ = 0.0;  // hydraulic: at the end of the step
  double torque_ = 0.0;
  double warmth_ = 0.0;  // of the winding, K above ambient
};

}  // namespace limber::sim
