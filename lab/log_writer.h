// Writes typed messages to an LCM event log with arm time as the time stamp: what a recorder would
// have heard.
#pragma once

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "common/event_log.h"
#include "common/lcm_port.h"

namespace limber {

class LogWriter {
 public:
  /// Throws ConfigError if the file exists or cannot be written.
  explicit LogWriter(const std::string& path) : log_(path) {}

  /// Throws std::runtime_error when the disk refuses.
  template <typename Message>
  void write(std::int64_t time_ns, const char* channel, const Message& message) {
    const int size = message.encode(buffer_.data(), 0, kMaxMessageBytes);
    if (size < 0) throw std::runtime_error(std::string(channel) + ": longer than a message may be");
    log_.write(time_ns / 1000, channel, buffer_.data(), size);
  }
  /// All of it is on the disk when it returns. Throws std::runtime_error when the disk refuses.
  void close() { log_.close(); }

 private:
  EventLog log_;
  std::array<std::uint8_t, kMaxMessageBytes> buffer_{};
};

}  // namespace limber
