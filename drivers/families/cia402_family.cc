#include "drivers/families/cia402_family.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limber {
namespace {

DriveCondition condition_of(cia402::State state) noexcept {
  switch (state) {
    case cia402::State::kOperationEnabled:
      return DriveCondition::kEnabled;
    case cia402::State::kQuickStopActive:
    case cia402::State::kFaultReactionActive:
    case cia402::State::kFault:
      return DriveCondition::kFailed;
    case cia402::State::kNotReady:
    case cia402::State::kSwitchOnDisabled:
    case cia402::State::kReadyToSwitchOn:
    case cia402::State::kSwitchedOn:
      break;
  }
  return DriveCondition::kDisabled;
}

bool ignores_target(std::uint16_t status) noexcept {
  return cia402::state_of(status) == cia402::State::kOperationEnabled &&
         (status & cia402::kFollowing) == 0;
}

}  // namespace

Cia402Family::Cia402Family(const JointConfig& joint, bool fd, double period_s)
    : drive_(joint.drive),
      fd_(fd),
      link_encoder_(joint.link_encoder.present),
      torque_sensor_(joint.torque_sensor.present),
      rad_per_count_(2.0 * std::numbers::pi / joint.drive.counts_per_turn),
      link_rad_per_count_(std::ldexp(2.0 * std::numbers::pi, -joint.link_encoder.bits)),
      rated_current_A_(joint.drive.rated_torque_Nm / joint.drive.torque_constant_Nm_per_A),
      most_torque_(most_permille(joint) * drive_.rated_torque_Nm / 1000.0),
      state_(cia402::layout_of(joint, fd), node()),
      last_state_(state_),
      startup_(joint, cia402::layout_of(joint, fd), period_s) {}

// --- towards the drive ---------------------------------------------------------------------------

bool Cia402Family::command(const DriveCommand& command, const DriveMemory& memory, CanFrame* frame,
                           DriveCommand* sent) noexcept {
  const DriveReport& seen = memory.seen;
  double tau = command.torque_Nm + carry_;
  carry_ = 0.0;
  if (memory.recent) {
    tau += command.kp_Nm_per_rad * (command.angle_rad - seen.angle_rad) +
           command.kd_Nms_per_rad * (command.speed_rad_per_s - seen.speed_rad_per_s);
  }
  if (!all_finite(command) || !std::isfinite(tau)) return false;
  const double wanted = std::clamp(tau, -most_torque_, most_torque_);
  const std::int16_t permille = cia402::to_permille(wanted, drive_.rated_torque_Nm);
  const std::uint16_t controlword = cia402::towards_enabled(cia402::state_of(seen.status));
  *frame = cia402::encode_command({controlword, permille}, drive_.command_id, fd_);
  *sent = {command.angle_rad, command.speed_rad_per_s, 0.0, 0.0,
           cia402::from_permille(permille, drive_.rated_torque_Nm)};
  carry_ = wanted - sent->torque_Nm;
  return true;
}

CanFrame Cia402Family::without_torque(std::uint16_t controlword) noexcept {
  carry_ = 0.0;
  return cia402::encode_command({controlword, 0}, drive_.command_id, fd_);
}

CanFrame Cia402Family::enable(const DriveMemory& memory) noexcept {
  return without_torque(cia402::towards_enabled(cia402::state_of(memory.seen.status)));
}

CanFrame Cia402Family::presence_request() const noexcept {
  return canopen::encode_sdo_read(canopen::kDeviceType.id, node());
}

// --- from the drive ------------------------------------------------------------------------------

bool Cia402Family::is_mine(const CanFrame& frame) const noexcept {
  return state_.is_part(frame) || is_unsolicited(frame);
}

