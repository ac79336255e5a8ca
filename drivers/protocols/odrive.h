// Frames of CANSimple, ODrive's protocol: identifier node << 5 | message, fields little-endian. The
// drive answers a remote frame, or an empty one, with the message of that identifier. Positions are
// turns of the motor, torques N m of the motor. Everything is allowed inside the cycle.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>

#include "drivers/can/can_frame.h"

#pragma GCC visibility push(default)
namespace limber::odrive {

enum class Message : std::uint8_t {
  kVersion,
  kHeartbeat,
  kEstop,
  kError,
  kWriteEndpoint,  ///< and kEndpoint: RxSdo, TxSdo
  kEndpoint,
  kAddress,
  kSetState,
  kEstimates = 0x09,
  kSetMode = 0x0B,
  kTorque = 0x0E,
  kSetLimits = 0x0F,
  kIq = 0x14,
  kTemperature = 0x15,
  kReboot = 0x16,
  kSupply = 0x17,
  kClearErrors = 0x18,
  kSetPosition = 0x19,
  kTorques = 0x1C,
  kPowers = 0x1D,
};
struct Layout {
  Message message;
  bool from_drive;
  const char* name;
  /// "f torque N m": kind (f float32; b, h, i: 8, 16, 32 bits), name, unit; the next behind a ','.
  const char* fields;
};
/// nullptr: not among those that are read here.
const Layout* layout_of(std::uint32_t id) noexcept;

inline constexpr std::uint32_t kEverybody = 63;  ///< also: has no number yet
inline constexpr int kLastNode = 62;
inline constexpr std::uint32_t kIdle = 1;
inline constexpr std::uint32_t kClosedLoop = 8;
inline constexpr std::uint32_t kTorqueControl = 1;
inline constexpr std::uint32_t kPassThrough = 1;
/// N m s a turn, as delivered: the torque of a motor at rest is at most this times vel_limit.
inline constexpr double kVelocityGain_Nms_per_turn = 1.0 / 6.0;
inline constexpr std::uint32_t kDisarmed = 3;  // procedure results
inline constexpr std::uint32_t kNotCalibrated = 14;
inline constexpr std::uint32_t kOverCurrent = 1U << 10U;  // errors
inline constexpr std::uint32_t kWatchdogExpired = 1U << 24U;
inline constexpr std::uint32_t kEstopped = 1U << 25U;

constexpr std::uint32_t id_of(std::uint32_t node, Message message) noexcept {
  return node << 5U | static_cast<std::uint32_t>(message);
}
constexpr std::uint32_t node_of(std::uint32_t id) noexcept { return id >> 5U; }
/// A data frame with this message, long enough for `bytes`; 0: also an empty one.
bool is_message(const CanFrame& frame, std::uint32_t node, Message message, int bytes) noexcept;
/// Whether it asks for the message of its identifier.
inline bool asks(const CanFrame& frame) noexcept { return frame.remote || frame.length == 0; }

template <typename... Field>
CanFrame encode(std::uint32_t node, Message message, Field... fields) noexcept {
  CanFrame frame;
  frame.id = id_of(node, message);
  [[maybe_unused]] const auto put = [&frame](auto field) {
    std::memcpy(frame.data.data() + frame.length, &field, sizeof field);
    frame.length = static_cast<std::uint8_t>(frame.length + sizeof field);
  };
  (put(fields), ...);
  return frame;
}
/// Of the bytes from `at` on.
template <typename Field>
Field field(const CanFrame& frame, std::size_t at) noexcept {
  Field value;
  std::memcpy(&value, frame.data.data() + at, sizeof value);
  return value;
}
CanFrame ask(std::uint32_t node, Message message) noexcept;
CanFrame read_endpoint(std::uint32_t node, std::uint16_t endpoint) noexcept;
/// Of so many bytes, an integer or a float32.
bool decode_endpoint(const CanFrame& frame, std::uint32_t node, std::uint16_t endpoint, int bytes,
                     bool real, double* value) noexcept;

/// The lowest of its bits, in words; empty: none.
std::string error_text(std::uint32_t errors);
std::string state_text(std::uint32_t state);

}  // namespace limber::odrive
#pragma GCC visibility pop
