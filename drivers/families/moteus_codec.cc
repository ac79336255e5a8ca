// Commands and states of moteus drives.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "drivers/families/moteus_family.h"
#include "drivers/protocols/moteus.h"

namespace limber {
namespace {

using moteus::kTurn_rad;
using moteus::Mode;

DriveCondition condition_of(Mode mode) noexcept {
  switch (mode) {
    case Mode::kPosition:
      return DriveCondition::kEnabled;
    case Mode::kStopped:
    case Mode::kEnabling:
    case Mode::kCalibrating:
    case Mode::kCalibrationComplete:
      return DriveCondition::kDisabled;
    default:  // faults, time-out, and modes that somebody else has chosen
      return DriveCondition::kFailed;
  }
}

class MoteusCodec final : public DriveCodec {
 public:
  explicit MoteusCodec(const JointConfig& joint)
      : drive_(joint.drive),
        torque_limit_(std::min(joint.torque_limit_Nm, joint.drive.range.torque_Nm)) {}

  /// Position mode with scaled gains; without stiffness the position goes as NaN, and torque alone
  /// with both scales zero. The scales are independent of each other: the manual's limit of the one
  /// by the other is not in the firmware.
  bool command(const DriveCommand& command, const DriveMemory& memory, CanFrame* frame,
               DriveCommand* sent) noexcept override;
  CanFrame disable() noexcept override { return moteus::encode_stop(drive_.command_id); }
  CanFrame clear_error() noexcept override { return disable(); }
  /// A command enables the drive, on its way through modes 2 to 4.
  CanFrame enable(const DriveMemory& memory) noexcept override;
  CanFrame state_request() const noexcept override {
    return moteus::encode_state_request(drive_.command_id);
  }

  bool is_mine(const CanFrame& frame) const noexcept override {
    return has_id(frame, drive_.reply_id);
  }
  StateReading read_state(const CanFrame& frame, bool late, DriveReport* report) noexcept override;
  std::string status_text(std::uint16_t status) const override;
  double angle_resolution() const noexcept override;
  std::vector<CanFilter> receive_filters() const override;

 private:
  DriveConfig drive_;
  double torque_limit_;  ///< N m
};

bool MoteusCodec::command(const DriveCommand& command, const DriveMemory& /*memory*/,
                          CanFrame* frame, DriveCommand* sent) noexcept {
  if (!all_finite(command)) return false;
  const CommandRange& range = drive_.range;
  const double kd_scale = std::clamp(command.kd_Nms_per_rad / range.kd_Nms_per_rad, 0.0, 1.0);
  const double kp_scale = std::clamp(command.kp_Nm_per_rad / range.kp_Nm_per_rad, 0.0, 1.0);
  *sent = {command.angle_rad, command.speed_rad_per_s, kp_scale * range.kp_Nm_per_rad,
           kd_scale * range.kd_Nms_per_rad,
           std::clamp(command.torque_Nm, -torque_limit_, torque_limit_)};
  moteus::Command out;
  out.position_turns =
      kp_scale > 0.0 ? command.angle_rad / kTurn_rad : std::numeric_limits<double>::quiet_NaN();
  out.velocity_turns_per_s = command.speed_rad_per_s / kTurn_rad;
  out.torque_Nm = sent->torque_Nm;
  out.kp_scale = kp_scale;
  out.kd_scale = kd_scale;
  out.max_torque_Nm = torque_limit_;
  out.watchdog_s = drive_.watchdog_s;
  *frame = moteus::encode_command(out, drive_.command_id);
  return true;
}

CanFrame MoteusCodec::enable(const DriveMemory& memory) noexcept {
  CanFrame frame;
  DriveCommand sent;
  const DriveCommand nothing{memory.seen.angle_rad, 0.0, 0.0, 0.0, 0.0};
  return command(nothing, memory, &frame, &sent) ? frame : state_request();
}

// The last seven bits are the number of the receiver, 7Fh all; its prefix is the drive's.
std::vector<CanFilter> MoteusCodec::receive_filters() const {
  constexpr std::uint32_t kNumber = 0x7F;
  constexpr std::uint32_t kPrefix = 0x1FFF0000;
  std::vector<CanFilter> filters = {exactly(drive_.reply_id)};
  for (std::uint32_t number : {drive_.command_id & kNumber, kNumber}) {
    filters.push_back({number, kNumber, false});
    filters.push_back({(drive_.command_id & kPrefix) | number, kPrefix | kNumber, true});
  }
  return filters;
}

StateReading MoteusCodec::read_state(const CanFrame& frame, bool /*late*/,
                                     DriveReport* report) noexcept {
  moteus::State state;
  if (!moteus::decode_state(frame, &state)) return StateReading::kNone;
  report->condition = condition_of(state.mode);
  report->status =
      static_cast<std::uint16_t>(static_cast<int>(state.mode) | (state.fault & 0xFF) << 8);
  report->angle_rad = report->link_angle_rad = state.position_turns * kTurn_rad;
  report->speed_rad_per_s = report->link_speed_rad_per_s = state.velocity_turns_per_s * kTurn_rad;
  report->torque_Nm = state.torque_Nm;
  report->current_A = state.current_q_A;
  report->temperature_degC = state.temperature_degC;
  return StateReading::kWhole;
}

std::string MoteusCodec::status_text(std::uint16_t status) const {
  const int mode = status & 0xFF;
  const int fault = status >> 8;
  if (mode == static_cast<int>(moteus::Mode::kTimeout))
    return "mode 11: no command within the drive's time-out";
  if (fault == 0) return fmt::format("mode {}: {}", mode, moteus::mode_text(mode));
  const std::string_view text = moteus::fault_text(fault);
  return fmt::format("mode {}, fault {}: {}", mode, fault,
                     text.empty() ? "see the maker's list" : text);
}

double MoteusCodec::angle_resolution() const noexcept {
  const double encoder = kTurn_rad / drive_.counts_per_turn;
  return std::max(encoder, kTurn_rad * static_cast<double>(std::numeric_limits<float>::epsilon()));
}

}  // namespace

std::unique_ptr<DriveCodec> moteus_codec(const JointConfig& joint) {
  return std::make_unique<MoteusCodec>(joint);
}

}  // namespace limber
