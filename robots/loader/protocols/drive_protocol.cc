#include "robots/loader/protocols/drive_protocol.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace limber {
namespace {

// Every protocol there is.
constexpr std::array kProtocols = {&kDamiaoMitTraits, &kMoteusTraits, &kCia402Traits};

}  // namespace

const DriveProtocolTraits& traits_of(DriveProtocol protocol) noexcept {
  return **std::ranges::find(kProtocols, protocol, &DriveProtocolTraits::protocol);
}

const DriveProtocolTraits& traits_of(const std::string& word) {
  return **std::ranges::find(kProtocols, word, &DriveProtocolTraits::word);
}

std::vector<std::string> protocol_words() {
  std::vector<std::string> words;
  for (const DriveProtocolTraits* traits : kProtocols) words.emplace_back(traits->word);
  return words;
}

std::string link_protocol_words() {
  std::string words;
  for (const DriveProtocolTraits* traits : kProtocols) {
    if (traits->reports_link) words += (words.empty() ? "" : " or ") + std::string(traits->word);
  }
  return words;
}

void refuse_foreign_keys(const YamlMap& yaml, const DriveProtocolTraits& traits) {
  for (const DriveProtocolTraits* other : kProtocols) {
    for (const char* key : other->keys) {
      if (other != &traits && yaml.has(key))
        yaml.refuse(key, fmt::format("is for motors with protocol: {} only", other->word));
    }
  }
}

bool uses_id(const DriveConfig& drive, std::uint32_t id) {
  const auto reserves_id = traits_of(drive.protocol).reserves_id;
  return id == drive.command_id || id == drive.reply_id ||
         (reserves_id != nullptr && reserves_id(drive, id));
}

bool accepts_id(const DriveConfig& drive, std::uint32_t id) {
  const auto accepts = traits_of(drive.protocol).accepts_id;
  return accepts != nullptr && accepts(drive, id);
}

}  // namespace limber
