#include "drivers/protocols/mit.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace limber::mit {
namespace {

constexpr int kPositionBits = 16;
constexpr int kBits = 12;  // velocity, kp, kd, torque

// Damping counts with which a command saturated in position, velocity and stiffness would begin
// with six bytes FF, and the first one below.
constexpr std::uint32_t kFirstSpecialDamping = 0xFF0;

constexpr std::uint32_t top_count(int bits) noexcept { return (1U << bits) - 1U; }

/// `counts` is where a value lies on its field's scale. Written so that NaN gives 0: a cast of NaN
/// would be undefined.
std::uint32_t quantise(double counts, int bits, Quantiser quantiser) noexcept {
  const std::uint32_t top = top_count(bits);
  if (!(counts > 0.0)) return 0;
  if (!(counts < top)) return top;
  return static_cast<std::uint32_t>(quantiser == Quantiser::kRound ? counts + 0.5 : counts);
}

/// Fields from -range to range.
std::uint32_t symmetric(double value, double range, int bits, Quantiser quantiser) noexcept {
  return quantise((value + range) * top_count(bits) / (2.0 * range), bits, quantiser);
}
/// Fields from 0 to range.
std::uint32_t one_sided(double value, double range, int bits, Quantiser quantiser) noexcept {
  return quantise(value * top_count(bits) / range, bits, quantiser);
}
/// In this form the count below the middle is exactly minus half a count.
double from_symmetric(std::uint32_t count, double range, int bits) noexcept {
  const double top = top_count(bits);
  return (2.0 * count - top) * range / top;
}
double from_one_sided(std::uint32_t count, double range, int bits) noexcept {
  return count * range / top_count(bits);
}

CanFrame empty_frame(std::uint32_t id, bool fd) noexcept {
  CanFrame frame;
  frame.id = id;
  frame.extended = id > kStandardIdMax;
  frame.fd = fd;
  frame.bitrate_switch = fd;
  frame.length = 8;
  return frame;
}

bool is_plain(const CanFrame& frame) noexcept { return !frame.remote && !frame.error; }

constexpr std::uint8_t low_byte(std::uint32_t value) noexcept {
  return static_cast<std::uint8_t>(value);
}

CanFrame register_frame(std::uint16_t id, std::uint8_t operation, std::uint8_t reg,
                        std::uint32_t value, std::uint32_t frame_id, bool fd) noexcept {
  CanFrame frame = empty_frame(frame_id, fd);
  frame.data[0] = low_byte(id);
  frame.data[1] = low_byte(id >> 8U);
  frame.data[2] = operation;
  frame.data[3] = reg;
  for (unsigned i = 0; i < 4; ++i) frame.data[4 + i] = low_byte(value >> (8 * i));
  return frame;
}

std::uint32_t register_value(const CanFrame& frame) noexcept {
  std::uint32_t value = 0;
  for (unsigned i = 0; i < 4; ++i)
    value |= static_cast<std::uint32_t>(frame.data[4 + i]) << (8 * i);
  return value;
}

bool is_usable(double range) noexcept { return range > 0.0 && std::isfinite(range); }

}  // namespace

bool all_finite(const Command& command) noexcept {
  return std::isfinite(command.position_rad) && std::isfinite(command.velocity_rad_per_s) &&
         std::isfinite(command.kp_Nm_per_rad) && std::isfinite(command.kd_Nms_per_rad) &&
         std::isfinite(command.torque_Nm);
}

bool is_usable(const CommandRange& range) noexcept {
  return is_usable(range.position_rad) && is_usable(range.velocity_rad_per_s) &&
         is_usable(range.torque_Nm) && is_usable(range.kp_Nm_per_rad) &&
         is_usable(range.kd_Nms_per_rad);
}

const char* error_text(DriveError error) noexcept {
  switch (error) {
    case DriveError::kDisabled:
      return "disabled";
    case DriveError::kEnabled:
      return "enabled";
    case DriveError::kOverVoltage:
      return "over-voltage";
    case DriveError::kUnderVoltage:
      return "under-voltage";
    case DriveError::kOverCurrent:
      return "over-current";
    case DriveError::kMosOverTemperature:
      return "power stage too hot";
    case DriveError::kRotorOverTemperature:
      return "motor too hot";
    case DriveError::kCommunicationLost:
      return "no command within the drive's time-out";
    case DriveError::kOverload:
      return "overload";
  }
  return "";
}

double half_count(double range, int bits) noexcept { return range / top_count(bits); }

