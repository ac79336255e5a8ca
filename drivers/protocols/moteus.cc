#include "drivers/protocols/moteus.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "drivers/protocols/moteus_frame.h"

namespace limber::moteus {
namespace {

constexpr std::uint16_t number(Register reg) noexcept { return static_cast<std::uint16_t>(reg); }

void put_mode(Mode mode, FrameWriter* frame) noexcept {
  const double value = static_cast<double>(mode);
  frame->write(Type::kInt8, Register::kMode, std::span(&value, 1));
}

void put_query(FrameWriter* frame) noexcept {
  frame->read(Type::kInt8, number(Register::kMode), 1);
  frame->read(Type::kFloat, number(Register::kPosition), 4);    // and velocity, torque, q current
  frame->read(Type::kInt8, number(Register::kTemperature), 2);  // and fault
}

bool may_be_a_reply(const CanFrame& frame) noexcept { return !frame.remote && !frame.error; }

/// The registers of the state, in the order of State.
constexpr std::array kStateRegisters = {
    Register::kMode,     Register::kPosition,    Register::kVelocity, Register::kTorque,
    Register::kCurrentQ, Register::kTemperature, Register::kFault};
using StateValues = std::array<double, kStateRegisters.size()>;

void collect(const Subframe& subframe, StateValues* values) noexcept {
  for (std::size_t i = 0; i < kStateRegisters.size(); ++i) {
    const unsigned index = static_cast<unsigned>(number(kStateRegisters[i])) - subframe.first;
    if (index < subframe.count) (*values)[i] = subframe.value(index);
  }
}

bool all_finite(const StateValues& values) noexcept {
  for (const double value : values) {
    if (!std::isfinite(value)) return false;
  }
  return true;
}

}  // namespace

std::uint32_t command_id(std::uint8_t id) noexcept { return can_id({0, id, true, 0}); }
std::uint32_t reply_id(std::uint8_t id) noexcept { return can_id({id, 0, false, 0}); }

CanFrame encode_command(const Command& command, std::uint32_t id) noexcept {
  FrameWriter frame(id);
  put_mode(Mode::kPosition, &frame);  // first: it resets all command registers
  const std::array values = {command.position_turns, command.velocity_turns_per_s,
                             command.torque_Nm,      command.kp_scale,
                             command.kd_scale,       command.max_torque_Nm};
  frame.write(Type::kFloat, Register::kCommandPosition, values);
  frame.write(Type::kFloat, Register::kCommandWatchdog, std::span(&command.watchdog_s, 1));
  put_query(&frame);
  return frame.frame();
}

CanFrame encode_stop(std::uint32_t id) noexcept {
  FrameWriter frame(id);
  put_mode(Mode::kStopped, &frame);
  put_query(&frame);
  return frame.frame();
}

CanFrame encode_state_request(std::uint32_t id) noexcept {
  FrameWriter frame(id);
  put_query(&frame);
  return frame.frame();
}

CanFrame encode_read(Register reg, std::uint32_t id) noexcept {
  FrameWriter frame(id);
  frame.read(Type::kInt32, number(reg), 1);
  return frame.frame();
}

CanFrame encode_line(std::string_view line, std::uint32_t id) noexcept {
  constexpr std::size_t kMost = 60;
  std::array<char, kMost + 1> text{};
  const std::size_t length = std::min(line.size(), kMost);
  std::copy_n(line.begin(), length, text.begin());
  text[length] = '\n';
  FrameWriter frame(id);
  frame.text_to_drive({text.data(), length + 1});
  return frame.frame();
}

CanFrame encode_text_poll(std::uint32_t id) noexcept {
  constexpr unsigned kMost = 29;  // and three bytes before it: 32, as the answer to a command
  FrameWriter frame(id);
  frame.text_poll(kMost);
  return frame.frame();
}

bool decode_state(const CanFrame& frame, State* state) noexcept {
  if (!may_be_a_reply(frame)) return false;
  StateValues values;
  values.fill(std::numeric_limits<double>::quiet_NaN());
  FrameReader reader(frame);
  Subframe subframe;
  while (reader.next(&subframe)) {
    if (subframe.kind == Subframe::Kind::kReply) collect(subframe, &values);
  }
  if (reader.malformed() || !all_finite(values)) return false;
  if (!(values[0] >= 0.0 && values[0] <= kLastMode)) return false;
  if (!(std::abs(values[6]) <= 255.0)) return false;
  *state = {static_cast<Mode>(values[0]), values[1], values[2], values[3], values[4], values[5],
            static_cast<int>(values[6])};
  return true;
}

bool decode_register(const CanFrame& frame, Register reg, double* value) noexcept {
  if (!may_be_a_reply(frame)) return false;
  FrameReader reader(frame);
  Subframe subframe;
  while (reader.next(&subframe)) {
    const unsigned index = static_cast<unsigned>(number(reg)) - subframe.first;
    if (subframe.kind != Subframe::Kind::kReply || index >= subframe.count) continue;
    *value = subframe.value(index);
    return true;
  }
  return false;
}

bool decode_text(const CanFrame& frame, std::string_view* text) noexcept {
  if (!may_be_a_reply(frame)) return false;
  FrameReader reader(frame);
  Subframe subframe;
  while (reader.next(&subframe)) {
    if (subframe.kind != Subframe::Kind::kTextFromDrive || subframe.first != kTextChannel) continue;
    *text = subframe.text();
    return true;
  }
  return false;
}

}  // namespace limber::moteus
