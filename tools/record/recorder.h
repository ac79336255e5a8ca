// Writes every message of an LCM plane to an event log without dropping any, and counts by sequence
// number what never arrived.
#pragma once

#include <cstdint>
#include <map>
#include <string>

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
  void write(std::int64_t time_us, const std::string& channel, const void* data, std::int32_t size);
  /// Throws std::runtime_error when the disk refuses.
  void close() { log_.close(); }

  const std::map<std::string, ChannelCount>& channels() const { return channels_; }
  /// One line of JSON: {"messages": n, "bytes": n, "file_bytes": n, "lost": {"CHANNEL": n, ...}}.
  std::string report() const;

 private:
  EventLog log_;
  std::map<std::string, ChannelCount> channels_;
  std::int64_t messages_ = 0;
  std::int64_t bytes_ = 0;
  bool slow_ = false;
};

}  // namespace limber
