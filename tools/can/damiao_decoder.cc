#include "tools/can/damiao_decoder.h"

#include <array>

#include "tools/can/mit_fields.h"

namespace limber::bus_tools {
namespace {

/// Names and formats of the maker's manual; what is not listed is shown by number.
constexpr std::array kDamiaoRegisters = {
    DamiaoRegister{0, "under-voltage limit", false, "V"},
    DamiaoRegister{1, "torque constant", false, "N m/A"},
    DamiaoRegister{2, "over-temperature limit", false, "degC"},
    DamiaoRegister{3, "over-current limit", false, ""},
    DamiaoRegister{4, "acceleration", false, "rad/s^2"},
    DamiaoRegister{5, "deceleration", false, "rad/s^2"},
    DamiaoRegister{6, "maximum speed", false, "rad/s"},
    DamiaoRegister{7, "MST_ID", true, ""},
    DamiaoRegister{8, "ESC_ID", true, ""},
    DamiaoRegister{9, "TIMEOUT", true, "counts of 50 us"},
    DamiaoRegister{10, "CTRL_MODE", true, ""},
    DamiaoRegister{11, "damping", false, ""},
    DamiaoRegister{12, "inertia", false, "kg m^2"},
    DamiaoRegister{13, "hardware version", true, ""},
    DamiaoRegister{14, "software version", true, ""},
    DamiaoRegister{15, "serial number", true, ""},
    DamiaoRegister{16, "pole pairs", true, ""},
    DamiaoRegister{17, "phase resistance", false, "ohm"},
    DamiaoRegister{18, "phase inductance", false, "H"},
    DamiaoRegister{19, "flux", false, "Wb"},
    DamiaoRegister{20, "gear ratio", false, ""},
    DamiaoRegister{21, "PMAX", false, "rad"},
    DamiaoRegister{22, "VMAX", false, "rad/s"},
    DamiaoRegister{23, "TMAX", false, "N m"},
    DamiaoRegister{24, "current bandwidth", false, "Hz"},
    DamiaoRegister{25, "speed loop Kp", false, ""},
    DamiaoRegister{26, "speed loop Ki", false, ""},
    DamiaoRegister{27, "position loop Kp", false, ""},
    DamiaoRegister{28, "position loop Ki", false, ""},
    DamiaoRegister{29, "over-voltage limit", false, "V"},
    DamiaoRegister{30, "gear efficiency", false, ""},
    DamiaoRegister{31, "speed loop damping", false, ""},
    DamiaoRegister{32, "speed loop bandwidth", false, "Hz"},
    DamiaoRegister{33, "current loop enhancement", false, ""},
    DamiaoRegister{34, "speed loop enhancement", false, ""},
    DamiaoRegister{35, "can_br", true, ""},
    DamiaoRegister{80, "position before the gear", false, "rad"},
    DamiaoRegister{81, "position", false, "rad"},
};

const DamiaoRegister* row_of(std::uint8_t reg) {
  for (const DamiaoRegister& row : kDamiaoRegisters) {
    if (row.number == reg) return &row;
  }
  return nullptr;
}

Value register_name(std::uint8_t reg) {
  const DamiaoRegister* row = row_of(reg);
  return {row == nullptr ? "register " + std::to_string(reg) : row->name, "", ""};
}

}  // namespace

std::span<const DamiaoRegister> damiao_registers() noexcept { return kDamiaoRegisters; }

Value damiao_register(std::uint8_t reg, std::uint32_t raw) {
  const DamiaoRegister* row = row_of(reg);
  if (row == nullptr) return {"register " + std::to_string(reg), "0x" + hex(raw, 8), ""};
  const double value =
      row->whole ? static_cast<double>(raw) : static_cast<double>(mit::bits_float(raw));
  return {row->name, row->whole ? std::to_string(raw) : number(value), row->unit};
}

std::optional<Reading> DamiaoDecoder::read(const CanFrame& frame) {
  if (has_id(frame, drive_.command_id)) return read_command(frame);
  if (has_id(frame, drive_.reply_id)) return read_reply(frame);
  mit::RegisterRequest request;
  if (mit::decode_register_request(frame, &request) && request.id == drive_.command_id)
    return read_request(request);
  for (const mit::ControlMode mode :
       {mit::ControlMode::kPositionVelocity, mit::ControlMode::kVelocity,
        mit::ControlMode::kForcePosition}) {
    if (has_id(frame, drive_.command_id + mit::id_offset(mode))) return read_servo(frame, mode);
  }
  return std::nullopt;
}

Reading DamiaoDecoder::read_servo(const CanFrame& frame, mit::ControlMode mode) const {
  mit::Special special{};
  if (mit::decode_special(frame, &special)) return read_command(frame);
  mit::ServoCommand command;
  if (!mit::decode_servo_command(frame, mode, &command))
    return {name_, Direction::kCommand, "unreadable", {{"", bytes(frame), ""}}};
  const Value velocity{"velocity", number(command.velocity_rad_per_s), "rad/s"};
  if (mode == mit::ControlMode::kVelocity)
    return {name_, Direction::kCommand, "velocity command", {velocity}};
  Reading out{name_,
              Direction::kCommand,
              "position-velocity command",
              {{"position", number(command.position_rad), "rad"}, velocity}};
  if (mode == mit::ControlMode::kForcePosition) {
    out.what = "force-position command";
    out.values.push_back({"torque share", number(command.torque_share), ""});
  }
  return out;
}

Reading DamiaoDecoder::read_command(const CanFrame& frame) const {
  mit::Special special{};
  if (mit::decode_special(frame, &special))
    return {name_, Direction::kCommand, special_word(special), {}};
  mit::Command command;
  if (!mit::decode_command(frame, drive_.range, &command))
    return {name_, Direction::kCommand, "unreadable", {{"", bytes(frame), ""}}};
  return {name_, Direction::kCommand, "MIT command", mit_values(command)};
}

Reading DamiaoDecoder::read_request(const mit::RegisterRequest& request) {
  open_.reset();
  if (request.operation == mit::kReadRegister) {
    open_ = request;
    return {name_, Direction::kCommand, "read register", {register_name(request.reg)}};
  }
  if (request.operation == mit::kWriteRegister) {
    open_ = request;
    return {name_,
            Direction::kCommand,
            "write register",
            {damiao_register(request.reg, request.raw_value)}};
  }
  const char* what = request.operation == mit::kStoreRegister ? "store registers" : "state request";
  return {name_, Direction::kCommand, what, {}};
}

Reading DamiaoDecoder::read_reply(const CanFrame& frame) {
  if (auto answer = read_register(frame)) return *answer;
  const CommandRange& range = drive_.range;
  mit::Reply reply;
  if (!mit::decode_reply(frame, range, &reply))
    return {name_, Direction::kReply, "unreadable", {{"", bytes(frame), ""}}};
  std::string status = mit::error_text(reply.error);
  if (status.empty()) status = "status " + hex(static_cast<std::uint32_t>(reply.error), 1);
  Reading reading{name_, Direction::kReply, "state", mit_values(reply, range)};
  reading.values.insert(reading.values.begin(), {"", status, ""});
  reading.values.push_back({"T_mos", std::to_string(reply.mos_temperature_degC), "degC"});
  reading.values.push_back({"T_rotor", std::to_string(reply.rotor_temperature_degC), "degC"});
  if (reply.id_nibble != (drive_.command_id & 0xF))
    reading.values.push_back({"WRONG ID", hex(reply.id_nibble, 1), ""});
  return reading;
}

std::optional<Reading> DamiaoDecoder::read_register(const CanFrame& frame) {
  std::uint32_t raw = 0;
  const auto id = static_cast<std::uint16_t>(drive_.command_id);
  if (!open_ || !mit::decode_register(frame, id, open_->operation,
                                      static_cast<mit::Register>(open_->reg), &raw))
    return std::nullopt;
  const char* what = open_->operation == mit::kReadRegister ? "register" : "register written";
  Reading reading{name_, Direction::kReply, what, {damiao_register(open_->reg, raw)}};
  open_.reset();
  return reading;
}

}  // namespace limber::bus_tools
