#include "tools/record/recorder.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "lcmtypes/channels.h"

namespace limber {
namespace {

constexpr int kFingerprintBytes = 8;
/// A number that leaps further is a new run of the sender, or none at all.
constexpr std::int64_t kMostLost = std::int64_t{1} << 32;

/// The first field of the message: a big-endian 64-bit integer behind LCM's fingerprint.
std::int64_t sequence_number(std::span<const std::uint8_t> message) {
  std::uint64_t value = 0;
  for (const std::uint8_t byte : message.subspan(kFingerprintBytes, 8)) value = value << 8 | byte;
  return static_cast<std::int64_t>(value);
}

}  // namespace

void Recorder::write(std::int64_t time_us, std::string_view channel,
                     std::span<const std::uint8_t> message) {
  auto entry = channels_.find(channel);
  if (entry == channels_.end()) {
    entry = channels_.try_emplace(std::string(channel)).first;
    entry->second.numbered = !std::ranges::count(channels::kUnnumbered, channel);
  }
  ChannelCount& count = entry->second;
  const auto size = static_cast<std::int32_t>(message.size());
  if (log_.offer(time_us, channel, message.data(), size)) {
    ++messages_;
    bytes_ += size;
    ++count.messages;
  } else if (const std::string failure = log_.failure(); !failure.empty()) {
    throw std::runtime_error(failure);
  } else {
    ++count.lost;
    if (!std::exchange(slow_, true))
      spdlog::warn("the disk is too slow: messages are left out, and counted as lost");
  }
  if (size < kFingerprintBytes + 8 || !count.numbered) return;
  const std::int64_t seq = sequence_number(message);
  if (count.last_seq >= 0 && seq > count.last_seq && seq - count.last_seq <= kMostLost)
    count.lost += seq - count.last_seq - 1;
  count.last_seq = seq;
}

std::string Recorder::report(std::int64_t dropped) const {
  nlohmann::ordered_json lost = nlohmann::ordered_json::object();
  for (const auto& [channel, count] : channels_) lost[channel] = count.lost;
  const nlohmann::ordered_json report = {{"messages", messages_},
                                         {"bytes", bytes_},
                                         {"file_bytes", log_.bytes_on_disk()},
                                         {"dropped", dropped},
                                         {"lost", lost}};
  // A channel's name is whatever somebody sends.
  return report.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace limber
