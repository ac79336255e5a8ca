// The cycle's frames to and from a moteus drive, one each way. Angles, speeds
// and torques are the drive's own: turns of its output, before joint sign and offset.
//
//   tau = kp kp_scale (position - angle) + kd kd_scale (velocity - speed) + torque
//
// with kp and kd as configured in the drive, N m per turn. Everything is allowed inside the cycle.
#pragma once

#include <cstdint>
#include <numbers>
#include <string_view>

#include "drivers/can/can_frame.h"
#include "drivers/protocols/moteus_registers.h"

#pragma GCC visibility push(default)
namespace limber::moteus {

inline constexpr double kTurn_rad = 2.0 * std::numbers::pi;

struct Command {
  double position_turns = 0.0;  ///< NaN: where it is
  double velocity_turns_per_s = 0.0;
  double torque_Nm = 0.0;  ///< feed-forward
  double kp_scale = 0.0;
  double kd_scale = 0.0;
  double max_torque_Nm = 0.0;
  double watchdog_s = 0.0;
};

struct State {
  Mode mode = Mode::kStopped;
  double position_turns = 0.0;
  double velocity_turns_per_s = 0.0;
  double torque_Nm = 0.0;
  double current_q_A = 0.0;
  double temperature_degC = 0.0;  ///< of the board
  int fault = 0;
};

/// Identifier of a frame from the host to drive `id` that wants an answer, and of the answer.
std::uint32_t command_id(std::uint8_t id) noexcept;
std::uint32_t reply_id(std::uint8_t id) noexcept;

// Each of the three requests the state, too. `id` is the identifier on the bus: command_id().
/// Position mode with all of the command in float32. What is not finite is sent as it is.
CanFrame encode_command(const Command& command, std::uint32_t id) noexcept;
/// Mode 0: power stage off. Also leaves a fault and a time-out.
CanFrame encode_stop(std::uint32_t id) noexcept;
/// Commands nothing: neither feeds the watchdog nor leaves a mode.
CanFrame encode_state_request(std::uint32_t id) noexcept;
/// Asks for one register, as int32.
CanFrame encode_read(Register reg, std::uint32_t id) noexcept;
/// A line for the drive's diagnostic channel, 60 characters at most. The answer has the text that
/// the drive had to say before.
CanFrame encode_line(std::string_view line, std::uint32_t id) noexcept;
/// Asks for text of the diagnostic channel: as much as a reply has room for in a command's answer.
CanFrame encode_text_poll(std::uint32_t id) noexcept;

/// False unless all of the state is there, in whatever formats, finite, with a mode that exists.
[[nodiscard]] bool decode_state(const CanFrame& frame, State* state) noexcept;
/// The register's value; false if the frame has none (an error subframe, another register).
[[nodiscard]] bool decode_register(const CanFrame& frame, Register reg, double* value) noexcept;
/// Text of the diagnostic channel, which may be empty; it lives as long as the frame. False if the
/// frame has none.
[[nodiscard]] bool decode_text(const CanFrame& frame, std::string_view* text) noexcept;

}  // namespace limber::moteus
#pragma GCC visibility pop
