// An emulated motor drive on the bus, whatever its protocol.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limber/scenario_event_t.hpp>
#include <memory>

#include "drivers/can/can_frame.h"
#include "robots/loader/robot.h"
#include "sim/joints/drive_law.h"

namespace limber::sim {

/// What the sensors of one drive see, in joint coordinates: rad, rad/s, N m. On rigid joints the
/// motor is where the link is.
struct JointReading {
  double theta = 0.0;  ///< this drive's motor, behind the gear
  double theta_dot = 0.0;
  double q = 0.0;  ///< link
  double v = 0.0;
  double motor_torque = 0.0;  ///< of this drive's motor, by the drive's own estimate
  double joint_torque = 0.0;  ///< as the torque sensor reads it; zero without one
  double current_A = 0.0;
  double winding_degC = 25.0;
};

/// After construction every member is allowed in the cycle.
class MotorNode {
 public:
  virtual ~MotorNode() = default;

  /// Handles a frame at simulated time `now`. True if `reply` is to be sent.
  virtual bool receive(const CanFrame& frame, const JointReading& joint, std::int64_t now_ns,
                       CanFrame* reply) noexcept = 0;
  /// The next unsolicited frame (start-up, heartbeat, emergency); false when there is no more.
  virtual bool next_frame(CanFrame* frame) noexcept {
    static_cast<void>(frame);
    return false;
  }

  /// Lets simulated time pass: the drive's loops, its watchdog, the end of faults. Called after
  /// every integration step, with the joint at its end.
  virtual void update(const JointReading& joint, std::int64_t now_ns) noexcept = 0;
  /// Rate of the drive's fastest sampled loop, 0 if there is none: integration steps are chosen so
  /// that a whole number of them makes its period.
  virtual double loop_rate_hz() const noexcept { return 0.0; }

  /// The torque law at work, in the motor's joint coordinates (theta, theta_dot).
  virtual DriveLaw law() const noexcept = 0;
  virtual bool enabled() const noexcept = 0;

  /// scenario_event_t FAULT_* until a simulated time:
  /// - SILENT: acts on commands, but its replies never reach the bus.
  /// - FROZEN_ENCODER: position stays what it was, speed reads 0, for the bus and for the drive's
  ///   own law.
  /// - DRIVE_ERROR: leaves enabled mode with an error that cannot be cleared while it lasts.
  /// - DROP_COMMANDS: answers, but takes nothing in; the watchdog is not fed.
  /// - HOT: reports a kelvin more than its limit_temperature_degC, or, without a thermometer,
  /// warns.
  void inject(int fault, const JointReading& joint, std::int64_t until_ns) noexcept {
    if (fault < 0 || fault >= kFaults) return;
    on_fault(fault, joint);
    fault_until_ns_[static_cast<std::size_t>(fault)] = until_ns;
  }
  void clear_faults() noexcept { fault_until_ns_.fill(0); }

 protected:
  /// What happens in the drive at the moment a fault begins.
  virtual void on_fault(int fault, const JointReading& joint) noexcept = 0;
  bool has(int fault) const noexcept {
    return now_ns_ < fault_until_ns_[static_cast<std::size_t>(fault)];
  }

  double temperature_degC(const DriveConfig& drive) const noexcept {
    const bool hot = has(scenario_event_t::FAULT_HOT);
    return hot && std::isfinite(drive.limit_temperature_degC) ? drive.limit_temperature_degC + 1.0
                                                              : kUsual_degC;
  }

  std::int64_t now_ns_ = 0;  ///< simulated time; receive() and update() keep it

 private:
  static constexpr int kFaults = scenario_event_t::FAULT_HOT + 1;
  static constexpr double kUsual_degC = 30.0;
  std::array<std::int64_t, kFaults> fault_until_ns_{};
};

/// The node that speaks the protocol of the joint's drive. `joint` is the joint as its drive
/// is configured for it (robot.yaml), not as it is. Set-up only.
std::unique_ptr<MotorNode> make_motor_node(const JointConfig& joint, bool fd);

}  // namespace limber::sim
