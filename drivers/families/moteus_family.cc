#include "drivers/families/moteus_family.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

#include "robots/loader/protocols/drive_protocol.h"

namespace limber {
namespace {

using moteus::Mode;
using moteus::Register;

constexpr double kTurn = 2.0 * std::numbers::pi;  // rad
constexpr double kHomedRotor = 1.0;
constexpr double kHomedOutput = 2.0;

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

}  // namespace

MoteusFamily::MoteusFamily(const JointConfig& joint)
    : drive_(joint.drive),
      torque_limit_(std::min(joint.torque_limit_Nm, joint.drive.range.torque_Nm)) {}

bool MoteusFamily::command(const DriveCommand& command, const DriveMemory& /*memory*/,
                           CanFrame* frame, DriveCommand* sent) noexcept {
  if (!all_finite(command)) return false;
  const CommandRange& range = drive_.range;
  const double kd_scale = std::clamp(command.kd_Nms_per_rad / range.kd_Nms_per_rad, 0.0, 1.0);
  const double kp_scale = std::clamp(command.kp_Nm_per_rad / range.kp_Nm_per_rad, kd_scale, 1.0);
  *sent = {command.angle_rad, command.speed_rad_per_s, kp_scale * range.kp_Nm_per_rad,
           kd_scale * range.kd_Nms_per_rad,
           std::clamp(command.torque_Nm, -torque_limit_, torque_limit_)};
  moteus::Command out;
  out.position_turns =
      kp_scale > 0.0 ? command.angle_rad / kTurn : std::numeric_limits<double>::quiet_NaN();
  out.velocity_turns_per_s = command.speed_rad_per_s / kTurn;
  out.torque_Nm = sent->torque_Nm;
  out.kp_scale = kp_scale;
  out.kd_scale = kd_scale;
  out.max_torque_Nm = torque_limit_;
  out.watchdog_s = drive_.watchdog_s;
  *frame = moteus::encode_command(out, drive_.command_id);
  return true;
}

CanFrame MoteusFamily::enable(const DriveMemory& memory) noexcept {
  CanFrame frame;
  DriveCommand sent;
  const DriveCommand nothing{memory.seen.angle_rad, 0.0, 0.0, 0.0, 0.0};
  return command(nothing, memory, &frame, &sent) ? frame : state_request();
}

bool MoteusFamily::is_order(const CanFrame& frame) const noexcept {
  // Bits 16 to 28 are the prefix, which must be the drive's; a reply is for host 0.
  const bool prefix = frame.id >> 16U == drive_.command_id >> 16U;
  return !frame.error && prefix && accepts_id(drive_, frame.id);
}

// The last seven bits are the number of whom a frame is for, 7Fh all; its prefix is the drive's.
std::vector<CanFilter> MoteusFamily::heard() const {
  constexpr std::uint32_t kNumber = 0x7F;
  constexpr std::uint32_t kPrefix = 0x1FFF0000;
  std::vector<CanFilter> filters = {exactly(drive_.reply_id)};
  for (std::uint32_t number : {drive_.command_id & kNumber, kNumber}) {
    filters.push_back({number, kNumber, false});
    filters.push_back({(drive_.command_id & kPrefix) | number, kPrefix | kNumber, true});
  }
  return filters;
}

StateReading MoteusFamily::read_state(const CanFrame& frame, bool /*late*/,
                                      DriveReport* report) noexcept {
  moteus::State state;
  if (!moteus::decode_state(frame, &state)) return StateReading::kNone;
  report->condition = condition_of(state.mode);
  report->status =
      static_cast<std::uint16_t>(static_cast<int>(state.mode) | (state.fault & 0xFF) << 8);
  report->angle_rad = report->link_angle_rad = state.position_turns * kTurn;
  report->speed_rad_per_s = report->link_speed_rad_per_s = state.velocity_turns_per_s * kTurn;
  report->torque_Nm = state.torque_Nm;
  report->current_A = state.current_q_A;
  report->temperature_degC = state.temperature_degC;
  return StateReading::kWhole;
}

std::string MoteusFamily::status_text(std::uint16_t status) const {
  const int mode = status & 0xFF;
  const int fault = status >> 8;
  if (mode == static_cast<int>(moteus::Mode::kTimeout))
    return "mode 11: no command within the drive's time-out";
  if (fault == 0) return fmt::format("mode {}", mode);
  const std::string_view text = moteus::fault_text(fault);
  return fmt::format("mode {}, fault {}: {}", mode, fault,
                     text.empty() ? "see the maker's list" : text);
}

double MoteusFamily::angle_resolution() const noexcept {
  const double encoder = kTurn / drive_.counts_per_turn;
  return std::max(encoder, kTurn * static_cast<double>(std::numeric_limits<float>::epsilon()));
}

StartupStep MoteusFamily::startup_step(int index) const noexcept {
  if (index == 0)
    return {static_cast<std::uint32_t>(Register::kRegisterMap), moteus::kRegisterMapVersion};
  // Behind a gear, a drive that has only its rotor's angle may be off by a rotor turn.
  return {static_cast<std::uint32_t>(Register::kHomeState),
          drive_.gear_ratio == 1.0 ? kHomedRotor : kHomedOutput};
}

CanFrame MoteusFamily::startup_request(int index) const noexcept {
  return moteus::encode_read(static_cast<Register>(startup_step(index).reg), drive_.command_id);
}

Answer MoteusFamily::check_answer(int index, const CanFrame& frame, double* found) noexcept {
  const StartupStep step = startup_step(index);
  if (!moteus::decode_register(frame, static_cast<Register>(step.reg), found)) return Answer::kNone;
  const bool right =
      index == 0 ? *found == step.expected : *found >= step.expected && *found <= kHomedOutput;
  return right ? Answer::kRight : Answer::kWrong;
}

}  // namespace limber
