// Encodes commands to, and decodes replies from, one type of motor drive. One implementation a
// family of drives, one object a drive. Angles, speeds and torques are the
// drive's own, in rad, rad/s and N m at the joint, before the joint's sign and offset.
//
// After construction every member is free of allocation, locks, logs and exceptions.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "drivers/can/can_filter.h"
#include "drivers/can/can_frame.h"
#include "robots/loader/robot.h"

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
  kEnabled,   ///< executes commands
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
  double current_A = 0.0;         ///< q axis
  double temperature_degC = 0.0;  ///< the greatest of several
  std::uint16_t status = 0;       ///< status or error code in the family's own numbers
  bool follows = true;            ///< enabled, it executes its target; false: it ignores that
  bool warns = false;             ///< goes on, but with something to be looked at
};

/// What a frame has of a drive's state, which may come in several.
enum class StateReading : std::uint8_t {
  kNone,
  kPart,   ///< more is to come in this cycle
  kWhole,  ///< all of it is there
};

/// The drive's last report when a command is made.
struct DriveMemory {
  DriveReport seen;     ///< the last plausible one
  bool recent = false;  ///< no older than the driver bridges: a loop may be closed on it
};

/// One register read, or written, before the drive may be enabled. `reg` is the family's own
/// numbering; CANopen: index << 8 | subindex.
struct StartupStep {
  std::uint32_t reg = 0;
  double expected = 0.0;
  bool answered = true;  ///< false: no reply exists; the next step shows if it arrived
};
enum class Answer : std::uint8_t {
  kNone,
  kRight,
  kNotYet,  ///< wrong, but it may still become right: request again
  kWrong,
  kRefused,  ///< `found` is the drive's reason
  kMissing,  ///< the drive has no such thing, and need not: a warning, and the next step
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

  /// Whether the frame comes from this drive, whatever its content.
  virtual bool is_mine(const CanFrame& frame) const noexcept = 0;
  /// True of frames that this drive sends without a request, or late, and that need not be decoded.
  virtual bool is_unsolicited(const CanFrame& frame) const noexcept {
    static_cast<void>(frame);
    return false;
  }
  /// Keeps what an unsolicited frame tells.
  virtual void note_unsolicited(const CanFrame& frame) noexcept { static_cast<void>(frame); }
  /// Code of the error that the drive announced last and has not taken back; 0: none. Of families
  /// that announce errors. Allowed in every thread.
  virtual std::uint16_t emergency() const noexcept { return 0; }
  /// Whether a frame of somebody else commands this drive or writes its settings: sent by anybody
  /// but this driver, it must not go unnoticed.
  virtual bool is_foreign_command(const CanFrame& frame) const noexcept = 0;
  /// A frame of somebody else on the bus: what he asks of this drive is not for this driver.
  virtual void note_foreign(const CanFrame& frame) noexcept { static_cast<void>(frame); }
  /// True if the frame answers what note_foreign() has seen, once for each.
  virtual bool answers_foreign(const CanFrame& frame) noexcept {
    static_cast<void>(frame);
    return false;
  }
  /// All identifiers of is_mine() and is_foreign_command(). Allocates: set-up only.
  virtual std::vector<CanFilter> receive_filters() const = 0;
  /// Whether the frame answers presence_request().
  virtual bool is_presence(const CanFrame& frame) const noexcept { return is_mine(frame); }
  /// Whether the frame answers presence_request() as this drive would, but with an identifier that
  /// is not its own: a setting of the drive that is easily forgotten.
  virtual bool is_astray(const CanFrame& frame) const noexcept {
    static_cast<void>(frame);
    return false;
  }
  /// Start of a cycle: what comes from here on answers it, or, `late`, the one before.
  virtual void begin_cycle() noexcept {}
  /// kNone: the frame is no state of this drive, or a part that came already. `report` is set when
  /// the state is whole.
  [[nodiscard]] virtual StateReading read_state(const CanFrame& frame, bool late,
                                                DriveReport* report) noexcept = 0;
  /// DriveReport::status in words. Allocates: for messages, outside the cycle.
  virtual std::string status_text(std::uint16_t status) const;
  /// Smallest difference between two angles in its replies, rad.
  virtual double angle_resolution() const noexcept = 0;

  // --- the start-up dialogue, in this order ---------------------------------------------------

  /// It begins with disable(). False if a drive that was not started yet does not answer that: it
  /// is then tried, and the steps repeat it.
  virtual bool disable_is_answered() const noexcept { return true; }
  /// Cycles that an answer may take before the request is repeated.
  virtual int patience_cycles() const noexcept { return 1; }
  virtual int startup_steps() const noexcept = 0;
  virtual StartupStep startup_step(int index) const noexcept = 0;
  virtual CanFrame startup_request(int index) const noexcept = 0;
  /// Whether the step reads a setting that must stay as it is, and that the drive tells while it is
  /// on, one frame for one. Its answer is no reply to a command.
  virtual bool may_be_read_again(int index) const noexcept {
    static_cast<void>(index);
    return false;
  }
  /// The frame as an answer to step `index`; `found` is set unless kNone.
  virtual Answer check_answer(int index, const CanFrame& frame, double* found) noexcept = 0;
  /// In words: "register 23 is 10, expected 28"; kMissing: what that means. Allocates: for
  /// messages, outside the cycle.
  virtual std::string describe(const StartupFailure& failure) const;
};

/// The family that the joint's drive belongs to. `fd`: its bus carries FD frames; `period_s`: of
/// the commands. Set-up only.
std::unique_ptr<DriveFamily> make_drive_family(const JointConfig& joint, bool fd, double period_s);

}  // namespace limber
