// Commands and states of CubeMars drives. No state tells whether a drive is on: the codec keeps
// what it was told, and takes one that was reset for off by its torque, which stays at zero.
#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "drivers/families/cubemars_family.h"
#include "drivers/families/mit_commands.h"
#include "drivers/protocols/cubemars.h"

namespace limber {
namespace {

class CubemarsCodec final : public DriveCodec {
 public:
  explicit CubemarsCodec(const JointConfig& joint)
      : drive_(joint.drive),
        v3_(drive_.board == cubemars::kV3),
        torque_count_Nm_(2.0 * mit::half_count(drive_.range.torque_Nm, kOtherBits)),
        commands_(joint, drive_.command_id, false) {}

  /// A V3 obeys without having been enabled.
  bool command(const DriveCommand& command, const DriveMemory& /*memory*/, CanFrame* frame,
               DriveCommand* sent) noexcept override {
    if (!commands_.encode(command, frame, sent)) return false;
    if (v3_) *frame = cubemars::gains_first(*frame);
    on_ = on_ || v3_;
    sent_ = *sent;
    return true;
  }
  CanFrame disable() noexcept override { return switched(false); }
  /// Nothing clears an error: it goes with its cause.
  CanFrame clear_error() noexcept override { return switched(false); }
  CanFrame enable(const DriveMemory& /*memory*/) noexcept override { return switched(true); }
  /// Nothing but commands is answered: one that leaves the drive as it is.
  CanFrame state_request() const noexcept override {
    return on_ ? cubemars::on_frame(drive_) : cubemars::off_frame(drive_);
  }

  void begin_cycle() noexcept override { was_on_ = on_; }
  bool is_mine(const CanFrame& frame) const noexcept override {
    return cubemars::is_from(frame, drive_);
  }
  /// Half a count is added to the fields of a V1 or V2, because it truncates.
  StateReading read_state(const CanFrame& frame, bool late, DriveReport* report) noexcept override;
  std::string status_text(std::uint16_t status) const override;
  double angle_resolution() const noexcept override {
    return v3_ ? cubemars::kAngleCount_rad
               : 2.0 * mit::half_count(drive_.range.position_rad, kAngleBits);
  }
  std::vector<CanFilter> receive_filters() const override {
    const std::uint32_t number = cubemars::number_of(drive_);
    const CanFilter packets{number, 0x1FFFF0FF, true};  // from 0 to F
    return {exactly(drive_.reply_id), v3_ ? packets : exactly(drive_.command_id),
            exactly(cubemars::kState | number)};
  }

 private:
  static constexpr int kAngleBits = 16;
  static constexpr int kOtherBits = 12;
  // Of torque: what a drive may read that makes none, and what is clearly more.
  static constexpr int kIdleReplies = 10;
  static constexpr double kIdleCounts = 2.0;
  static constexpr double kClearCounts = 20.0;
  // Of DriveReport::status, beside the error.
  static constexpr std::uint16_t kRuns = 0x100;
  static constexpr std::uint16_t kLetGo = 0x200;

  CanFrame switched(bool on) noexcept {
    commands_.start_afresh();
    on_ = on;
    let_go_ = false;
    sent_ = {};
    return state_request();
  }
  bool makes_no_torque(const DriveReport& report) noexcept;

  DriveConfig drive_;
  bool v3_;
  double torque_count_Nm_;
  MitCommands commands_;
  DriveCommand sent_;
  bool on_ = false;
  bool was_on_ = false;  ///< at the end of the cycle before
  bool let_go_ = false;
  int idle_replies_ = 0;
};

/// In so many replies in a row, although it was commanded.
bool CubemarsCodec::makes_no_torque(const DriveReport& report) noexcept {
  const double wanted_Nm = sent_.kp_Nm_per_rad * (sent_.angle_rad - report.angle_rad) +
                           sent_.kd_Nms_per_rad * (sent_.speed_rad_per_s - report.speed_rad_per_s) +
                           sent_.torque_Nm;
  const bool idle = on_ && std::abs(report.torque_Nm) < kIdleCounts * torque_count_Nm_ &&
                    std::abs(wanted_Nm) > kClearCounts * torque_count_Nm_;
  idle_replies_ = idle ? idle_replies_ + 1 : 0;
  return idle_replies_ >= kIdleReplies;
}

StateReading CubemarsCodec::read_state(const CanFrame& frame, bool late,
                                       DriveReport* report) noexcept {
  cubemars::State state;
  if (!cubemars::decode_state(frame, drive_, &state)) return StateReading::kNone;
  const double half = v3_ ? 0.0 : 1.0;
  report->angle_rad = report->link_angle_rad =
      state.position_rad + half * mit::half_count(drive_.range.position_rad, kAngleBits);
  report->speed_rad_per_s = report->link_speed_rad_per_s =
      state.velocity_rad_per_s +
      half * mit::half_count(drive_.range.velocity_rad_per_s, kOtherBits);
  report->torque_Nm = state.torque_Nm + half * mit::half_count(drive_.range.torque_Nm, kOtherBits);
  report->current_A = report->torque_Nm / drive_.torque_constant_Nm_per_A;
  report->temperature_degC = state.temperature_degC;
  let_go_ = let_go_ || makes_no_torque(*report);
  const bool failed = state.error != 0 || let_go_;
  on_ = on_ && !failed;
  const bool on = on_ && (was_on_ || !late);
  report->condition = failed ? DriveCondition::kFailed
                      : on   ? DriveCondition::kEnabled
                             : DriveCondition::kDisabled;
  report->status =
      static_cast<std::uint16_t>(state.error | (let_go_ ? kLetGo : 0) | (on ? kRuns : 0));
  return StateReading::kWhole;
}

std::string CubemarsCodec::status_text(std::uint16_t status) const {
  if (const auto error = static_cast<std::uint8_t>(status); error != 0) {
    const std::string_view text = cubemars::error_text(error, drive_.board);
    return fmt::format("error {}: {}", error, text.empty() ? "not in the manual" : text);
  }
  if ((status & kLetGo) != 0) return "makes no torque: switched off or reset; its zero may be lost";
  return (status & kRuns) != 0 ? "enabled" : "disabled, without an error";
}

}  // namespace

std::unique_ptr<DriveCodec> cubemars_codec(const JointConfig& joint) {
  return std::make_unique<CubemarsCodec>(joint);
}

}  // namespace limber
