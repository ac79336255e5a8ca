#include "drivers/families/damiao_family.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

namespace limber {
namespace {

constexpr int kPositionBits = 16;
constexpr int kBits = 12;
constexpr std::uint8_t kRead = 0x33;
constexpr std::uint8_t kWrite = 0x55;
constexpr std::uint8_t kStore = 0xAA;
constexpr std::uint32_t kModeMit = 1;
constexpr int kForeignCycles = 100;
constexpr double kTolerance = 1e-4;  // float32 against what people write: 12.566 for 4 pi

std::uint32_t as_float(double value) noexcept { return mit::float_bits(static_cast<float>(value)); }

bool is_float(mit::Register reg) noexcept {
  return reg == mit::Register::kOverTemperature || reg == mit::Register::kPositionRange ||
         reg == mit::Register::kVelocityRange || reg == mit::Register::kTorqueRange;
}

double value_of(mit::Register reg, std::uint32_t raw) noexcept {
  return is_float(reg) ? static_cast<double>(mit::bits_float(raw)) : static_cast<double>(raw);
}

DriveCondition condition_of(mit::DriveError status) noexcept {
  switch (status) {
    case mit::DriveError::kEnabled:
      return DriveCondition::kEnabled;
    case mit::DriveError::kDisabled:
      return DriveCondition::kDisabled;
    default:
      return DriveCondition::kFailed;
  }
}

const char* remedy(mit::DriveError error) noexcept {
  switch (error) {
    case mit::DriveError::kOverVoltage:
    case mit::DriveError::kUnderVoltage:
      return "; check the supply";
    case mit::DriveError::kMosOverTemperature:
    case mit::DriveError::kRotorOverTemperature:
      return "; let it cool";
    default:
      return "";
  }
}

}  // namespace

DamiaoFamily::DamiaoFamily(const JointConfig& joint, bool fd) : drive_(joint.drive), fd_(fd) {
  using mit::Register;
  const CommandRange& range = drive_.range;
  most_torque_ = std::max(
      std::min(joint.torque_limit_Nm, range.torque_Nm) - mit::half_count(range.torque_Nm, kBits),
      0.0);
  const auto timeout =
      static_cast<std::uint32_t>(std::lround(drive_.watchdog_s / mit::kTimeoutCount_s));
  steps_ = {{
      {Kind::kCompareRange, Register::kPositionRange, as_float(range.position_rad)},
      {Kind::kCompareRange, Register::kVelocityRange, as_float(range.velocity_rad_per_s)},
      {Kind::kCompareRange, Register::kTorqueRange, as_float(range.torque_Nm)},
      {Kind::kWrite, Register::kControlMode, kModeMit},
      {Kind::kReadBack, Register::kControlMode, kModeMit},
      {Kind::kWrite, Register::kTimeout, timeout},
      {Kind::kReadBack, Register::kTimeout, timeout},
      {Kind::kCompareAbove, Register::kOverTemperature, as_float(drive_.limit_temperature_degC)},
  }};
}

bool DamiaoFamily::command(const DriveCommand& command, const DriveMemory& /*memory*/,
                           CanFrame* frame, DriveCommand* sent) noexcept {
  const double tau = command.torque_Nm + carry_;
  const double wanted = std::isfinite(tau) ? std::clamp(tau, -most_torque_, most_torque_) : tau;
  mit::Command decoded;
  if (!mit::encode_command({command.angle_rad, command.speed_rad_per_s, command.kp_Nm_per_rad,
                            command.kd_Nms_per_rad, wanted},
                           drive_.range, drive_.command_id, fd_, mit::Quantiser::kRound, frame) ||
      !mit::decode_command(*frame, drive_.range, &decoded)) {
    carry_ = 0.0;
    return false;
  }
  carry_ = wanted - decoded.torque_Nm;
  *sent = {decoded.position_rad, decoded.velocity_rad_per_s, decoded.kp_Nm_per_rad,
           decoded.kd_Nms_per_rad, decoded.torque_Nm};
  return true;
}

CanFrame DamiaoFamily::special(mit::Special special) noexcept {
  carry_ = 0.0;
  return mit::encode_special(special, drive_.command_id, fd_);
}

CanFrame DamiaoFamily::state_request() const noexcept {
  return mit::encode_state_request(id(), fd_);
}

CanFrame DamiaoFamily::presence_request() const noexcept {
  return mit::encode_register_read(id(), mit::Register::kControlMode, fd_);
}

bool DamiaoFamily::is_foreign_command(const CanFrame& frame) const noexcept {
  if (has_id(frame, drive_.command_id)) return true;
  mit::RegisterRequest request;
  return mit::decode_register_request(frame, &request) && request.id == id() &&
         (request.operation == kWrite || request.operation == kStore);
}

void DamiaoFamily::note_foreign(const CanFrame& frame) noexcept {
  mit::RegisterRequest request;
  if (!mit::decode_register_request(frame, &request) || request.id != id()) return;
  if (request.operation != kRead && request.operation != kWrite) return;
  foreign_[next_foreign_++ % foreign_.size()] = {request.operation, request.reg, kForeignCycles};
}

bool DamiaoFamily::answers_foreign(const CanFrame& frame) noexcept {
  std::uint32_t raw = 0;
  const auto asked = std::ranges::find_if(foreign_, [&](const ForeignRequest& request) {
    return request.cycles_left > 0 &&
           mit::decode_register(frame, id(), request.operation,
                                static_cast<mit::Register>(request.reg), &raw);
  });
  if (asked == foreign_.end()) return false;
  asked->cycles_left = 0;
  return true;
}

void DamiaoFamily::begin_cycle() noexcept {
  for (ForeignRequest& request : foreign_)
    request.cycles_left = std::max(0, request.cycles_left - 1);
}

std::vector<CanFilter> DamiaoFamily::receive_filters() const {
  return {exactly(drive_.reply_id), exactly(drive_.command_id), exactly(mit::kRegisterId)};
}

bool DamiaoFamily::is_astray(const CanFrame& frame) const noexcept {
  std::uint32_t mode = 0;
  return !is_mine(frame) && !frame.extended && frame.id != mit::kRegisterId &&
         mit::decode_register(frame, id(), kRead, mit::Register::kControlMode, &mode);
}

StateReading DamiaoFamily::read_state(const CanFrame& frame, bool /*late*/,
                                      DriveReport* report) noexcept {
  const CommandRange& range = drive_.range;
  mit::Reply reply;
  if (!mit::decode_reply(frame, range, &reply)) return StateReading::kNone;
  if (reply.id_nibble != (drive_.command_id & 0xF)) return StateReading::kNone;
  report->condition = condition_of(reply.error);
  report->status = static_cast<std::uint16_t>(reply.error);
  report->angle_rad = reply.position_rad + mit::half_count(range.position_rad, kPositionBits);
  report->speed_rad_per_s =
      reply.velocity_rad_per_s + mit::half_count(range.velocity_rad_per_s, kBits);
  report->link_angle_rad = report->angle_rad;
  report->link_speed_rad_per_s = report->speed_rad_per_s;
  report->torque_Nm = reply.torque_Nm + mit::half_count(range.torque_Nm, kBits);
  report->current_A = report->torque_Nm / drive_.torque_constant_Nm_per_A;
  report->temperature_degC = std::max(reply.mos_temperature_degC, reply.rotor_temperature_degC);
  return StateReading::kWhole;
}

std::string DamiaoFamily::status_text(std::uint16_t status) const {
  const auto error = static_cast<mit::DriveError>(status);
  if (error == mit::DriveError::kDisabled) return "disabled, without an error";
  if (error == mit::DriveError::kEnabled) return "enabled";
  const std::string_view text = mit::error_text(error);
  return fmt::format("error {:X}: {}{}", status, text.empty() ? "not in the manual" : text,
                     remedy(error));
}

double DamiaoFamily::angle_resolution() const noexcept {
  return 2.0 * mit::half_count(drive_.range.position_rad, kPositionBits);
}

int DamiaoFamily::startup_steps() const noexcept {
  return std::isfinite(drive_.limit_temperature_degC) ? kSteps : kSteps - 1;
}

StartupStep DamiaoFamily::startup_step(int index) const noexcept {
  const Step& step = steps_[static_cast<std::size_t>(index)];
  return {static_cast<std::uint32_t>(step.reg), value_of(step.reg, step.raw)};
}

CanFrame DamiaoFamily::startup_request(int index) const noexcept {
  const Step& step = steps_[static_cast<std::size_t>(index)];
  return step.kind == Kind::kWrite ? mit::encode_register_write(id(), step.reg, step.raw, fd_)
                                   : mit::encode_register_read(id(), step.reg, fd_);
}

Answer DamiaoFamily::check_answer(int index, const CanFrame& frame, double* found) noexcept {
  const Step& step = steps_[static_cast<std::size_t>(index)];
  std::uint32_t raw = 0;
  const std::uint8_t operation = step.kind == Kind::kWrite ? kWrite : kRead;
  if (!mit::decode_register(frame, id(), operation, step.reg, &raw)) return Answer::kNone;
  *found = value_of(step.reg, raw);
  const double expected = value_of(step.reg, step.raw);
  bool right = raw == step.raw;
  if (step.kind == Kind::kCompareRange)
    right = std::abs(*found - expected) <= kTolerance * expected;
  if (step.kind == Kind::kCompareAbove) right = *found > expected;
  return right ? Answer::kRight : Answer::kWrong;
}

std::string DamiaoFamily::describe(const StartupFailure& failure) const {
  const bool heat = failure.reg == static_cast<std::uint32_t>(mit::Register::kOverTemperature);
  if (!heat || failure.answer != Answer::kWrong) return DriveFamily::describe(failure);
  return fmt::format(
      "register 2 (over-temperature) is {:g}, expected more than {:g}: the drive "
      "would let go before limit_temperature_degC stops the arm",
      failure.found, failure.expected);
}

}  // namespace limber
