// One joint's end of the bus: the only place that knows the drive's sign and zero.
//
//   joint angle  = sign * (drive angle - offset)       speed and torque likewise by sign
//
// Allowed inside the cycle: everything but the constructor.
#pragma once

#include <cstdint>
#include <memory>

#include "drivers/can/can_frame.h"
#include "drivers/families/drive_family.h"
#include "robots/robot.h"

namespace limber {

/// What a drive shall do, in joint coordinates: tau_drive = kp (q - q_drive) - kd v_drive + tau.
struct JointCommand {
  double q = 0.0;    ///< rad
  double kp = 0.0;   ///< N m/rad
  double kd = 0.0;   ///< N m s/rad
  double tau = 0.0;  ///< N m
};

class JointLink {
 public:
  JointLink(const JointConfig& joint, bool fd, double period_s, int bridged_cycles);

  // --- towards the drive; each call makes the frame of this cycle -----------------------------

  /// Torque only: kp = kd = 0. The position field carries the angle measured last, so that no frame
  /// asks for a motion, whatever becomes of its gain fields.
  CanFrame torque(double tau) noexcept;

  /// What is not finite is not sent: the frame is then a state request.
  CanFrame command(const JointCommand& command) noexcept;

  CanFrame disable() noexcept;
  CanFrame clear_error() noexcept;
  CanFrame enable() noexcept;
  CanFrame state_request() noexcept;

  // --- from the drive -------------------------------------------------------------------------

  /// Takes a state reply. False, and nothing taken: not one, another motor's number, a second one
  /// in this cycle, or an angle the joint cannot have reached since the last one
  /// (1.5 velocity_limit T for each cycle since, at most as many as are bridged and one, plus two
  /// counts).
  bool receive(const CanFrame& frame) noexcept;

  /// Start of a cycle: no reply yet, one cycle more since the last.
  void begin_cycle() noexcept;
  /// The drive may have been anywhere since: the next angle is taken as it comes.
  void forget_angle() noexcept { angle_known_ = false; }

  // --- what is known --------------------------------------------------------------------------

  bool fresh() const noexcept { return age_cycles_ == 0; }  ///< answered in this cycle
  bool ever_answered() const noexcept { return age_cycles_ != kNever; }
  /// Cycles since the last valid reply; kNever before the first.
  std::int32_t age_cycles() const noexcept { return age_cycles_; }
  static constexpr std::int32_t kNever = INT32_MAX;

  double q() const noexcept { return q_; }      ///< rad
  double v() const noexcept { return v_; }      ///< rad/s
  double tau() const noexcept { return tau_; }  ///< N m, the drive's own estimate
  double tau_applied() const noexcept;          ///< N m, see below
  double current_A() const noexcept { return current_A_; }
  double temperature_degC() const noexcept { return temperature_degC_; }
  bool enabled() const noexcept { return condition_ == DriveCondition::kEnabled; }
  bool drive_error() const noexcept { return condition_ == DriveCondition::kFailed; }
  bool out_of_range() const noexcept;  ///< 0.02 rad beyond a position limit
  const JointConfig& joint() const noexcept { return joint_; }
  DriveFamily& family() noexcept { return *family_; }

 private:
  bool plausible(double q) const noexcept;

  JointConfig joint_;
  std::unique_ptr<DriveFamily> family_;
  int longest_gap_;         ///< cycles
  double jump_per_cycle_;   ///< rad
  double jump_resolution_;  ///< rad
  DriveCommand sent_;       ///< as the drive understands it
  bool commanded_ = false;  ///< this cycle's frame is a command, not a request

  std::int32_t age_cycles_ = kNever;
  bool angle_known_ = false;
  double q_ = 0.0;
  double v_ = 0.0;
  double tau_ = 0.0;
  double current_A_ = 0.0;
  double temperature_degC_ = 0.0;
  DriveCondition condition_ = DriveCondition::kDisabled;
};

}  // namespace limber
