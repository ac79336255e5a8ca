// One motor's end of the bus: frames out, replies in; the drive's sign and zero are applied here
// and nowhere else.
//
//   theta = sign * (drive angle - offset) + 2 pi turns     speed and torque likewise by sign
//   q     = the link encoder's angle, which counts as the joint does: its sign, its zero
//
// Allowed inside the cycle: everything but the constructor.
#pragma once

#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "drivers/can/can_frame.h"
#include "drivers/drive/whole_turns.h"
#include "drivers/families/drive_family.h"
#include "robots/loader/robot.h"

namespace limber {

/// A drive's command in joint coordinates: tau_drive = kp (theta - theta_drive) - kd
/// theta_dot_drive + tau.
struct JointCommand {
  double theta = 0.0;  ///< rad
  double kp = 0.0;     ///< N m/rad
  double kd = 0.0;     ///< N m s/rad
  double tau = 0.0;    ///< N m
};

class JointLink {
 public:
  JointLink(const JointConfig& joint, bool fd, double period_s, int bridged_cycles);

  // --- towards the drive; each call makes the frame of this cycle -----------------------------

  /// Torque only: kp = kd = 0. The position field carries the angle measured last, so that no frame
  /// commands a motion, whatever becomes of its gain fields.
  CanFrame torque(double tau) noexcept;

  /// What is not finite is not sent: the frame is then a state request.
  CanFrame command(const JointCommand& command) noexcept;

  CanFrame disable() noexcept;
  CanFrame clear_error() noexcept;
  CanFrame enable() noexcept;
  CanFrame state_request() noexcept;

  // --- from the drive -------------------------------------------------------------------------

  bool needs_bus_frame(CanFrame* frame) const noexcept {
    return family_.codec->needs_bus_frame(frame);
  }
  bool is_mine(const CanFrame& frame) const noexcept { return family_.codec->is_mine(frame); }
  /// Somebody else's frame that commands this drive or writes its settings.
  bool is_foreign_command(const CanFrame& frame) const noexcept {
    return family_.intruders->is_foreign_command(frame);
  }
  /// See IntruderRules, likewise the next.
  void record_foreign(const CanFrame& frame) noexcept { family_.intruders->record_foreign(frame); }
  bool answers_foreign(const CanFrame& frame) noexcept {
    return family_.intruders->answers_foreign(frame);
  }
  /// See DriveCodec. Allocates: set-up only.
  std::vector<CanFilter> receive_filters() const { return family_.codec->receive_filters(); }
  /// True if the frame is from this drive, but no reply to a command, and nothing that must be
  /// understood; what it tells is kept.
  bool take_unsolicited(const CanFrame& frame) noexcept {
    if (!family_.codec->is_unsolicited(frame)) return false;
    family_.codec->record_unsolicited(frame);
    return true;
  }
  /// Stores a state reply; fresh() when all parts of it are there. False, and nothing stored: not
  /// one, another motor's number, a second one
  /// in this cycle, or an angle that motor or link cannot have reached since the last one
  /// (1.5 velocity_limit T for each cycle since, at most as many as are bridged and one, plus two
  /// counts; a motor of two may turn and wind at once: twice that). `age_cycles`: of the command
  /// that it answers; one as young that is there already stays.
  bool receive(const CanFrame& frame, std::int32_t age_cycles = 0) noexcept;

  /// Start of a cycle: no reply yet, one cycle more since the last.
  void begin_cycle() noexcept;
  /// The drive may have been anywhere since: the next angle is taken as it comes, and its whole
  /// turns (whole_turns.h) are found again.
  void forget_angle() noexcept { angle_known_ = false; }
  /// While the joint is given up, an angle that it cannot have reached is stored, too, after more
  /// cycles without a valid one than are bridged, so that it can be acknowledged; jumped() tells of
  /// it until clear_jump().
  void take_jumps(bool take) noexcept { takes_jumps_ = take; }
  bool jumped() const noexcept { return jumped_; }
  void clear_jump() noexcept { jumped_ = false; }

