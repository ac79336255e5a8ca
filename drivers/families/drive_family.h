// The language of one motor drive: what limber says to it and hears from it, as frames. One
// implementation a family of drives, one object a drive. Angles, speeds and torques are the
// drive's own, in rad, rad/s and N m at the joint, before the joint's sign and offset.
//
// After construction every member is free of allocation, locks, logs and exceptions.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

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

bool all_finite(const DriveCommand& command) noexcept;

enum class DriveCondition : std::uint8_t {
  kDisabled,  ///< or on its way to being enabled
  kEnabled,   ///< obeys commands
  kFailed,    ///< needs clear_error()
};

struct DriveReport {
  DriveCondition condition = DriveCondition::kDisabled;
  double angle_rad = 0.0;  ///< of the motor
  double speed_rad_per_s = 0.0;
  double link_angle_rad = 0.0;  ///< beyond the spring; the motor's without a link encoder
  double link_speed_rad_per_s = 0.0;
  double torque_Nm =
      0.0;  ///< on the link if the joint has a torque sensor, else the drive's estimate
  double current_A = 0.0;  ///< q axis
  double temperature_degC = 0.0;
  std::uint16_t status = 0;  ///< the family's own word for it
};

/// What is known of a drive when it is spoken to.
struct DriveMemory {
  DriveReport seen;     ///< the last plausible one
  bool recent = false;  ///< no older than the driver bridges: a loop may be closed on it
};

/// One thing a drive is asked, or told and asked to repeat, before it may be enabled. `reg` is the
/// family's own numbering; CANopen: index << 8 | subindex.
struct StartupQuestion {
  std::uint32_t reg = 0;
  double expected = 0.0;
  bool answered = true;  ///< false: nothing comes back; the next question shows if it was heard
};
enum class Answer : std::uint8_t {
  kNone,
  kRight,
  kNotYet,  ///< wrong, but it may still become right: ask again
  kWrong,
  kRefused,  ///< `found` is the drive's reason
};

/// What the start-up dialogue failed at.
struct StartupFailure {
  std::uint32_t reg = 0;          ///< 0: the disabling
  Answer answer = Answer::kNone;  ///< the last one
  double found = 0.0;
  double expected = 0.0;
};

class DriveFamily {
 public:
  virtual ~DriveFamily() = default;

  // --- towards the drive; every frame is answered with one ------------------------------------

  /// False, and no frame made, if something is not finite. `sent` is the command as the drive will
  /// understand it. A torque beyond the joint's limit is never sent.
  [[nodiscard]] virtual bool command(const DriveCommand& command, const DriveMemory& memory,
                                     CanFrame* frame, DriveCommand* sent) noexcept = 0;
  virtual CanFrame disable() noexcept = 0;
  virtual CanFrame clear_error() noexcept = 0;
  /// The next step towards being enabled, with zero torque.
  virtual CanFrame enable(const DriveMemory& memory) noexcept = 0;
  virtual CanFrame state_request() const noexcept = 0;
  /// Something every drive of the family answers, and which disturbs nothing.
  virtual CanFrame presence_request() const noexcept = 0;
  /// True if the drives of this family take effect and answer at a frame of their own: the driver
  /// sends `bus_frame` once a cycle on their bus, after all commands, and it is their request of
  /// state.
  virtual bool needs_bus_frame(CanFrame* bus_frame) const noexcept {
    static_cast<void>(bus_frame);
    return false;
  }

  // --- from the drive -------------------------------------------------------------------------

  /// Whether the frame comes from this drive, whatever it says.
  virtual bool is_mine(const CanFrame& frame) const noexcept = 0;
  /// True of frames that this drive sends unasked, or late, and that nobody needs to understand.
  virtual bool is_aside(const CanFrame& frame) const noexcept {
    static_cast<void>(frame);
    return false;
  }
  /// False if the frame is no state of this drive.
  [[nodiscard]] virtual bool read_state(const CanFrame& frame,
                                        DriveReport* report) const noexcept = 0;
  /// Smallest difference between two angles that it can tell, rad.
  virtual double angle_resolution() const noexcept = 0;

  // --- the start-up dialogue, in this order ---------------------------------------------------

  /// It begins with disable(). False if a drive that was not started yet does not answer that: it
  /// is then tried, and the questions see to it.
  virtual bool disable_is_answered() const noexcept { return true; }
  /// Cycles that an answer may take before the question is repeated.
  virtual int patience_cycles() const noexcept { return 1; }
  virtual int questions() const noexcept = 0;
  virtual StartupQuestion question(int index) const noexcept = 0;
  virtual CanFrame ask(int index) const noexcept = 0;
  /// What the frame answers to the question; `found` is set unless kNone.
  virtual Answer judge(int index, const CanFrame& frame, double* found) const noexcept = 0;
  /// In words: "register 23 is 10, expected 28". Allocates: for messages, outside the cycle.
  virtual std::string describe(const StartupFailure& failure) const;
};

/// The family that the joint's drive belongs to. `fd`: its bus carries FD frames; `period_s`: of
/// the commands. Set-up only.
std::unique_ptr<DriveFamily> make_drive_family(const JointConfig& joint, bool fd, double period_s);

}  // namespace limber
