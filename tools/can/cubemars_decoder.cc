#include "tools/can/cubemars_decoder.h"

#include "drivers/protocols/cubemars.h"
#include "tools/can/mit_fields.h"

namespace limber::bus_tools {

std::optional<Reading> CubemarsDecoder::read(const CanFrame& frame) {
  if (cubemars::is_servo_state(frame, drive_))
    return Reading{name_, Direction::kReply, "state of servo mode: it hears no MIT frame", {}};
  if (cubemars::is_from(frame, drive_)) return read_state(frame);
  if (cubemars::is_to(frame, drive_)) return read_command(frame);
  return std::nullopt;
}

Reading CubemarsDecoder::read_command(const CanFrame& frame) const {
  mit::Special special{};
  mit::Command command;
  if (cubemars::decode_command(frame, drive_, &command))
    return {name_, Direction::kCommand, "MIT command", mit_values(command)};
  if (drive_.board != cubemars::kV3 && mit::decode_special(frame, &special))
    return {name_, Direction::kCommand, special_word(special), {}};
  const bool other = drive_.board == cubemars::kV3 && frame.id != drive_.command_id;
  return {name_,
          Direction::kCommand,
          other ? "packet " + std::to_string(frame.id >> 8U) : "unreadable",
          {{"", bytes(frame), ""}}};
}

Reading CubemarsDecoder::read_state(const CanFrame& frame) const {
  cubemars::State state;
  if (!cubemars::decode_state(frame, drive_, &state))
    return {name_, Direction::kReply, "unreadable", {{"", bytes(frame), ""}}};
  // A V3 has no such ranges to truncate in.
  const bool v3 = drive_.board == cubemars::kV3;
  Reading reading{name_, Direction::kReply, "state",
                  mit_values({.position_rad = state.position_rad,
                              .velocity_rad_per_s = state.velocity_rad_per_s,
                              .torque_Nm = state.torque_Nm},
                             v3 ? CommandRange{0.0, 0.0, 0.0} : drive_.range)};
  if (drive_.board == cubemars::kV1) return reading;
  std::string error = cubemars::error_text(state.error, drive_.board);
  if (error.empty()) error = state.error == 0 ? "no error" : "error " + hex(state.error, 2);
  reading.values.insert(reading.values.begin(), {"", error, ""});
  reading.values.push_back({"T", std::to_string(state.temperature_degC), "degC"});
  return reading;
}

}  // namespace limber::bus_tools
