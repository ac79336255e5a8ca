// Writes every message of an LCM plane to an event log, in lcm-logger's format, without dropping
// any, and counts by sequence number what never arrived.
#pragma once

#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <map>
#include <string>

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
  /// Throws ConfigError if the file cannot be written.
  explicit Recorder(const std::string& path);

  /// Throws std::runtime_error when the disk refuses (full, gone).
  void write(std::int64_t time_us, const std::string& channel, const void* data, std::int32_t size);

  const std::map<std::string, ChannelCount>& channels() const { return channels_; }
  /// One line of JSON: {"messages": n, "bytes": n, "lost": {"CHANNEL": n, ...}}.
  std::string report() const;

 private:
  lcm::LogFile log_;
  std::string path_;
  std::map<std::string, ChannelCount> channels_;
  std::int64_t messages_ = 0;
  std::int64_t bytes_ = 0;
};

}  // namespace limber
