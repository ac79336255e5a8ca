#include "robots/loader/protocols/drive_protocol.h"

#include <fmt/format.h>

#include <algorithm>

namespace limber {

std::string_view name_of(Figure figure) noexcept {
  switch (figure) {
    case Figure::kPeakTorque:
      return "peak_torque";
    case Figure::kSpeed:
      return "speed";
    case Figure::kHoldKp:
      return "hold_kp";
    case Figure::kHoldKd:
      return "hold_kd";
    case Figure::kNone:
      break;
  }
  return "";
}

const DriveProtocol& protocol_named(std::string_view word) {
  return **std::ranges::find(drive_protocols(), word, &DriveProtocol::word);
}

std::vector<std::string> protocol_words() {
  std::vector<std::string> words;
  for (const DriveProtocol* protocol : drive_protocols()) words.emplace_back(protocol->word);
  return words;
}

std::string link_protocol_words() {
  std::string words;
  for (const DriveProtocol* protocol : drive_protocols()) {
    if (protocol->reports_link)
      words += (words.empty() ? "" : " or ") + std::string(protocol->word);
  }
  return words;
}

void refuse_foreign_keys(const YamlMap& yaml, const DriveProtocol& protocol) {
  for (const DriveProtocol* other : drive_protocols()) {
    for (const std::string key : other->keys) {
      const bool own = std::ranges::find(protocol.keys, key) != protocol.keys.end();
      if (!own && yaml.has(key))
        yaml.refuse(key, fmt::format("is for motors with protocol: {} only", other->word));
    }
  }
}

// A joint that was refused has no protocol.
bool uses_id(const DriveConfig& drive, std::uint32_t id) {
  if (drive.protocol == nullptr) return false;
  const auto reserves_id = drive.protocol->reserves_id;
  return id == drive.command_id || id == drive.reply_id ||
         (reserves_id != nullptr && reserves_id(drive, id));
}

std::uint32_t kind_of_id(const DriveConfig& drive, std::uint32_t id, bool extended) noexcept {
  return extended && drive.protocol->kind != nullptr ? drive.protocol->kind(id) : id;
}

bool accepts_id(const DriveConfig& drive, std::uint32_t id) {
  if (drive.protocol == nullptr) return false;
  const auto accepts = drive.protocol->accepts_id;
  return accepts != nullptr && accepts(drive, id);
}

}  // namespace limber
