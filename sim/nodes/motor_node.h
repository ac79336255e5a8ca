// An emulated motor drive on the bus, whatever its protocol.
#pragma once

#include <cstdint>
#include <memory>

#include "drivers/can/can_frame.h"
#include "robots/robot.h"
#include "sim/joints/drive_law.h"

namespace limber::sim {

/// The joint as it is, in joint coordinates. rad, rad/s, N m.
struct JointReading {
  double q = 0.0;
  double v = 0.0;
  double motor_torque = 0.0;
};

/// After construction every member is allowed in the cycle.
class MotorNode {
 public:
  virtual ~MotorNode() = default;

  /// Handles a frame at simulated time `now`. True if `reply` is to be sent.
  virtual bool receive(const CanFrame& frame, const JointReading& joint, std::int64_t now_ns,
                       CanFrame* reply) noexcept = 0;

  /// Lets simulated time pass: the drive's own watchdog, the end of faults. Call before every
  /// integration step.
  virtual void update(std::int64_t now_ns) noexcept = 0;

  /// The torque law at work, in joint coordinates.
  virtual DriveLaw law() const noexcept = 0;
  virtual bool enabled() const noexcept = 0;

  /// scenario_event_t FAULT_* until a simulated time:
  /// - SILENT: obeys, but its replies never reach the bus.
  /// - FROZEN_ENCODER: position stays what it was, speed reads 0, for the bus and for the drive's
  ///   own law.
  /// - DRIVE_ERROR: leaves enabled mode with an error that cannot be cleared while it lasts.
  /// - DROP_COMMANDS: answers, but takes nothing in; the watchdog is not fed.
  virtual void inject(int fault, const JointReading& joint, std::int64_t until_ns) noexcept = 0;
  virtual void clear_faults() noexcept = 0;
};

/// The node that speaks the protocol of the joint's drive. Set-up only.
std::unique_ptr<MotorNode> make_motor_node(const JointConfig& joint, bool fd);

}  // namespace limber::sim