bool Cia402Family::is_unsolicited(const CanFrame& frame) const noexcept {
  // Before the start-up has switched them off, a drive may send more TPDOs than are used.
  for (int k = state_.tpdos(); k < canopen::kPdos; ++k) {
    if (has_id(frame, canopen::tpdo_id(k, node()))) return true;
  }
  return has_id(frame, canopen::kSdoAnswerCode + node()) ||
         has_id(frame, canopen::kEmergencyCode + node()) ||
         has_id(frame, canopen::kHeartbeatCode + node());
}

void Cia402Family::note_unsolicited(const CanFrame& frame) noexcept {
  canopen::Emergency emergency;
  if (canopen::decode_emergency(frame, node(), &emergency))
    emergency_.store(emergency.code, std::memory_order_relaxed);
}

bool Cia402Family::is_foreign_command(const CanFrame& frame) const noexcept {
  if (has_id(frame, canopen::kSyncId)) return true;
  canopen::NmtCommand command;
  if (canopen::decode_nmt(frame, node(), &command)) return true;
  for (std::uint32_t k = 0; k < canopen::kPdos; ++k) {
    if (has_id(frame, canopen::kRpdo1Code + k * canopen::kPdoStep + node())) return true;
  }
  return has_id(frame, canopen::kSdoRequestCode + node()) && canopen::is_sdo_write(frame);
}

// Every identifier of a node ends in its number.
std::vector<CanFilter> Cia402Family::receive_filters() const {
  constexpr std::uint32_t kNumber = 0x7F;
  return {{node(), kNumber, false}, exactly(canopen::kSyncId), exactly(canopen::kNmtId)};
}

bool Cia402Family::is_presence(const CanFrame& frame) const noexcept {
  canopen::SdoMessage answer;
  return canopen::decode_sdo_answer(frame, node(), &answer) &&
         answer.object == canopen::kDeviceType.id;
}

StateReading Cia402Family::read_state(const CanFrame& frame, bool late,
                                      DriveReport* report) noexcept {
  Cia402State& parts = late ? last_state_ : state_;
  const StateReading reading = parts.take(frame);
  if (reading != StateReading::kWhole) return reading;
  const cia402::DriveState& state = parts.values();
  report->condition = condition_of(cia402::state_of(state.statusword));
  report->status = state.statusword;
  report->follows = (state.statusword & cia402::kFollowing) != 0;
  report->warns = (state.statusword & cia402::kWarning) != 0;
  report->angle_rad = state.position_counts * rad_per_count_;
  report->speed_rad_per_s = state.velocity_counts_per_s * rad_per_count_;
  report->link_angle_rad =
      link_encoder_ ? state.link_position_counts * link_rad_per_count_ : report->angle_rad;
  report->link_speed_rad_per_s = link_encoder_
                                     ? state.link_velocity_counts_per_s * link_rad_per_count_
                                     : report->speed_rad_per_s;
  report->torque_Nm = cia402::from_permille(state.torque_permille, drive_.rated_torque_Nm);
  report->current_A = fd_ || torque_sensor_
                          ? cia402::from_permille(state.current_permille, rated_current_A_)
                          : report->torque_Nm / drive_.torque_constant_Nm_per_A;
  return reading;
}

std::string Cia402Family::status_text(std::uint16_t status) const {
  std::string text =
      fmt::format("{} (statusword {:04X}h)", cia402::name_of(cia402::state_of(status)), status);
  if (ignores_target(status))
    text += ", but ignores its target (bit 12 is 0): halt, another mode, or a limit";
  if (const std::uint16_t code = emergency(); code != 0)
    text += fmt::format(", emergency {:04X}h: {}", code, canopen::emergency_text(code));
  return text;
}

/// Only a node that is operational sends PDOs.
Answer Cia402Family::check_answer(int index, const CanFrame& frame, double* found) noexcept {
  if (!startup_.is_start(index)) return startup_.check_answer(index, frame, found);
  *found = 0.0;
  switch (state_.take(frame)) {
    case StateReading::kWhole:
      return Answer::kRight;
    case StateReading::kPart:
      return Answer::kNotYet;
    case StateReading::kNone:
      break;
  }
  return Answer::kNone;
}

}  // namespace limber
