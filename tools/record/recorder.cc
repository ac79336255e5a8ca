#include "tools/record/recorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "common/config_error.h"
#include "lcmtypes/channels.h"

namespace limber {
namespace {

constexpr int kFingerprintBytes = 8;

/// The first field of the message: a big-endian 64-bit integer behind LCM's fingerprint.
std::int64_t sequence_number(const void* data) {
  const auto* bytes = static_cast<const unsigned char*>(data) + kFingerprintBytes;
  std::uint64_t value = 0;
  for (int i = 0; i < 8; ++i) value = value << 8 | bytes[i];
  return static_cast<std::int64_t>(value);
}

}  // namespace

Recorder::Recorder(const std::string& path) : log_(path, "w"), path_(path) {
  if (!log_.good()) throw ConfigError::at(path, 0, "", "cannot be written");
}

void Recorder::write(std::int64_t time_us, const std::string& channel, const void* data,
                     std::int32_t size) {
  lcm::LogEvent event{};
  event.eventnum = messages_;
  event.timestamp = time_us;
  event.channel = channel;
  event.datalen = size;
  event.data = const_cast<void*>(data);  // the library only reads it
  if (log_.writeEvent(&event) != 0)
    throw std::runtime_error(path_ + ": write failed; is the disk full?");
  ++messages_;
  bytes_ += size;
  const auto [entry, fresh] = channels_.try_emplace(channel);
  ChannelCount& count = entry->second;
  if (fresh) count.numbered = !std::ranges::count(channels::kUnnumbered, channel);
  ++count.messages;
  if (size < kFingerprintBytes + 8 || !count.numbered) return;
  const std::int64_t seq = sequence_number(data);
  if (count.last_seq >= 0 && seq > count.last_seq + 1) count.lost += seq - count.last_seq - 1;
  count.last_seq = seq;
}

std::string Recorder::report() const {
  std::string lost;
  for (const auto& [channel, count] : channels_) {
    lost += fmt::format("{}\"{}\": {}", lost.empty() ? "" : ", ", channel, count.lost);
  }
  return fmt::format("{{\"messages\": {}, \"bytes\": {}, \"lost\": {{{}}}}}", messages_, bytes_,
                     lost);
}

}  // namespace limber
