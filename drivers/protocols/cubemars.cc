#include "drivers/protocols/cubemars.h"

#include <algorithm>
#include <array>

namespace limber::cubemars {
namespace {

constexpr double kCurrent_A = 0.01;

std::uint64_t bits_of(const CanFrame& frame) noexcept {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < 8; ++i) bits = bits << 8U | frame.data[i];
  return bits;
}
CanFrame with_bits(CanFrame frame, std::uint64_t bits) noexcept {
  for (std::size_t i = 8; i-- > 0; bits >>= 8U) frame.data[i] = static_cast<std::uint8_t>(bits);
  return frame;
}

double speed_count(const DriveConfig& drive) noexcept {
  return kSpeedCount_rad_per_s / (drive.pole_pairs * drive.gear_ratio);
}
/// Written so that NaN gives the lowest count.
void put(double counts, std::size_t at, CanFrame* frame) noexcept {
  const int count = counts > -32768.0 ? static_cast<int>(std::min(counts, 32767.0)) : -32768;
  frame->data[at] = static_cast<std::uint8_t>(count >> 8);
  frame->data[at + 1] = static_cast<std::uint8_t>(count);
}
double word(const CanFrame& frame, std::size_t at) noexcept {
  return static_cast<std::int16_t>(frame.data[at] << 8U | frame.data[at + 1]);
}

int reply_bytes(const DriveConfig& drive) noexcept { return drive.board == kV1 ? 6 : 8; }

}  // namespace

bool is_to(const CanFrame& frame, const DriveConfig& drive) noexcept {
  if (drive.board != kV3) return has_id(frame, drive.command_id);
  return frame.extended && !frame.error && frame.id <= drive.command_id &&
         (frame.id & 0xFFU) == number_of(drive);
}

bool is_servo_state(const CanFrame& frame, const DriveConfig& drive) noexcept {
  return drive.board != kV3 && has_id(frame, kState | number_of(drive));
}

bool is_from(const CanFrame& frame, const DriveConfig& drive) noexcept {
  const bool named = drive.board == kV3 || frame.data[0] == number_of(drive);
  return (named && has_id(frame, drive.reply_id)) || is_servo_state(frame, drive);
}

// Position and velocity, the gains, and torque have 28, 24 and 12 bits.
CanFrame gains_first(const CanFrame& command) noexcept {
  const std::uint64_t bits = bits_of(command);
  std::uint64_t moved = (bits & 0xF'FFFF'F000) << 28U | bits >> 36U << 12U | (bits & 0xFFF);
  if (moved >> 16U == 0xFFFF'FFFF'FFFF) moved -= 1ULL << 40U;  // a count of damping less
  return with_bits(command, moved);
}

bool decode_command(const CanFrame& frame, const DriveConfig& drive,
                    mit::Command* command) noexcept {
  if (!has_id(frame, drive.command_id) || frame.fd) return false;
  const std::uint64_t bits = bits_of(frame);
  const std::uint64_t moved = (bits & 0xFF'FFFF'F000) << 24U | bits >> 40U << 12U | (bits & 0xFFF);
  return mit::decode_command(drive.board == kV3 ? with_bits(frame, moved) : frame, drive.range,
                             command);
}

CanFrame on_frame(const DriveConfig& drive) noexcept {
  CanFrame frame = mit::encode_special(mit::Special::kEnable, drive.command_id, false);
  const bool v3 = drive.board == kV3 && mit::encode_command({}, drive.range, drive.command_id,
                                                            false, mit::Quantiser::kRound, &frame);
  return v3 ? gains_first(frame) : frame;
}

CanFrame off_frame(const DriveConfig& drive) noexcept {
  if (drive.board != kV3)
    return mit::encode_special(mit::Special::kDisable, drive.command_id, false);
  CanFrame frame;
  frame.id = kCurrent | number_of(drive);
  frame.extended = true;
  frame.length = 4;
  return frame;
}

CanFrame encode_state(const State& state, const DriveConfig& drive,
                      mit::Quantiser quantiser) noexcept {
  CanFrame frame = mit::encode_reply({.position_rad = state.position_rad,
                                      .velocity_rad_per_s = state.velocity_rad_per_s,
                                      .torque_Nm = state.torque_Nm},
                                     drive.range, drive.reply_id, false, quantiser);
  frame.length = static_cast<std::uint8_t>(reply_bytes(drive));
  frame.data[0] = number_of(drive);
  if (drive.board == kV3) {
    put(state.position_rad / kAngleCount_rad, 0, &frame);
    put(state.velocity_rad_per_s / speed_count(drive), 2, &frame);
    put(state.torque_Nm / (kCurrent_A * drive.torque_constant_Nm_per_A), 4, &frame);
  }
  if (drive.board == kV1) return frame;
  frame.data[6] = static_cast<std::uint8_t>(std::clamp(state.temperature_degC, -128, 127));
  frame.data[7] = state.error;
  return frame;
}

bool decode_state(const CanFrame& frame, const DriveConfig& drive, State* state) noexcept {
  CanFrame whole = frame;
  whole.length = 8;
  mit::Reply reply;
  if (!is_from(frame, drive) || is_servo_state(frame, drive) || frame.fd ||
      frame.length != reply_bytes(drive) || !mit::decode_reply(whole, drive.range, &reply))
    return false;
  *state = {reply.position_rad, reply.velocity_rad_per_s, reply.torque_Nm};
  if (drive.board == kV3)
    *state = {word(frame, 0) * kAngleCount_rad, word(frame, 2) * speed_count(drive),
              word(frame, 4) * kCurrent_A * drive.torque_constant_Nm_per_A};
  if (drive.board == kV1) return true;
  state->temperature_degC = static_cast<std::int8_t>(frame.data[6]);
  state->error = frame.data[7];
  return true;
}

const char* error_text(std::uint8_t error, int board) noexcept {
  static constexpr std::array kErrors = {
      "", "motor too hot", "over-current", "over-voltage", "under-voltage", "encoder"};
  if (error < kErrors.size()) return kErrors[error];
  if (error == 6) return board == kV3 ? "power stage too hot" : "phases unbalanced";
  return error == 7 && board == kV3 ? "stalled" : "";
}

}  // namespace limber::cubemars
