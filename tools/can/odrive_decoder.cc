#include "tools/can/odrive_decoder.h"

#include <sstream>

#include "drivers/protocols/odrive.h"
#include "tools/can/dbc_signals.h"

namespace limber::bus_tools {
namespace {

struct OdriveField {
  char kind;
  int byte;
  std::string name;
  std::string unit;
  int bytes() const { return kind == 'b' ? 1 : kind == 'h' ? 2 : 4; }
};

std::vector<OdriveField> odrive_fields(const odrive::Layout& layout) {
  std::vector<OdriveField> fields;
  std::istringstream list(layout.fields);
  int byte = 0;
  for (std::string entry; std::getline(list, entry, ',');) {
    const auto space = entry.find(' ', 2);
    fields.push_back({entry[0], byte, entry.substr(2, space - 2), entry.substr(space + 1)});
    byte += fields.back().bytes();
  }
  return fields;
}

std::string odrive_value(const OdriveField& field, const CanFrame& frame) {
  const auto at = static_cast<std::size_t>(field.byte);
  if (field.kind == 'f') return number(odrive::field<float>(frame, at));
  auto raw = odrive::field<std::uint32_t>(frame, at);
  if (field.bytes() < 4) raw &= (1U << 8 * field.bytes()) - 1U;
  if (field.name == "state") return odrive::state_text(raw);
  const bool errors =
      field.name.find("error") != std::string::npos || field.name == "disarm_reason";
  return errors && raw != 0 ? odrive::error_text(raw) : std::to_string(raw);
}

}  // namespace

std::optional<Reading> OdriveDecoder::read(const CanFrame& frame) {
  if (frame.extended || frame.error || odrive::node_of(frame.id) != node_) return std::nullopt;
  const odrive::Layout* layout = odrive::layout_of(frame.id);
  const bool asked = odrive::asks(frame) && (layout == nullptr || layout->from_drive);
  const bool reply = layout != nullptr && layout->from_drive && !asked;
  Reading reading{name_,
                  reply ? Direction::kReply : Direction::kCommand,
                  layout == nullptr ? "message " + hex(frame.id & 0x1FU, 2) : layout->name,
                  {}};
  if (asked) {
    reading.what += " asked for";
  } else if (layout == nullptr) {
    reading.values.push_back({"", bytes(frame), ""});
  } else {
    for (const OdriveField& field : odrive_fields(*layout)) {
      if (field.byte + field.bytes() <= frame.length)
        reading.values.push_back({field.name, odrive_value(field, frame), field.unit});
    }
  }
  return reading;
}

void add_odrive_messages(const Motor& motor, const BusFacts& /*bus*/,
                         std::vector<dbc::Message>* messages) {
  const std::uint32_t first = motor.joint.drive.command_id & ~0x1FU;
  for (std::uint32_t id = first; id < first + 32; ++id) {
    const odrive::Layout* layout = odrive::layout_of(id);
    if (layout == nullptr) continue;
    dbc::Message message =
        message_of(motor, dbc::identifier(layout->name), id, false, 0, !layout->from_drive);
    for (const OdriveField& field : odrive_fields(*layout)) {
      message.signals.push_back(
          plain(field.name.c_str(), 8 * field.byte, 8 * field.bytes(), false, field.unit.c_str()));
      if (field.kind == 'f') message.signals.back().is_float = true;
      if (field.kind == 'f') message.signals.back().low = message.signals.back().high = 0.0;
      message.bytes = field.byte + field.bytes();
    }
    messages->push_back(std::move(message));
  }
}

}  // namespace limber::bus_tools
