#include "tools/record/recorder.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

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

void Recorder::write(std::int64_t time_us, const std::string& channel, const void* data,
                     std::int32_t size) {
  const auto [entry, fresh] = channels_.try_emplace(channel);
  ChannelCount& count = entry->second;
  if (fresh) count.numbered = !std::ranges::count(channels::kUnnumbered, channel);
  if (log_.offer(time_us, channel, data, size)) {
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
  const std::int64_t seq = sequence_number(data);
  if (count.last_seq >= 0 && seq > count.last_seq + 1) count.lost += seq - count.last_seq - 1;
  count.last_seq = seq;
}

std::string Recorder::report() const {
  std::string lost;
  for (const auto& [channel, count] : channels_) {
    lost += fmt::format("{}\"{}\": {}", lost.empty() ? "" : ", ", channel, count.lost);
  }
  return fmt::format("{{\"messages\": {}, \"bytes\": {}, \"file_bytes\": {}, \"lost\": {{{}}}}}",
                     messages_, bytes_, log_.bytes_on_disk(), lost);
}

}  // namespace limber