  // --- measured -------------------------------------------------------------------------------

  bool fresh() const noexcept { return age_cycles_ == 0; }  ///< answered in this cycle
  /// Cycles since the last valid reply; kNever before the first.
  std::int32_t age_cycles() const noexcept { return age_cycles_; }
  static constexpr std::int32_t kNever = INT32_MAX;

  /// What is added to what the drive reads. Not known: the joint must not be enabled.
  WholeTurns turns() const noexcept { return turns_; }
  double theta() const noexcept { return angle(seen_); }                        ///< rad
  double theta_dot() const noexcept { return sign() * seen_.speed_rad_per_s; }  ///< rad/s
  /// The link's, rad and rad/s; the motor's without a link encoder.
  double q() const noexcept { return has_link_encoder() ? seen_.link_angle_rad : theta(); }
  double v() const noexcept {
    return has_link_encoder() ? seen_.link_speed_rad_per_s : theta_dot();
  }
  /// N m, sensed on the link if there is a torque sensor, else the drive's own estimate.
  double tau() const noexcept { return sign() * seen_.torque_Nm; }
  /// N m: the torque of this cycle's command as the drive computes it; 0 without command, or if
  /// not enabled.
  double tau_applied() const noexcept;
  double current_A() const noexcept { return sign() * seen_.current_A; }
  double temperature_degC() const noexcept { return seen_.temperature_degC; }
  bool enabled() const noexcept { return seen_.condition == DriveCondition::kEnabled; }
  bool drive_error() const noexcept { return seen_.condition == DriveCondition::kFailed; }
  /// Enabled, but it does not execute its target.
  bool ignores_target() const noexcept { return enabled() && !seen_.follows; }
  /// The drive's own warning.
  bool warns() const noexcept { return seen_.warns; }
  /// Code of an error that the drive has announced; 0: none.
  std::uint16_t emergency() const noexcept { return family_.codec->emergency(); }
  /// Its meaning. Allocates: for messages.
  std::string emergency_text(std::uint16_t code) const {
    return family_.codec->emergency_text(code);
  }
  double angle_resolution() const noexcept { return 0.5 * jump_resolution_; }
  /// Of the last report, in the drive's own numbers.
  std::uint16_t status() const noexcept { return seen_.status; }
  /// The same in words. Allocates: for messages.
  std::string status_text(std::uint16_t status) const { return family_.codec->status_text(status); }
  const JointConfig& joint() const noexcept { return joint_; }
  const DriveFamily& family() const noexcept { return family_; }
  std::string describe(const StartupFailure& failure) const {
    return family_.startup->describe(failure);
  }

 private:
  double sign() const noexcept { return joint_.drive.sign; }
  double angle(const DriveReport& report) const noexcept {
    return sign() * (report.angle_rad - joint_.drive.offset_rad) + kTurn_rad * turns_.turns;
  }
  double drive_angle(double theta) const noexcept {
    return sign() * (theta - kTurn_rad * turns_.turns) + joint_.drive.offset_rad;
  }
  bool has_link_encoder() const noexcept { return joint_.link_encoder.present; }
  bool plausible(const DriveReport& report) const noexcept;
  DriveMemory memory() const noexcept { return {seen_, age_cycles_ < longest_gap_}; }

  static constexpr double kTurn_rad = 2.0 * std::numbers::pi;

  JointConfig joint_;
  DriveFamily family_;
  int longest_gap_;              ///< cycles
  double jump_per_cycle_;        ///< rad, of the motor
  double link_jump_per_cycle_;   ///< rad
  double jump_resolution_;       ///< rad, of the motor
  double link_jump_resolution_;  ///< rad
  DriveCommand sent_;            ///< as the drive understands it
  bool commanded_ = false;       ///< this cycle's frame is a command, not a request

  std::int32_t age_cycles_ = kNever;
  bool angle_known_ = false;
  bool takes_jumps_ = false;
  bool jumped_ = false;
  WholeTurns turns_;
  DriveReport seen_;  ///< the last one stored, in the drive's own coordinates
};

}  // namespace limber
