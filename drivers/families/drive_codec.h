// Commands to, and states from, one motor drive as bytes: one class a family, one object a drive.
// Angles, speeds and torques are the drive's own, in rad, rad/s and N m at the joint, before the
// joint's sign and offset.
//
// After construction every member is free of allocation, locks, logs and exceptions, unless it is
// said to be for set-up or messages.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "drivers/can/can_filter.h"
#include "drivers/can/can_frame.h"

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

class DriveCodec {
 public:
  virtual ~DriveCodec() = default;

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
  /// Frames that ask for the parts of the state, behind each cycle's frame; none: that one asks for
  /// all. Valid as long as the codec.
  virtual std::span<const CanFrame> part_requests() const noexcept { return {}; }
  /// True if the drives of this family take effect and answer at a frame of their own: the driver
  /// sends `bus_frame` once a cycle on their bus, after all commands, and it is their request of
  /// state.
  virtual bool needs_bus_frame(CanFrame* bus_frame) const noexcept {
    static_cast<void>(bus_frame);
    return false;
  }

  // --- from the drive -------------------------------------------------------------------------

  /// Start of a cycle: what comes from here on answers it, or, `late`, the one before.
  virtual void begin_cycle() noexcept {}
  /// Whether the frame comes from this drive, whatever its content.
  virtual bool is_mine(const CanFrame& frame) const noexcept = 0;
  /// kNone: the frame is no state of this drive, or a part that came already. `report` is set when
  /// the state is whole.
  [[nodiscard]] virtual StateReading read_state(const CanFrame& frame, bool late,
                                                DriveReport* report) noexcept = 0;
  /// True of frames that this drive sends without a request, or late, and that need not be decoded.
  virtual bool is_unsolicited(const CanFrame& frame) const noexcept {
    static_cast<void>(frame);
    return false;
  }
  /// Keeps the content of an unsolicited frame.
  virtual void record_unsolicited(const CanFrame& frame) noexcept { static_cast<void>(frame); }
  /// Code of the error that the drive announced last and has not taken back; 0: none. Of families
  /// that announce errors. Allowed in every thread.
  virtual std::uint16_t emergency() const noexcept { return 0; }
  /// Its meaning. Allocates: for messages, outside the cycle.
  virtual std::string emergency_text(std::uint16_t code) const;
  /// DriveReport::status in words. Allocates: for messages, outside the cycle.
  virtual std::string status_text(std::uint16_t status) const;
  /// Smallest difference between two angles in its replies, rad.
  virtual double angle_resolution() const noexcept = 0;
  /// All identifiers of is_mine() and of IntruderRules. Allocates: set-up only.
  virtual std::vector<CanFilter> receive_filters() const = 0;
};

}  // namespace limber
