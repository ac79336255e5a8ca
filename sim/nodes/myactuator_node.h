// An emulated MyActuator drive: what a real one does with each order and each motion command, and
// when it lets go by itself. Written from the manual, not from limber's family.
//
// Every frame for the node is answered, but a reset and orders that it does not have: motion
// commands with the state before they take effect, orders that set something with a copy.
#pragma once

#include <array>
#include <cstdint>

#include "drivers/can/can_frame.h"
#include "drivers/protocols/myactuator.h"
#include "robots/loader/robot.h"
#include "sim/nodes/motor_node.h"

namespace limber::sim {

/// Off (phases open), or running the five numbers of the last motion command, whose ranges are
/// those of its firmware. As in the real drive
///   - nothing enables it: the first motion command does; it turns once its brake is released;
///   - the time-out is off when it is delivered. On expiry the drive is off and its brake locked,
///     it tells so at once and every second, and of what comes next the first frame is only sent
///     back, the second acts;
///   - an error shows in the status only, and unasked every 100 ms where that is switched on. A
///     motion command is answered as ever. The error goes with its cause, the drive stays off;
///   - number and zero change at a reset, which takes 1.1 s; it then counts from a single turn.
/// After construction every member is allowed in the cycle.
class MyactuatorNode final : public MotorNode {
 public:
  explicit MyactuatorNode(const JointConfig& joint);

  bool receive(const CanFrame& frame, const JointReading& joint, std::int64_t now_ns,
               CanFrame* reply) noexcept override;
  bool next_frame(CanFrame* frame) noexcept override;
  void update(const JointReading& joint, std::int64_t now_ns) noexcept override;
  DriveLaw law() const noexcept override;
  bool enabled() const noexcept override { return runs_ && released_; }

 private:
  /// DRIVE_ERROR is an under-voltage.
  void on_fault(int fault, const JointReading& joint) noexcept override;
  double position(const JointReading& joint) const noexcept;
  CanFrame status_frame() const noexcept;
  CanFrame motion_frame(const JointReading& joint) const noexcept;
  /// False: there is no answer.
  bool obey(const CanFrame& frame, const JointReading& joint, CanFrame* reply) noexcept;
  bool obey_function(const CanFrame& frame) noexcept;
  void set_off() noexcept;
  void reset(const JointReading& joint) noexcept;

  DriveConfig drive_;
  int number_;
  int next_number_;
  bool runs_ = false;
  bool released_ = false;
  bool shorted_ = false;
  mit::Command command_;
  double zero_ = 0.0;  ///< added to the drive's angle
  double next_zero_ = 0.0;
  double frozen_position_ = 0.0;
  std::uint16_t errors_ = 0;
  bool tells_errors_ = false;
  std::int64_t next_status_ns_ = 0;
  std::uint32_t timeout_ms_ = 0;
  bool timed_out_ = false;
  std::int64_t next_timed_out_ns_ = 0;
  std::int64_t last_frame_ns_ = 0;
  std::int64_t deaf_until_ns_ = 0;  ///< while it restarts
};

}  // namespace limber::sim
