#include "tools/can/moteus_decoder.h"

#include <array>
#include <cmath>

#include "drivers/protocols/moteus.h"

namespace limber::bus_tools {
namespace {

using moteus::Mode;
using moteus::Register;
using moteus::Subframe;

struct MoteusRow {
  Register reg;
  const char* name;
  const char* unit;
};
constexpr std::array kMoteusRegisters = {
    MoteusRow{Register::kMode, "mode", ""},
    MoteusRow{Register::kPosition, "position", "turns"},
    MoteusRow{Register::kVelocity, "velocity", "turns/s"},
    MoteusRow{Register::kTorque, "torque", "N m"},
    MoteusRow{Register::kCurrentQ, "q current", "A"},
    MoteusRow{Register::kCurrentD, "d current", "A"},
    MoteusRow{Register::kAbsolutePosition, "absolute position", "turns"},
    MoteusRow{Register::kMotorTemperature, "motor temperature", "degC"},
    MoteusRow{Register::kTrajectoryComplete, "trajectory complete", ""},
    MoteusRow{Register::kHomeState, "home state", ""},
    MoteusRow{Register::kVoltage, "voltage", "V"},
    MoteusRow{Register::kTemperature, "board temperature", "degC"},
    MoteusRow{Register::kFault, "fault", ""},
    MoteusRow{Register::kCommandPosition, "position", "turns"},
    MoteusRow{Register::kCommandVelocity, "velocity", "turns/s"},
    MoteusRow{Register::kCommandTorque, "feed-forward torque", "N m"},
    MoteusRow{Register::kCommandKpScale, "kp scale", ""},
    MoteusRow{Register::kCommandKdScale, "kd scale", ""},
    MoteusRow{Register::kCommandMaxTorque, "maximum torque", "N m"},
    MoteusRow{Register::kCommandStopPosition, "stop position", "turns"},
    MoteusRow{Register::kCommandWatchdog, "watchdog", "s"},
    MoteusRow{Register::kCommandVelocityLimit, "velocity limit", "turns/s"},
    MoteusRow{Register::kCommandAccelerationLimit, "acceleration limit", "turns/s^2"},
    MoteusRow{Register::kTorqueP, "torque P", "N m"},
    MoteusRow{Register::kTorqueI, "torque I", "N m"},
    MoteusRow{Register::kTorqueD, "torque D", "N m"},
    MoteusRow{Register::kTorqueFeedForward, "torque feed-forward", "N m"},
    MoteusRow{Register::kTorqueTotal, "torque total", "N m"},
    MoteusRow{Register::kMilliseconds, "milliseconds", "ms"},
    MoteusRow{Register::kModel, "model", ""},
    MoteusRow{Register::kFirmware, "firmware", ""},
    MoteusRow{Register::kRegisterMap, "register map", ""},
    MoteusRow{Register::kId, "id", ""},
    MoteusRow{Register::kSetOutputNearest, "set output nearest", "turns"},
    MoteusRow{Register::kSetOutputExact, "set output exact", "turns"},
};

struct Word {
  int number;
  const char* word;
};
constexpr std::array kHomeStates = {Word{0, "relative"}, Word{1, "rotor"}, Word{2, "output"}};

std::string worded(std::span<const Word> words, double value) {
  for (const Word& word : words) {
    if (word.number == value) return word.word;
  }
  return number(value);
}

std::string word_or_number(const char* (*text)(int) noexcept, double value) {
  const bool finite = std::isfinite(value);  // NaN: the drive does not know
  const std::string word = finite ? text(static_cast<int>(value)) : "";
  return word.empty() ? number(value) : word;
}

std::string value_text(std::uint16_t reg, double value) {
  switch (static_cast<Register>(reg)) {
    case Register::kMode:
      return word_or_number(moteus::mode_text, value);
    case Register::kFault:
      return word_or_number(moteus::fault_text, value);
    case Register::kHomeState:
      return worded(kHomeStates, value);
    default:
      return number(value);
  }
}

void add_values(const Subframe& subframe, std::vector<Value>* values) {
  for (unsigned i = 0; i < subframe.count; ++i) {
    const auto reg = static_cast<std::uint16_t>(subframe.first + i);
    const MoteusRegisterText text = moteus_register(reg);
    values->push_back({text.name, value_text(reg, subframe.value(i)), text.unit});
  }
}

/// "mode, position, velocity"
void add_names(const Subframe& subframe, std::string* names) {
  for (unsigned i = 0; i < subframe.count; ++i) {
    const auto reg = static_cast<std::uint16_t>(subframe.first + i);
    *names += (names->empty() ? "" : ", ") + moteus_register(reg).name;
  }
}

std::string error_word(std::uint8_t error) {
  if (error == moteus::kUnknownRegister) return "no such register";
  if (error == moteus::kNotWritable) return "not writable";
  return "error " + std::to_string(error);
}

/// Text of the diagnostic channel as it can be printed.
std::string printable(std::string_view text) {
  std::string out = "\"";
  for (const char letter : text) {
    const auto code = static_cast<unsigned char>(letter);
    if (letter == '\r') continue;
    if (letter == '\n')
      out += "\\n";
    else if (code >= 0x20 && code < 0x7F)
      out += letter;
    else
      out += "\\x" + hex(code, 2);
  }
  return out + "\"";
}

/// What a frame's subframes are, all in one.
struct Rows {
  std::vector<Value> values;
  std::string asked;
  bool writes = false;
  bool errors = false;
  bool text = false;
  bool malformed = false;
};

Rows rows_of(const CanFrame& frame) {
  Rows rows;
  moteus::FrameReader reader(frame);
  Subframe subframe;
  while (reader.next(&subframe)) {
    switch (subframe.kind) {
      case Subframe::Kind::kWrite:
        rows.writes = true;
        add_values(subframe, &rows.values);
        break;
      case Subframe::Kind::kReply:
        add_values(subframe, &rows.values);
        break;
      case Subframe::Kind::kRead:
        add_names(subframe, &rows.asked);
        break;
      case Subframe::Kind::kWriteError:
      case Subframe::Kind::kReadError:
        rows.errors = true;
        rows.values.push_back(
            {moteus_register(subframe.first).name, error_word(subframe.error), ""});
        break;
      case Subframe::Kind::kTextToDrive:
      case Subframe::Kind::kTextFromDrive:
        rows.text = true;
        rows.values.push_back({"", printable(subframe.text()), ""});
        break;
      case Subframe::Kind::kTextPoll:
        rows.text = true;
        break;
    }
  }
  rows.malformed = reader.malformed();
  return rows;
}

}  // namespace

MoteusRegisterText moteus_register(std::uint16_t reg) {
  for (const MoteusRow& row : kMoteusRegisters) {
    if (static_cast<std::uint16_t>(row.reg) == reg) return {row.name, row.unit};
  }
  return {"register " + hex(reg, 3) + "h", ""};
}

MoteusDecoder::MoteusDecoder(const Motor& motor)
    : name_(motor.name), id_(moteus::address_of(motor.joint.drive.command_id).destination) {}

std::optional<Reading> MoteusDecoder::read(const CanFrame& frame) {
  if (frame.error || !has_id(frame, frame.id)) return std::nullopt;
  const moteus::Address address = moteus::address_of(frame.id);
  const bool reply = address.source == id_ && address.prefix == 0 && !address.reply_wanted;
  if (!reply && address.destination != id_) return std::nullopt;
  const Direction direction = reply ? Direction::kReply : Direction::kCommand;
  Rows rows = rows_of(frame);
  // The diagnostic channel's flow control, for one, which only some of the drives know.
  if (rows.malformed || frame.remote)
    return Reading{name_, direction, "no registers", {{"", bytes(frame), ""}}};
  if (!rows.asked.empty()) rows.values.push_back({"asks for", rows.asked, ""});
  const char* text = rows.values.empty() ? "text poll" : "text";
  const char* what = rows.text     ? text
                     : rows.errors ? "refused"
                     : reply       ? "registers"
                     : rows.writes ? "write"
                                   : "read";
  return Reading{name_, direction, what, std::move(rows.values)};
}

}  // namespace limber::bus_tools
