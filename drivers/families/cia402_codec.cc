// Commands and states of CiA 402 drives.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "drivers/families/cia402_family.h"
#include "drivers/families/cia402_state.h"
#include "drivers/protocols/cia402_pdos.h"

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

class Cia402Codec final : public DriveCodec {
 public:
  Cia402Codec(const JointConfig& joint, bool fd);

  /// The drive has no gains: tau = kp (angle - angle seen) + kd (speed - speed seen) + torque is
  /// computed here, a cycle late, and is `torque` alone if the drive was not seen of late. The
  /// rounding error of the torque, up to half a thousandth of the rated one, is added to the next.
  bool command(const DriveCommand& command, const DriveMemory& memory, CanFrame* frame,
               DriveCommand* sent) noexcept override;
  CanFrame disable() noexcept override { return without_torque(cia402::kDisableVoltage); }
  CanFrame clear_error() noexcept override {
    emergency_.store(0, std::memory_order_relaxed);  // not every drive takes it back
    return without_torque(cia402::kFaultReset);
  }
  /// Through ready to switch on and switched on, one state a confirmed step.
  CanFrame enable(const DriveMemory& memory) noexcept override;
  CanFrame state_request() const noexcept override { return canopen::encode_sync(); }
  bool needs_bus_frame(CanFrame* bus_frame) const noexcept override {
    *bus_frame = canopen::encode_sync();
    return true;
  }

  void begin_cycle() noexcept override {
    last_state_ = state_;
    state_.begin();
  }
  /// TPDOs, SDO answers, emergencies, boot-up and heartbeat of the node.
  bool is_mine(const CanFrame& frame) const noexcept override;
  /// All of them but the TPDOs that make the state.
  bool is_unsolicited(const CanFrame& frame) const noexcept override;
  /// Keeps the code of an emergency until the drive takes it back.
  void record_unsolicited(const CanFrame& frame) noexcept override;
  std::uint16_t emergency() const noexcept override {
    return emergency_.load(std::memory_order_relaxed);
  }
  StateReading read_state(const CanFrame& frame, bool late, DriveReport* report) noexcept override;
  std::string emergency_text(std::uint16_t code) const override {
    return fmt::format("emergency {:04X}h: {}", code, canopen::emergency_text(code));
  }
  std::string status_text(std::uint16_t status) const override;
  double angle_resolution() const noexcept override { return rad_per_count_; }
  /// Every identifier of a node ends in its number.
  std::vector<CanFilter> receive_filters() const override {
    constexpr std::uint32_t kNumber = 0x7F;
    return {{node(), kNumber, false}, exactly(canopen::kSyncId), exactly(canopen::kNmtId)};
  }

 private:
  std::uint8_t node() const noexcept { return canopen::node_of(drive_.command_id); }
  CanFrame without_torque(std::uint16_t controlword) noexcept;

  DriveConfig drive_;
  bool fd_;
  bool link_encoder_;
  bool torque_sensor_;
  double rad_per_count_;
  double link_rad_per_count_;
  double rated_current_A_;
  double most_torque_;                        ///< N m: whole thousandths within the joint's limit
  double carry_ = 0.0;                        ///< rounding error not sent yet, N m
  Cia402State state_;                         ///< of this cycle
  Cia402State last_state_;                    ///< of the one before: the rest of it may come late
  std::atomic<std::uint16_t> emergency_ = 0;  ///< read by the thread that logs
};

Cia402Codec::Cia402Codec(const JointConfig& joint, bool fd)
    : drive_(joint.drive),
      fd_(fd),
      link_encoder_(joint.link_encoder.present),
      torque_sensor_(joint.torque_sensor.present),
      rad_per_count_(2.0 * std::numbers::pi / joint.drive.counts_per_turn),
      link_rad_per_count_(std::ldexp(2.0 * std::numbers::pi, -joint.link_encoder.bits)),
      rated_current_A_(joint.drive.rated_torque_Nm / joint.drive.torque_constant_Nm_per_A),
      most_torque_(cia402::most_permille(joint) * drive_.rated_torque_Nm / 1000.0),
      state_(cia402::layout_of(joint, fd), node()),
      last_state_(state_) {}

bool Cia402Codec::command(const DriveCommand& command, const DriveMemory& memory, CanFrame* frame,
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

CanFrame Cia402Codec::without_torque(std::uint16_t controlword) noexcept {
  carry_ = 0.0;
  return cia402::encode_command({controlword, 0}, drive_.command_id, fd_);
}

CanFrame Cia402Codec::enable(const DriveMemory& memory) noexcept {
  return without_torque(cia402::towards_enabled(cia402::state_of(memory.seen.status)));
}

bool Cia402Codec::is_mine(const CanFrame& frame) const noexcept {
  return state_.is_part(frame) || is_unsolicited(frame);
}

bool Cia402Codec::is_unsolicited(const CanFrame& frame) const noexcept {
  // Before the start-up has switched them off, a drive may send more TPDOs than are used.
  for (int k = state_.tpdos(); k < canopen::kPdos; ++k) {
    if (has_id(frame, canopen::tpdo_id(k, node()))) return true;
  }
  return has_id(frame, canopen::kSdoAnswerCode + node()) ||
         has_id(frame, canopen::kEmergencyCode + node()) ||
         has_id(frame, canopen::kHeartbeatCode + node());
}

void Cia402Codec::record_unsolicited(const CanFrame& frame) noexcept {
  canopen::Emergency emergency;
  if (canopen::decode_emergency(frame, node(), &emergency))
    emergency_.store(emergency.code, std::memory_order_relaxed);
}

StateReading Cia402Codec::read_state(const CanFrame& frame, bool late,
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

std::string Cia402Codec::status_text(std::uint16_t status) const {
  std::string text =
      fmt::format("{} (statusword {:04X}h)", cia402::name_of(cia402::state_of(status)), status);
  if (ignores_target(status))
    text += ", but ignores its target (bit 12 is 0): halt, another mode, or a limit";
  if (const std::uint16_t code = emergency(); code != 0) text += ", " + emergency_text(code);
  return text;
}

}  // namespace

std::unique_ptr<DriveCodec> cia402_codec(const JointConfig& joint, bool fd) {
  return std::make_unique<Cia402Codec>(joint, fd);
}

}  // namespace limber
