// CubeMars AK drives (T-Motor) in MIT mode: the five numbers of mit.h. Boards V1 and V2 take them
// under the motor's 11-bit number, between special frames that enable and disable; all answer under
// one identifier, and the first byte tells who. Boards V3 take them as packet 8 of a 29-bit
// identifier, packet << 8 | number, gains first. Bytes only, both directions, no I/O, no state.
// Source: CubeMars, AK series driver manual 1.0.8 (V1, V2); sam0rr/cubemars_servo_can,
// docs/protocol.md (V3).
#pragma once

#include <cstdint>
#include <numbers>

#include "drivers/can/can_frame.h"
#include "drivers/protocols/mit.h"
#include "robots/loader/robot.h"

#pragma GCC visibility push(default)
namespace limber::cubemars {

inline constexpr int kLastMotor = 127;
enum Board : std::uint8_t { kV1 = 1, kV2, kV3 };
// Packets. A V1 or V2 sends kState in its servo mode, and then hears no MIT frame.
inline constexpr std::uint32_t kCurrent = 0x100;
inline constexpr std::uint32_t kOrigin = 0x500;
inline constexpr std::uint32_t kState = 0x2900;

/// The motor's number.
constexpr std::uint8_t number_of(const DriveConfig& drive) noexcept {
  return static_cast<std::uint8_t>(drive.command_id);
}
/// Whether the drive hears the frame: a V3 each packet from 0 to 8.
bool is_to(const CanFrame& frame, const DriveConfig& drive) noexcept;
/// Whether it is a state of the drive, whatever its length, or tells that it is in servo mode.
bool is_from(const CanFrame& frame, const DriveConfig& drive) noexcept;
bool is_servo_state(const CanFrame& frame, const DriveConfig& drive) noexcept;

/// A V3's order of fields from an MIT command; none that begins with six bytes FF (mit.h).
CanFrame gains_first(const CanFrame& command) noexcept;
/// The command that a frame is to this drive, of whatever board.
[[nodiscard]] bool decode_command(const CanFrame& frame, const DriveConfig& drive,
                                  mit::Command* command) noexcept;
/// Enables it and leaves one that is on as it is: FF .. FC; V3: a command without torque.
CanFrame on_frame(const DriveConfig& drive) noexcept;
/// Switches it off: FF .. FD; V3: no current.
CanFrame off_frame(const DriveConfig& drive) noexcept;

/// One count of a V3's angle, and of its speed before pole pairs and gear (10 rpm).
inline constexpr double kAngleCount_rad = 0.1 * std::numbers::pi / 180.0;
inline constexpr double kSpeedCount_rad_per_s = 10.0 * 2.0 * std::numbers::pi / 60.0;

/// What answers each command, from before it takes effect; behind the gear. A V1 tells neither
/// temperature nor error.
struct State {
  double position_rad = 0.0;
  double velocity_rad_per_s = 0.0;
  double torque_Nm = 0.0;
  int temperature_degC = 0;
  std::uint8_t error = 0;
};
/// Values outside the ranges saturate. `quantiser`: of V1 and V2; a V3 truncates.
CanFrame encode_state(const State& state, const DriveConfig& drive,
                      mit::Quantiser quantiser) noexcept;
/// False if it is none of this drive and board.
[[nodiscard]] bool decode_state(const CanFrame& frame, const DriveConfig& drive,
                                State* state) noexcept;
/// "over-current"; empty for 0 and what no source lists.
const char* error_text(std::uint8_t error, int board) noexcept;

}  // namespace limber::cubemars
#pragma GCC visibility pop
