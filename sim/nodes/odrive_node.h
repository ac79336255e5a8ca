// An emulated ODrive axis in CANSimple, firmware 0.6. Written from the manual, not from limber's
// family.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "drivers/protocols/odrive.h"
#include "robots/loader/protocols/odrive_endpoints.h"
#include "robots/loader/robot.h"
#include "sim/nodes/motor_node.h"

namespace limber::sim {

/// Idle (phases open), or in closed loop with the last torque. As in the real drive
///   - commands are not answered; a remote or an empty frame is, with the message of its number;
///   - as delivered it is in position control, has no watchdog, sends estimates every 10 ms
///   unasked,
///     and its heartbeat every 100 ms, whatever happens in between;
///   - its velocity limit, 2 turns/s as delivered, takes torque away below it, too;
///   - an error disarms it, and once cleared it is still idle; the watchdog is fed by torques
///   alone;
///   - uncalibrated it has no estimate (NaN) and no closed loop, and tells no error;
///   - a reboot forgets what was not saved, and the turns that it had counted.
/// After construction every member is allowed in the cycle.
class OdriveNode final : public MotorNode {
 public:
  explicit OdriveNode(const JointConfig& joint);

  bool receive(const CanFrame& frame, const JointReading& joint, std::int64_t now_ns,
               CanFrame* reply) noexcept override;
  bool next_frame(CanFrame* frame) noexcept override;
  void update(const JointReading& joint, std::int64_t now_ns) noexcept override;
  DriveLaw law() const noexcept override;
  bool enabled() const noexcept override { return state_ == odrive::kClosedLoop; }

 private:
  struct Settings {
    std::uint32_t node = odrive::kEverybody;
    /// By OdriveEndpoint, as on the bus.
    std::array<std::uint32_t, kOdriveEndpoints.size()> raw = {
        0, 0, 0, 10, 3, 1, std::bit_cast<std::uint32_t>(2.0F)};
    float most_A = 10.0F;
    bool calibrated = false;

    float real(OdriveEndpoint which) const noexcept { return std::bit_cast<float>(raw[which]); }
  };

  /// DRIVE_ERROR is an over-current.
  void on_fault(int fault, const JointReading& joint) noexcept override;
  /// What it tells with this number; empty: nothing.
  CanFrame told(odrive::Message message, const JointReading& joint) const noexcept;
  void obey(const CanFrame& frame, const JointReading& joint) noexcept;
  void set_state(std::uint32_t wanted) noexcept;
  /// Reads or writes; true if it is answered.
  bool endpoint(const CanFrame& frame, CanFrame* reply) noexcept;
  void reboot(int action, const JointReading& joint) noexcept;
  void disarm(std::uint32_t error) noexcept;
  float turns(const JointReading& joint) const noexcept;
  float turns_per_s(const JointReading& joint) const noexcept;

  DriveConfig drive_;
  Settings saved_;
  Settings settings_;
  JointReading joint_;
  std::uint32_t state_ = odrive::kIdle;
  std::uint32_t result_ = 0;
  std::uint32_t errors_ = 0;
  std::uint32_t disarm_reason_ = 0;
  float torque_Nm_ = 0.0F;
  double zero_turns_ = 0.0;  ///< added to the motor's angle
  float frozen_turns_ = 0.0F;
  std::int64_t fed_ns_ = 0;
  std::int64_t heartbeat_ns_ = 0;  ///< the next one
  std::int64_t estimates_ns_ = 0;
  std::int64_t deaf_until_ns_ = 0;
};

}  // namespace limber::sim
