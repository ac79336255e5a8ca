// Commands and states of RobStride drives.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "drivers/families/robstride_family.h"
#include "drivers/protocols/robstride.h"

namespace limber {
namespace {

using robstride::Type;

constexpr unsigned kModeShift = 8;  // of DriveReport::status, above the faults
constexpr std::uint32_t kMotorBits = 0xFF00;

class RobstrideCodec final : public DriveCodec {
 public:
  explicit RobstrideCodec(const JointConfig& joint)
      : drive_(joint.drive),
        number_(robstride_number(joint.drive)),
        most_torque_(std::floor(std::min(joint.torque_limit_Nm, drive_.range.torque_Nm) /
                                robstride::torque_count_Nm(drive_.range)) *
                     robstride::torque_count_Nm(drive_.range)) {}

  bool command(const DriveCommand& command, const DriveMemory& /*memory*/, CanFrame* frame,
               DriveCommand* sent) noexcept override {
    if (!all_finite(command)) return false;
    robstride::Command decoded;
    if (!robstride::encode_command(
            {command.angle_rad, command.speed_rad_per_s, command.kp_Nm_per_rad,
             command.kd_Nms_per_rad, std::clamp(command.torque_Nm, -most_torque_, most_torque_)},
            drive_.range, number_, frame) ||
        !robstride::decode_command(*frame, drive_.range, &decoded))
      return false;
    *sent = {decoded.position_rad, decoded.velocity_rad_per_s, decoded.kp_Nm_per_rad,
             decoded.kd_Nms_per_rad, decoded.torque_Nm};
    return true;
  }
  CanFrame disable() noexcept override { return robstride::request(Type::kStop, number_); }
  CanFrame clear_error() noexcept override {
    reported_.store(0, std::memory_order_relaxed);
    return robstride::encode_clear(number_);
  }
  CanFrame enable(const DriveMemory& /*memory*/) noexcept override {
    return robstride::request(Type::kEnable, number_);
  }
  /// A command without torque and gains: a stopped drive answers and does nothing.
  CanFrame state_request() const noexcept override {
    CanFrame frame;
    static_cast<void>(robstride::encode_command({}, drive_.range, number_, &frame));
    return frame;
  }

  bool is_mine(const CanFrame& frame) const noexcept override {
    robstride::Id id{};
    return robstride::split(frame, &id) && id.target > robstride::kLastMotor &&
           static_cast<std::uint8_t>(id.data) == number_;
  }
  /// Half a count is added to the fields, because drives truncate.
  StateReading read_state(const CanFrame& frame, bool late, DriveReport* report) noexcept override;
  /// A report of the state, or of a fault.
  bool is_unsolicited(const CanFrame& frame) const noexcept override {
    robstride::Id id{};
    return is_mine(frame) && robstride::split(frame, &id) &&
           (id.type == Type::kReport || id.type == Type::kFault);
  }
  void record_unsolicited(const CanFrame& frame) noexcept override;
  std::uint16_t emergency() const noexcept override {
    return reported_.load(std::memory_order_relaxed);
  }
  std::string emergency_text(std::uint16_t code) const override;
  std::string status_text(std::uint16_t status) const override;
  double angle_resolution() const noexcept override {
    return 2.0 * half(drive_.range.position_rad);
  }
  /// Whatever goes to the motor, and whatever comes from it.
  std::vector<CanFilter> receive_filters() const override {
    return {{number_, 0xFF, true}, {static_cast<std::uint32_t>(number_) << 8U, kMotorBits, true}};
  }

 private:
  static double half(double range) noexcept { return 0.5 * range / 32767.0; }

  DriveConfig drive_;
  std::uint8_t number_;
  double most_torque_;  ///< N m: the last count below the limit
  /// One more than the lowest bit of the last fault frame; 0: none. Read by the reporter's thread.
  std::atomic<std::uint16_t> reported_ = 0;
};

StateReading RobstrideCodec::read_state(const CanFrame& frame, bool /*late*/,
                                        DriveReport* report) noexcept {
  const CommandRange& range = drive_.range;
  robstride::Id id{};
  robstride::State state;
  if (!is_mine(frame) || !robstride::split(frame, &id) || id.type != Type::kState ||
      !robstride::decode_state(frame, range, &state))
    return StateReading::kNone;
  report->condition = state.faults != 0                     ? DriveCondition::kFailed
                      : state.mode == robstride::Mode::kRun ? DriveCondition::kEnabled
                                                            : DriveCondition::kDisabled;
  report->status =
      static_cast<std::uint16_t>(static_cast<unsigned>(state.mode) << kModeShift | state.faults);
  report->angle_rad = report->link_angle_rad = state.position_rad + half(range.position_rad);
  report->speed_rad_per_s = report->link_speed_rad_per_s =
      state.velocity_rad_per_s + half(range.velocity_rad_per_s);
  report->torque_Nm = state.torque_Nm + half(range.torque_Nm);
  report->current_A = report->torque_Nm / drive_.torque_constant_Nm_per_A;
  report->temperature_degC = state.temperature_degC;
  return StateReading::kWhole;
}

void RobstrideCodec::record_unsolicited(const CanFrame& frame) noexcept {
  robstride::FaultReport report;
  if (!robstride::decode_fault(frame, &report)) return;
  int bit = 0;
  while (bit < 32 && (report.faults >> static_cast<unsigned>(bit) & 1U) == 0) ++bit;
  reported_.store(static_cast<std::uint16_t>(bit < 32 ? bit + 1 : 0), std::memory_order_relaxed);
}

std::string RobstrideCodec::emergency_text(std::uint16_t code) const {
  const std::string text = robstride::reported_fault_text(code - 1);
  return fmt::format("fault {}: {}", code - 1, text.empty() ? "not in the manual" : text);
}

std::string RobstrideCodec::status_text(std::uint16_t status) const {
  const std::string text = robstride::faults_text(static_cast<std::uint8_t>(status));
  if (!text.empty()) return text;
  switch (static_cast<robstride::Mode>(status >> kModeShift)) {
    case robstride::Mode::kReset:
      return "stopped, without a fault";
    case robstride::Mode::kCalibration:
      return "calibrating";
    case robstride::Mode::kRun:
      return "running";
  }
  return fmt::format("mode {}", status >> kModeShift);
}

}  // namespace

std::unique_ptr<DriveCodec> robstride_codec(const JointConfig& joint) {
  return std::make_unique<RobstrideCodec>(joint);
}

}  // namespace limber
