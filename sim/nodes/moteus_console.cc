// Commands of the diagnostic channel of an emulated moteus drive.
#include <cmath>
#include <limits>

#include "sim/nodes/moteus_node.h"

namespace limber::sim {

using moteus::Mode;
using moteus::Register;

void MoteusNode::execute(std::string_view line, const JointReading& joint) noexcept {
  const std::string_view verb = next_word(&line);
  if (verb.empty()) return;
  if (verb == "conf") {
    settings_.command(line, &text_);
  } else if (verb == "tel") {
    telemetry_.command(line, stats(joint), &text_);
  } else if (verb == "d") {
    debug(line, joint);
  } else {
    text_.error("unknown command");
  }
}

void MoteusNode::debug(std::string_view words, const JointReading& joint) noexcept {
  const std::string_view verb = next_word(&words);
  double turns = 0.0;
  if (verb == "nearest" || verb == "rezero" || verb == "exact" || verb == "cfg-set-output") {
    const bool nearest = verb == "nearest" || verb == "rezero";
    if (!parse_number(words, &turns) || !std::isfinite(turns))
      return text_.error("missing position");
    if (nearest) turns = sense(joint).turns + std::round(turns - sense(joint).turns);
    set_output(turns, joint);
    return text_.ok();
  }
  written_.reset();
  if (verb == "pos" || verb == "zero") {
    if (!debug_command(words)) return text_.error("missing p/v/i, or unknown option");
    change_mode(verb == "pos" ? Mode::kPosition : Mode::kZeroVelocity, joint);
  } else if (verb == "stop") {
    change_mode(Mode::kStopped, joint);
  } else if (verb == "brake") {
    change_mode(Mode::kBrake, joint);
  } else {
    return text_.error("unknown command");
  }
  text_.ok();
}

/// Position, velocity, most torque, then options of one letter and a number. Without the option no
/// watchdog runs.
bool MoteusNode::debug_command(std::string_view words) noexcept {
  constexpr std::array kThree = {Register::kCommandPosition, Register::kCommandVelocity,
                                 Register::kCommandMaxTorque};
  double value = 0.0;
  const auto put = [&](Register reg) { written_.set(static_cast<std::uint16_t>(reg), value); };
  for (const Register reg : kThree) {
    if (!parse_number(next_word(&words), &value)) return false;
    put(reg);
  }
  value = std::numeric_limits<double>::quiet_NaN();
  put(Register::kCommandWatchdog);
  while (!words.empty()) {
    const std::string_view option = next_word(&words);
    if (!parse_number(option.substr(1), &value)) return false;
    switch (option.front()) {
      case 'p':
        put(Register::kCommandKpScale);
        break;
      case 'd':
        put(Register::kCommandKdScale);
        break;
      case 'f':
        put(Register::kCommandTorque);
        break;
      case 's':
        put(Register::kCommandStopPosition);
        break;
      case 't':
        put(Register::kCommandWatchdog);
        break;
      case 'v':
        put(Register::kCommandVelocityLimit);
        break;
      case 'a':
        put(Register::kCommandAccelerationLimit);
        break;
      default:
        return false;
    }
  }
  return true;
}

MoteusStats MoteusNode::stats(const JointReading& joint) const noexcept {
  const auto value = [&](Register reg) {
    double number = 0.0;
    read(static_cast<std::uint16_t>(reg), joint, &number);
    return number;
  };
  return {value(Register::kModel),       value(Register::kFirmware), value(Register::kId),
          value(Register::kMode),        value(Register::kFault),    value(Register::kPosition),
          value(Register::kVelocity),    value(Register::kTorque),   value(Register::kCurrentQ),
          value(Register::kTemperature), value(Register::kVoltage),  setpoint_.complete()};
}

}  // namespace limber::sim
