#include "tools/can/canopen_decoder.h"

#include <fmt/format.h>

#include <utility>

#include "drivers/families/drive_family.h"

namespace limber::bus_tools {
namespace {

using canopen::NmtCommand;
using canopen::NmtState;
using canopen::SdoKind;
using canopen::SdoMessage;

constexpr std::uint16_t kFirstRealObject = 0x1000;  // below: types, which stand for gaps

const char* command_word(NmtCommand command) {
  switch (command) {
    case NmtCommand::kStart:
      return "start";
    case NmtCommand::kStop:
      return "stop";
    case NmtCommand::kPreOperational:
      return "enter pre-operational";
    case NmtCommand::kResetNode:
      return "reset node";
    case NmtCommand::kResetCommunication:
      break;
  }
  return "reset communication";
}

const char* state_word(NmtState state) {
  switch (state) {
    case NmtState::kBootUp:
      return "boot-up";
    case NmtState::kStopped:
      return "stopped";
    case NmtState::kOperational:
      return "operational";
    case NmtState::kPreOperational:
      break;
  }
  return "pre-operational";
}

Value object_name(const SdoMessage& message) {
  return {object_number(message.object), object_row(message.object).name, ""};
}

std::string segment_text(const SdoMessage& message) {
  std::string text;
  for (std::size_t i = 0; i < message.bytes; ++i)
    text += fmt::format("{}{:02X}", i == 0 ? "" : " ", message.segment[i]);
  return text + (message.last ? " (last)" : "");
}

Value abort_value(const SdoMessage& message) {
  return {object_number(message.object),
          fmt::format("{:08X}h {}", message.value,
                      text_of(static_cast<canopen::SdoAbort>(message.value))),
          ""};
}

}  // namespace

CanopenDrive::CanopenDrive(const Motor& motor, bool fd, double period_s)
    : node(canopen::node_of(motor.joint.drive.command_id)), scale(motor, 0.0) {
  const DriveFamily family = make_drive_family(motor.joint, fd, period_s);
  scale.rad_per_count = family.codec->angle_resolution();
  for (int i = 0; i < family.startup->steps(); ++i) {
    SdoMessage message;
    if (canopen::decode_sdo_request(family.startup->request(i), node, &message) &&
        message.kind == SdoKind::kWrite)
      pdos.note_write(message.object, message.value);
  }
}

CanopenDecoder::CanopenDecoder(const Motor& motor, bool fd, double period_s)
    : name_(motor.name), drive_(motor, fd, period_s) {}

std::optional<Reading> CanopenDecoder::read(const CanFrame& frame) {
  if (frame.error || frame.extended) return std::nullopt;
  SdoMessage message;
  if (canopen::decode_sdo_request(frame, drive_.node, &message)) return read_request(message);
  if (canopen::decode_sdo_answer(frame, drive_.node, &message)) return read_answer(message);
  canopen::Emergency emergency;
  if (canopen::decode_emergency(frame, drive_.node, &emergency)) {
    return reading(
        Direction::kReply, "EMCY",
        {{"", hex(emergency.code, 4) + "h " + canopen::emergency_text(emergency.code), ""},
         {"error register", hex(emergency.error_register, 2) + "h", ""},
         {"vendor", fmt::format("{:02X}", fmt::join(emergency.vendor, " ")), ""}});
  }
  NmtState state{};
  if (canopen::decode_heartbeat(frame, drive_.node, &state))
    return reading(Direction::kReply, "heartbeat", {{"", state_word(state), ""}});
  if (const Pdo* pdo = drive_.pdos.find(frame.id)) return read_pdo(*pdo, frame);
  return std::nullopt;
}

Reading CanopenDecoder::read_pdo(const Pdo& pdo, const CanFrame& frame) const {
  Reading out = reading(pdo.to_node ? Direction::kCommand : Direction::kReply, pdo.name);
  canopen::FieldReader fields(frame);
  for (const MappedObject& object : pdo.objects) {
    const int bytes = object.bits / 8;
    if (object.bits % 8 != 0 || bytes < 1 || bytes > 4) {
      out.values.push_back({"not readable from", object_number(object.id), ""});
      return out;
    }
    const std::uint32_t raw = fields.take(bytes);
    if (!fields.complete()) {
      out.values.push_back({"TOO SHORT", bus_tools::bytes(frame), ""});
      return out;
    }
    if (object.id.index >= kFirstRealObject)
      out.values.push_back(object_value(object.id, raw, bytes, drive_.scale));
  }
  return out;
}

Value CanopenDecoder::value(const SdoMessage& message) const {
  Value value = object_value(message.object, message.value, message.bytes, drive_.scale);
  value.name = object_number(message.object) + " " + value.name;
  return value;
}

Reading CanopenDecoder::read_request(const SdoMessage& message) {
  if (message.kind == SdoKind::kWrite) open_write_ = message;
  switch (message.kind) {
    case SdoKind::kWrite:
      return reading(Direction::kCommand, "SDO write", {value(message)});
    case SdoKind::kRead:
      return reading(Direction::kCommand, "SDO read", {object_name(message)});
    case SdoKind::kStartWrite:
      return reading(Direction::kCommand, "SDO write in segments", {object_name(message)});
    case SdoKind::kWriteSegment:
      return reading(Direction::kCommand, "SDO segment", {{"", segment_text(message), ""}});
    case SdoKind::kReadSegment:
      return reading(Direction::kCommand, "SDO next segment");
    case SdoKind::kAbort:
      return reading(Direction::kCommand, "SDO abort", {abort_value(message)});
    case SdoKind::kStartRead:
    case SdoKind::kUnknown:
      break;
  }
  return reading(Direction::kCommand, "SDO unknown command");
}

Reading CanopenDecoder::read_answer(const SdoMessage& message) {
  const std::optional<SdoMessage> written = std::exchange(open_write_, std::nullopt);
  switch (message.kind) {
    case SdoKind::kWrite:
      if (written && written->object == message.object)
        drive_.pdos.note_write(written->object, written->value);
      return reading(Direction::kReply, "SDO written", {object_name(message)});
    case SdoKind::kRead:
      return reading(Direction::kReply, "SDO value", {value(message)});
    case SdoKind::kStartRead:
      return reading(Direction::kReply, "SDO value in segments",
                     {object_name(message), {"", std::to_string(message.value), "bytes"}});
    case SdoKind::kReadSegment:
      return reading(Direction::kReply, "SDO segment", {{"", segment_text(message), ""}});
    case SdoKind::kWriteSegment:
      return reading(Direction::kReply, "SDO segment taken");
    case SdoKind::kAbort:
      return reading(Direction::kReply, "SDO abort", {abort_value(message)});
    case SdoKind::kStartWrite:
    case SdoKind::kUnknown:
      break;
  }
  return reading(Direction::kReply, "SDO unknown answer");
}

CanopenNetworkDecoder::CanopenNetworkDecoder(const std::vector<Motor>& motors) {
  for (const Motor& motor : motors)
    names_[canopen::node_of(motor.joint.drive.command_id)] = motor.name;
}

std::optional<Reading> CanopenNetworkDecoder::read(const CanFrame& frame) {
  if (has_id(frame, canopen::kSyncId) && !frame.remote && frame.length <= 1) {
    Reading sync{"all", Direction::kCommand, "SYNC", {}};
    if (frame.length == 1) sync.values.push_back({"counter", std::to_string(frame.data[0]), ""});
    return sync;
  }
  NmtCommand command{};
  const std::uint8_t node = frame.data[1];
  if (!canopen::decode_nmt(frame, node, &command)) return std::nullopt;
  const auto found = names_.find(node);
  const std::string who = node == 0               ? "all"
                          : found == names_.end() ? "node " + std::to_string(node)
                                                  : found->second;
  return Reading{who, Direction::kCommand, "NMT", {{"", command_word(command), ""}}};
}

}  // namespace limber::bus_tools
