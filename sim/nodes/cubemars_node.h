// An emulated CubeMars AK drive in MIT mode: what a real one does with each frame.
#pragma once

#include <cstdint>

#include "drivers/can/can_frame.h"
#include "drivers/protocols/cubemars.h"
#include "robots/loader/robot.h"
#include "sim/nodes/motor_node.h"

namespace limber::sim {

/// Off (phases open), or running the five numbers of the last command. As in the real drive
///   - every frame for it is answered, with the state before the frame takes effect, and nothing
///     else is sent; no answer tells whether it is on;
///   - there is no watchdog: it goes on with the last command for ever;
///   - an error switches it off, shows in the state but not in that of a V1, and goes with its
///     cause;
///   - a new zero takes effect at once, also while it is on, and silences it for more than a
///   second;
///   - a V3 needs no enabling, and answers each command (a choice of its maker's tool).
/// After construction every member is allowed in the cycle.
class CubemarsNode final : public MotorNode {
 public:
  explicit CubemarsNode(const JointConfig& joint) : drive_(joint.drive) {}

  bool receive(const CanFrame& frame, const JointReading& joint, std::int64_t now_ns,
               CanFrame* reply) noexcept override;
  void update(const JointReading& joint, std::int64_t now_ns) noexcept override;
  DriveLaw law() const noexcept override;
  bool enabled() const noexcept override { return on_; }

 private:
  /// DRIVE_ERROR is an over-current.
  void on_fault(int fault, const JointReading& joint) noexcept override;
  double position(const JointReading& joint) const noexcept;
  void obey(const CanFrame& frame, const JointReading& joint) noexcept;
  void switch_on(bool on) noexcept;

  DriveConfig drive_;
  bool on_ = false;
  std::uint8_t error_ = 0;
  mit::Command command_;
  double zero_ = 0.0;  ///< added to the drive's angle
  double frozen_position_ = 0.0;
  std::int64_t deaf_until_ns_ = 0;
};

}  // namespace limber::sim