bool encode_command(const Command& command, const CommandRange& range, std::uint32_t id, bool fd,
                    Quantiser quantiser, CanFrame* frame) noexcept {
  if (!all_finite(command) || !is_usable(range)) return false;
  const std::uint32_t p =
      symmetric(command.position_rad, range.position_rad, kPositionBits, quantiser);
  const std::uint32_t v =
      symmetric(command.velocity_rad_per_s, range.velocity_rad_per_s, kBits, quantiser);
  const std::uint32_t kp = one_sided(command.kp_Nm_per_rad, range.kp_Nm_per_rad, kBits, quantiser);
  std::uint32_t kd = one_sided(command.kd_Nms_per_rad, range.kd_Nms_per_rad, kBits, quantiser);
  const std::uint32_t t = symmetric(command.torque_Nm, range.torque_Nm, kBits, quantiser);
  if (p == top_count(kPositionBits) && (v & kp) == top_count(kBits) && kd >= kFirstSpecialDamping)
    kd = kFirstSpecialDamping - 1;

  *frame = empty_frame(id, fd);
  frame->data[0] = low_byte(p >> 8U);
  frame->data[1] = low_byte(p);
  frame->data[2] = low_byte(v >> 4U);
  frame->data[3] = low_byte((v & 0xFU) << 4U | kp >> 8U);
  frame->data[4] = low_byte(kp);
  frame->data[5] = low_byte(kd >> 4U);
  frame->data[6] = low_byte((kd & 0xFU) << 4U | t >> 8U);
  frame->data[7] = low_byte(t);
  return true;
}

CanFrame encode_special(Special special, std::uint32_t id, bool fd) noexcept {
  CanFrame frame = empty_frame(id, fd);
  std::fill_n(frame.data.begin(), 7, std::uint8_t{0xFF});
  frame.data[7] = static_cast<std::uint8_t>(special);
  return frame;
}

CanFrame encode_register_read(std::uint16_t id, Register reg, bool fd) noexcept {
  return register_frame(id, kReadRegister, static_cast<std::uint8_t>(reg), 0, kRegisterId, fd);
}

CanFrame encode_register_write(std::uint16_t id, Register reg, std::uint32_t raw_value,
                               bool fd) noexcept {
  return register_frame(id, kWriteRegister, static_cast<std::uint8_t>(reg), raw_value, kRegisterId,
                        fd);
}

CanFrame encode_register_store(std::uint16_t id, bool fd) noexcept {
  return register_frame(id, kStoreRegister, 1, 0, kRegisterId, fd);
}

CanFrame encode_state_request(std::uint16_t id, bool fd) noexcept {
  return register_frame(id, kStateRequest, 0, 0, kRegisterId, fd);
}

bool decode_reply(const CanFrame& frame, const CommandRange& range, Reply* reply) noexcept {
  if (!is_plain(frame) || frame.length != 8) return false;
  const auto& d = frame.data;
  const std::uint32_t p = static_cast<std::uint32_t>(d[1]) << 8U | d[2];
  const std::uint32_t v = static_cast<std::uint32_t>(d[3]) << 4U | d[4] >> 4U;
  const std::uint32_t t = (d[4] & 0xFU) << 8U | d[5];
  reply->id_nibble = d[0] & 0xFU;
  reply->error = static_cast<DriveError>(d[0] >> 4U);
  reply->position_rad = from_symmetric(p, range.position_rad, kPositionBits);
  reply->velocity_rad_per_s = from_symmetric(v, range.velocity_rad_per_s, kBits);
  reply->torque_Nm = from_symmetric(t, range.torque_Nm, kBits);
  reply->mos_temperature_degC = d[6];
  reply->rotor_temperature_degC = d[7];
  return true;
}

bool decode_register(const CanFrame& frame, std::uint16_t id, std::uint8_t operation, Register reg,
                     std::uint32_t* raw_value) noexcept {
  if (!is_plain(frame) || frame.length != 8) return false;
  const auto& d = frame.data;
  if (operation != kReadRegister && operation != kWriteRegister) return false;
  if ((d[0] | d[1] << 8U) != id || d[2] != operation || d[3] != static_cast<std::uint8_t>(reg))
    return false;
  *raw_value = register_value(frame);
  return true;
}

bool decode_special(const CanFrame& frame, Special* special) noexcept {
  if (!is_plain(frame) || frame.length != 8) return false;
  if (!std::all_of(frame.data.begin(), frame.data.begin() + 7,
                   [](std::uint8_t b) { return b == 0xFF; }))
    return false;
  switch (const auto candidate = static_cast<Special>(frame.data[7])) {
    case Special::kEnable:
    case Special::kDisable:
    case Special::kSetZero:
    case Special::kClearError:
      *special = candidate;
      return true;
  }
  return false;
}

