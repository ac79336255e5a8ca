// MIT mini-cheetah framing as Damiao drives use it: bytes only, both directions, no I/O, no
// state. All angles, speeds and torques here are the drive's own (before joint sign and offset).
#pragma once

#include <cstdint>

#include "drivers/can/can_frame.h"
#include "robots/loader/robot.h"

#pragma GCC visibility push(default)
namespace limber::mit {

/// How a value between two counts is encoded. Firmware truncates; rounding halves the error.
enum class Quantiser : std::uint8_t { kTruncate, kRound };

struct Command {
  double position_rad = 0.0;
  double velocity_rad_per_s = 0.0;
  double kp_Nm_per_rad = 0.0;
  double kd_Nms_per_rad = 0.0;
  double torque_Nm = 0.0;
};

/// Damiao status nibble.
enum class DriveError : std::uint8_t {
  kDisabled = 0x0,
  kEnabled = 0x1,
  kOverVoltage = 0x8,
  kUnderVoltage = 0x9,
  kOverCurrent = 0xA,
  kMosOverTemperature = 0xB,
  kRotorOverTemperature = 0xC,
  kCommunicationLost = 0xD,
  kOverload = 0xE,
};
/// "over-voltage"; empty for a nibble that the maker's manual does not list.
const char* error_text(DriveError error) noexcept;

struct Reply {
  std::uint8_t id_nibble = 0;
  DriveError error = DriveError::kDisabled;
  double position_rad = 0.0;
  double velocity_rad_per_s = 0.0;
  double torque_Nm = 0.0;
  int mos_temperature_degC = 0;
  int rotor_temperature_degC = 0;
};

enum class Special : std::uint8_t {
  kEnable = 0xFC,
  kDisable = 0xFD,
  kSetZero = 0xFE,
  kClearError = 0xFB
};

/// Damiao registers limber uses.
enum class Register : std::uint8_t {
  kOverTemperature = 2,  ///< float32, degC: hotter, the drive leaves the enabled mode
  kTimeout = 9,          ///< uint32, counts of 50 us
  kControlMode = 10,     ///< uint32, 1 = MIT
  kPositionRange = 21,
  kVelocityRange = 22,
  kTorqueRange = 23,  ///< float32
};
inline constexpr std::uint32_t kRegisterId = 0x7FF;
inline constexpr std::uint8_t kReadRegister = 0x33;
inline constexpr std::uint8_t kWriteRegister = 0x55;
inline constexpr std::uint8_t kStoreRegister = 0xAA;
inline constexpr std::uint8_t kStateRequest = 0xCC;

/// Register kControlMode. Commands of the others than MIT have identifiers of their own.
enum class ControlMode : std::uint8_t {
  kMit = 1,
  kPositionVelocity = 2,
  kVelocity = 3,
  kForcePosition = 4,
};
inline constexpr std::uint32_t kModeStep = 0x100;
/// Added to the drive's id: 0, 0x100, 0x200, 0x300.
constexpr std::uint32_t id_offset(ControlMode mode) noexcept {
  return kModeStep * (static_cast<std::uint32_t>(mode) - 1U);
}

/// A command of one of the other modes.
struct ServoCommand {
  double position_rad = 0.0;  ///< not in velocity mode
  /// In velocity mode the velocity, else the most that it may be.
  double velocity_rad_per_s = 0.0;
  double torque_share = 1.0;  ///< of the most that the drive can, 0 to 1; force-position mode
};
inline constexpr double kTimeoutCount_s = 50e-6;

bool all_finite(const Command& command) noexcept;
/// Every range is finite and more than 0.
bool is_usable(const CommandRange& range) noexcept;

/// The half count that a truncating sender's values lie below the truth on average: add it to a
/// decoded field that spans -range to +range. A truncated zero then decodes to exactly 0.
double half_count(double range, int bits) noexcept;

// Master to drive. Values outside the ranges saturate; a non-finite value (or range) gives false
// and leaves the frame alone. No command begins with six bytes FF, in which drives of several
// makers see special frames, one of them a change of protocol: with all fields at the top the
// damping is moved down to the first count that does not.
[[nodiscard]] bool encode_command(const Command& command, const CommandRange& range,
                                  std::uint32_t id, bool fd, Quantiser quantiser,
                                  CanFrame* frame) noexcept;
CanFrame encode_special(Special special, std::uint32_t id, bool fd) noexcept;
CanFrame encode_register_read(std::uint16_t id, Register reg, bool fd) noexcept;
CanFrame encode_register_write(std::uint16_t id, Register reg, std::uint32_t raw_value,
                               bool fd) noexcept;
/// Keeps the registers that were written beyond a power failure.
CanFrame encode_register_store(std::uint16_t id, bool fd) noexcept;
/// Asks for a state reply without commanding anything.
CanFrame encode_state_request(std::uint16_t id, bool fd) noexcept;

// Drive to master.
/// Decodes a state reply; false if it cannot be one (length, remote, error frame).
[[nodiscard]] bool decode_reply(const CanFrame& frame, const CommandRange& range,
                                Reply* reply) noexcept;
/// Decodes a register answer; false unless id, operation (read or write) and register match.
[[nodiscard]] bool decode_register(const CanFrame& frame, std::uint16_t id, std::uint8_t operation,
                                   Register reg, std::uint32_t* raw_value) noexcept;

// The node's side, for the simulator.
[[nodiscard]] bool decode_special(const CanFrame& frame, Special* special) noexcept;
[[nodiscard]] bool decode_command(const CanFrame& frame, const CommandRange& range,
                                  Command* command) noexcept;
/// False for kMit, what is too short, not finite, or a negative limit.
[[nodiscard]] bool decode_servo_command(const CanFrame& frame, ControlMode mode,
                                        ServoCommand* command) noexcept;
struct RegisterRequest {
  std::uint16_t id = 0;
  std::uint8_t operation = 0;  ///< kReadRegister, kWriteRegister, kStoreRegister or kStateRequest
  std::uint8_t reg = 0;
  std::uint32_t raw_value = 0;
};
[[nodiscard]] bool decode_register_request(const CanFrame& frame,
                                           RegisterRequest* request) noexcept;
/// Values outside the ranges saturate; NaN, which no physical state holds, becomes the lowest
/// count.
CanFrame encode_reply(const Reply& reply, const CommandRange& range, std::uint32_t reply_id,
                      bool fd, Quantiser quantiser) noexcept;
CanFrame encode_register_answer(const RegisterRequest& request, std::uint32_t raw_value,
                                std::uint32_t reply_id, bool fd) noexcept;

std::uint32_t float_bits(float value) noexcept;
float bits_float(std::uint32_t raw) noexcept;

}  // namespace limber::mit
#pragma GCC visibility pop
