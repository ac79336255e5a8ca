// An emulated Damiao motor drive: what a real one does with each frame, and when it switches itself
// off.
//
// Every frame for the node is answered with the state before the frame takes effect, on the reply
// id, in the format (classic or FD) of the request. The node speaks the drive's own angle (sign and
// offset of the robot's description, then set-zero). Written identifiers hold from the next frame
// on.
#pragma once

#include <cstdint>

#include "drivers/can/can_frame.h"
#include "drivers/protocols/mit.h"
#include "robots/loader/robot.h"
#include "sim/nodes/damiao_registers.h"
#include "sim/nodes/motor_node.h"
#include "sim/nodes/setpoint_profile.h"

namespace limber::sim {

/// States are those of the status nibble: disabled (phases open: rotor and friction are all the
/// joint feels), enabled, or a latched error, which leaves enabled mode until it is cleared (FB)
/// and the drive enabled again (FC). Commands of the active control mode are obeyed: MIT, or a
/// setpoint that a position loop follows, with the greatest gains of the MIT frames and with speed
/// and acceleration limited. Those of other modes are not even answered, but for MIT's. After
/// construction every member is allowed in the cycle.
class DamiaoNode final : public MotorNode {
 public:
  DamiaoNode(const JointConfig& joint, bool fd);

  /// Frames for others, of the wrong length, extended, remote or error frames are no concern of the
  /// node.
  bool receive(const CanFrame& frame, const JointReading& joint, std::int64_t now_ns,
               CanFrame* reply) noexcept override;
  void update(const JointReading& joint, std::int64_t now_ns) noexcept override;

  /// Limited to the smaller of the torque range and the drive's peak, and in force-position mode to
  /// the commanded share of it.
  DriveLaw law() const noexcept override;
  bool enabled() const noexcept override { return state_ == mit::DriveError::kEnabled; }

  mit::DriveError state() const noexcept { return state_; }
  const DamiaoRegisters& registers() const noexcept { return registers_; }

 private:
  /// DRIVE_ERROR is an over-current.
  void on_fault(int fault, const JointReading& joint) noexcept override;
  /// The drive's own view of its joint.
  struct Sensed {
    double position, velocity, torque;
  };

  Sensed sense(const JointReading& joint) const noexcept;
  CanFrame state_frame(const CanFrame& request, const JointReading& joint) const noexcept;
  void on_special(mit::Special special, const JointReading& joint) noexcept;
  void on_command(const CanFrame& frame) noexcept;
  void on_servo_command(const CanFrame& frame, const JointReading& joint) noexcept;
  void pass_time(const JointReading& joint, std::int64_t now_ns) noexcept;
  void forget_command() noexcept;
  double most_torque() const noexcept;
  bool on_register(const CanFrame& frame, const mit::RegisterRequest& request,
                   const JointReading& joint, CanFrame* reply) noexcept;
  void leave(mit::DriveError state) noexcept;

  DriveConfig drive_;
  DamiaoRegisters registers_;
  mit::DriveError state_ = mit::DriveError::kDisabled;
  mit::Command command_;       ///< in the other modes than MIT: the position loop's
  bool has_setpoint_ = false;  ///< in those modes
  SetpointProfile setpoint_;   ///< rad
  double torque_share_ = 1.0;
  bool shorted_ = false;
  double zero_ = 0.0;  // set-zero: added to the drive angle
  std::int64_t last_frame_ns_ = 0;
  double frozen_position_ = 0.0;
};

}  // namespace limber::sim
