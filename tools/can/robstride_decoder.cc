#include "tools/can/robstride_decoder.h"

#include <array>

#include "drivers/protocols/robstride.h"

namespace limber::bus_tools {
namespace {

using robstride::Type;

std::string what_of(Type type) {
  switch (type) {
    case Type::kPing:
      return "ping";
    case Type::kEnable:
      return "enable";
    case Type::kStop:
      return "stop";
    case Type::kSetZero:
      return "set zero";
    case Type::kSetId:
      return "set id";
    case Type::kSave:
      return "save";
    case Type::kSetBaud:
      return "set baud";
    case Type::kReport:
      return "report";
    case Type::kSetProtocol:
      return "set protocol";
    default:
      return "type " + std::to_string(static_cast<int>(type));
  }
}

Value parameter(std::uint16_t index, std::uint32_t raw) {
  return {"parameter " + hex(index, 4), "0x" + hex(raw, 8), ""};
}

}  // namespace

std::optional<Reading> RobstrideDecoder::read(const CanFrame& frame) {
  robstride::Id id{};
  if (!robstride::split(frame, &id)) return std::nullopt;
  const auto number = static_cast<std::uint8_t>(drive_.command_id);
  if (id.target == number) return read_command(frame);
  const bool mine = static_cast<std::uint8_t>(id.data) == number;
  if (id.target > robstride::kLastMotor && mine) return read_reply(frame);
  return std::nullopt;
}

Reading RobstrideDecoder::read_command(const CanFrame& frame) const {
  robstride::Id id{};
  robstride::Command command;
  robstride::ParameterRequest request;
  if (robstride::decode_command(frame, drive_.range, &command)) {
    return {name_,
            Direction::kCommand,
            "command",
            {{"position", number(command.position_rad), "rad"},
             {"velocity", number(command.velocity_rad_per_s), "rad/s"},
             {"kp", number(command.kp_Nm_per_rad), "N m/rad"},
             {"kd", number(command.kd_Nms_per_rad), "N m s/rad"},
             {"torque", number(command.torque_Nm), "N m"}}};
  }
  if (robstride::decode_parameter_request(frame, &request)) {
    if (request.write)
      return {name_, Direction::kCommand, "write", {parameter(request.index, request.raw)}};
    return {name_, Direction::kCommand, "read", {{"parameter " + hex(request.index, 4), "", ""}}};
  }
  static_cast<void>(robstride::split(frame, &id));
  Reading out{name_, Direction::kCommand, what_of(id.type), {}};
  if (id.type == Type::kStop && frame.data[0] == robstride::kClear)
    out.what = "stop and clear faults";
  return out;
}

Reading RobstrideDecoder::read_reply(const CanFrame& frame) const {
  robstride::Id id{};
  robstride::State state;
  robstride::ParameterAnswer answer;
  robstride::FaultReport fault;
  static_cast<void>(robstride::split(frame, &id));
  if (robstride::decode_state(frame, drive_.range, &state)) {
    constexpr std::array kModes = {"stopped", "calibrating", "running", "mode 3"};
    std::string status = kModes[static_cast<std::size_t>(state.mode)];
    if (state.faults != 0) status += ", " + robstride::faults_text(state.faults);
    return {name_,
            Direction::kReply,
            id.type == Type::kReport ? "state, not requested" : "state",
            {{"", status, ""},
             {"position", number(state.position_rad), "rad"},
             {"velocity", number(state.velocity_rad_per_s), "rad/s"},
             {"torque", number(state.torque_Nm), "N m"},
             {"T", number(state.temperature_degC), "degC"}}};
  }
  if (robstride::decode_parameter_answer(frame, &answer)) {
    if (answer.refused)
      return {name_,
              Direction::kReply,
              "read refused",
              {{"parameter " + hex(answer.index, 4), "", ""}}};
    return {name_, Direction::kReply, "parameter", {parameter(answer.index, answer.raw)}};
  }
  if (robstride::decode_fault(frame, &fault)) {
    Reading out{name_, Direction::kReply, "fault", {}};
    for (int bit = 0; bit < 32; ++bit) {
      if ((fault.faults >> static_cast<unsigned>(bit) & 1U) == 0) continue;
      const std::string text = robstride::reported_fault_text(bit);
      out.values.push_back({"", text.empty() ? "bit " + std::to_string(bit) : text, ""});
    }
    return out;
  }
  return {name_, Direction::kReply, what_of(id.type), {{"", bytes(frame), ""}}};
}

}  // namespace limber::bus_tools
