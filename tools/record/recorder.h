// Writes messages to an event log, and counts by sequence number what never arrived.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "common/event_log.h"

namespace limber {

/// Messages of one channel. What is sent at a rate starts with its sequence number, so a gap is a
/// loss; a number that goes back is a new run of the sender.
struct ChannelCount {
  bool numbered = true;  ///< false of requests and their answers
  std::int64_t messages = 0;
  std::int64_t lost = 0;
  std::int64_t last_seq = -1;
};

class Recorder {
 public:
  /// Throws ConfigError as EventLog does.
  Recorder(const std::string& path, std::int64_t least_free_bytes) : log_(path, least_free_bytes) {}

  /// A message that the disk is too slow for is counted as lost; the first is warned of.
  /// Throws std::runtime_error when the disk refuses (full, gone).
  void write(std::int64_t time_us, std::string_view channel, std::span<const std::uint8_t> message);
  /// See EventLog.
  std::int64_t hurry() { return log_.hurry(); }
  bool stored(std::int64_t number) const { return log_.stored(number); }
  /// Throws std::runtime_error when the disk refuses.
  void close() { log_.close(); }

  /// One line of JSON: {"messages": n, "bytes": n, "file_bytes": n, "dropped": n, "lost":
  /// {"CHANNEL": n, ...}}. `dropped`: datagrams of any channel that the kernel had no room for.
  std::string report(std::int64_t dropped) const;

 private:
  EventLog log_;
  std::map<std::string, ChannelCount, std::less<>> channels_;
  std::int64_t messages_ = 0;
  std::int64_t bytes_ = 0;
  bool slow_ = false;
};

}  // namespace limber
