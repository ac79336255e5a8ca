// The language of one motor drive: what limber says to it and hears from it, as frames. One
// implementation a family of drives, one object a drive. Angles, speeds and torques are the
// drive's own, in rad, rad/s and N m at the joint, before the joint's sign and offset.
//
// After construction every member is free of allocation, locks, logs and exceptions.
#pragma once

#include <cstdint>
#include <memory>

#include "drivers/can/can_frame.h"
#include "robots/robot.h"

namespace limber {

/// tau_drive = kp (angle - angle_drive) + kd (speed - speed_drive) + torque.
struct DriveCommand {
  double angle_rad = 0.0;
  double speed_rad_per_s = 0.0;
  double kp_Nm_per_rad = 0.0;
  double kd_Nms_per_rad = 0.0;
  double torque_Nm = 0.0;
};

enum class DriveCondition : std::uint8_t {
  kDisabled,  ///< or on its way to being enabled
  kEnabled,   ///< obeys commands
  kFailed,    ///< needs clear_error()
};

struct DriveReport {
  DriveCondition condition = DriveCondition::kDisabled;
  double angle_rad = 0.0;  ///< of the motor
  double speed_rad_per_s = 0.0;
  double link_angle_rad = 0.0;         ///< beyond the spring; the motor's without a link encoder
  double link_speed_rad_per_s = 0.0;
  double torque_Nm = 0.0;  ///< on the link if the joint has a torque sensor, else the drive's estimate
  double current_A = 0.0;  ///< q axis
  double temperature_degC = 0.0;
};

/// One thing a drive is asked, or told and asked to repeat, before it may be enabled. `reg` is the
/// family's own numbering; CANopen: index << 8 | subindex.
struct StartupQuestion {
  std::uint32_t reg = 0;
  double expected = 0.0;
};
enum class Answer : std::uint8_t { kNone, kRight, kWrong };

class DriveFamily {
 public:
  virtual ~DriveFamily() = default;

  // --- towards the drive; every frame is answered with one ------------------------------------

  /// False, and no frame made, if something is not finite. `sent` is the command as the drive will
  /// understand it. A torque beyond the joint's limit is never sent.
  [[nodiscard]] virtual bool command(const DriveCommand& command, CanFrame* frame,
                                     DriveCommand* sent) noexcept = 0;
  virtual CanFrame disable() noexcept = 0;
  virtual CanFrame clear_error() noexcept = 0;
  /// With zero torque; `angle_rad` is where the drive was seen last.
  virtual CanFrame enable(double angle_rad) noexcept = 0;
  virtual CanFrame state_request() const noexcept = 0;
  /// Something every drive of the family answers, and which disturbs nothing.
  virtual CanFrame presence_request() const noexcept = 0;
  /// True if the drives of this family take effect and answer at a frame of their own: the driver
  /// sends `bus_frame` once a cycle on their bus, after all commands.
  virtual bool needs_bus_frame(CanFrame* bus_frame) const noexcept {
    static_cast<void>(bus_frame);
    return false;
  }

  // --- from the drive -------------------------------------------------------------------------

  /// Whether the frame comes from this drive, whatever it says.
  virtual bool is_mine(const CanFrame& frame) const noexcept = 0;
  /// False if the frame is no state of this drive.
  [[nodiscard]] virtual bool read_state(const CanFrame& frame,
                                        DriveReport* report) const noexcept = 0;
  /// Smallest difference between two angles that it can tell, rad.
  virtual double angle_resolution() const noexcept = 0;

  // --- the start-up dialogue, in this order ---------------------------------------------------

  virtual int questions() const noexcept = 0;
  virtual StartupQuestion question(int index) const noexcept = 0;
  virtual CanFrame ask(int index) const noexcept = 0;
  /// What the frame answers to the question; `found` is set unless kNone.
  virtual Answer judge(int index, const CanFrame& frame, double* found) const noexcept = 0;
};

/// The family that the joint's drive belongs to. `fd`: its bus carries FD frames. Set-up only.
std::unique_ptr<DriveFamily> make_drive_family(const JointConfig& joint, bool fd);

}  // namespace limber