bool decode_command(const CanFrame& frame, const CommandRange& range, Command* command) noexcept {
  Special special{};
  if (!is_plain(frame) || frame.length != 8 || decode_special(frame, &special)) return false;
  const auto& d = frame.data;
  const std::uint32_t p = static_cast<std::uint32_t>(d[0]) << 8U | d[1];
  const std::uint32_t v = static_cast<std::uint32_t>(d[2]) << 4U | d[3] >> 4U;
  const std::uint32_t kp = (d[3] & 0xFU) << 8U | d[4];
  const std::uint32_t kd = static_cast<std::uint32_t>(d[5]) << 4U | d[6] >> 4U;
  const std::uint32_t t = (d[6] & 0xFU) << 8U | d[7];
  command->position_rad = from_symmetric(p, range.position_rad, kPositionBits);
  command->velocity_rad_per_s = from_symmetric(v, range.velocity_rad_per_s, kBits);
  command->kp_Nm_per_rad = from_one_sided(kp, range.kp_Nm_per_rad, kBits);
  command->kd_Nms_per_rad = from_one_sided(kd, range.kd_Nms_per_rad, kBits);
  command->torque_Nm = from_symmetric(t, range.torque_Nm, kBits);
  return true;
}

bool decode_servo_command(const CanFrame& frame, ControlMode mode, ServoCommand* command) noexcept {
  constexpr double kVelocityCount = 0.01;
  constexpr double kTorqueCount = 1e-4;
  const bool velocity_only = mode == ControlMode::kVelocity;
  if (!is_plain(frame) || mode == ControlMode::kMit || frame.length < (velocity_only ? 4 : 8))
    return false;
  const auto& d = frame.data;
  const auto word = [&d](std::size_t at) {
    return static_cast<std::uint32_t>(d[at] | d[at + 1] << 8U);
  };
  const auto number = [&word](std::size_t at) {
    return static_cast<double>(bits_float(word(at) | word(at + 2) << 16U));
  };
  ServoCommand out;
  if (velocity_only) {
    out.velocity_rad_per_s = number(0);
  } else {
    out.position_rad = number(0);
    out.velocity_rad_per_s =
        mode == ControlMode::kForcePosition ? kVelocityCount * word(4) : number(4);
    if (mode == ControlMode::kForcePosition)
      out.torque_share = std::min(1.0, kTorqueCount * word(6));
    if (!(out.velocity_rad_per_s >= 0.0)) return false;
  }
  if (!std::isfinite(out.position_rad) || !std::isfinite(out.velocity_rad_per_s)) return false;
  *command = out;
  return true;
}

bool decode_register_request(const CanFrame& frame, RegisterRequest* request) noexcept {
  if (!is_plain(frame) || frame.extended || frame.id != kRegisterId || frame.length < 4)
    return false;
  const std::uint8_t operation = frame.data[2];
  const bool known = operation == kReadRegister || operation == kWriteRegister ||
                     operation == kStoreRegister || operation == kStateRequest;
  if (!known || (operation == kWriteRegister && frame.length != 8)) return false;
  request->id = static_cast<std::uint16_t>(frame.data[0] | frame.data[1] << 8U);
  request->operation = operation;
  request->reg = frame.data[3];
  request->raw_value = frame.length == 8 ? register_value(frame) : 0;
  return true;
}

CanFrame encode_reply(const Reply& reply, const CommandRange& range, std::uint32_t reply_id,
                      bool fd, Quantiser quantiser) noexcept {
  const std::uint32_t p =
      symmetric(reply.position_rad, range.position_rad, kPositionBits, quantiser);
  const std::uint32_t v =
      symmetric(reply.velocity_rad_per_s, range.velocity_rad_per_s, kBits, quantiser);
  const std::uint32_t t = symmetric(reply.torque_Nm, range.torque_Nm, kBits, quantiser);
  CanFrame frame = empty_frame(reply_id, fd);
  frame.data[0] =
      low_byte(static_cast<std::uint32_t>(reply.error) << 4U | (reply.id_nibble & 0xFU));
  frame.data[1] = low_byte(p >> 8U);
  frame.data[2] = low_byte(p);
  frame.data[3] = low_byte(v >> 4U);
  frame.data[4] = low_byte((v & 0xFU) << 4U | t >> 8U);
  frame.data[5] = low_byte(t);
  frame.data[6] = static_cast<std::uint8_t>(std::clamp(reply.mos_temperature_degC, 0, 255));
  frame.data[7] = static_cast<std::uint8_t>(std::clamp(reply.rotor_temperature_degC, 0, 255));
  return frame;
}

CanFrame encode_register_answer(const RegisterRequest& request, std::uint32_t raw_value,
                                std::uint32_t reply_id, bool fd) noexcept {
  return register_frame(request.id, request.operation, request.reg, raw_value, reply_id, fd);
}

std::uint32_t float_bits(float value) noexcept { return std::bit_cast<std::uint32_t>(value); }
float bits_float(std::uint32_t raw) noexcept { return std::bit_cast<float>(raw); }

}  // namespace limber::mit
