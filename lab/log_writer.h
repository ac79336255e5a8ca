// Writes typed messages to an LCM event log with arm time as the time stamp: what a recorder would
// have heard.
#pragma once

#include <array>
#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <stdexcept>
#include <string>

#include "common/config_error.h"
#include "common/lcm_port.h"

namespace limber {

class LogWriter {
 public:
  /// Throws ConfigError if the file cannot be written.
  explicit LogWriter(const std::string& path) : log_(path, "w"), path_(path) {
    if (!log_.good()) throw ConfigError::at(path, 0, "", "cannot be written");
  }

  /// Throws std::runtime_error when the disk refuses.
  template <typename Message>
  void write(std::int64_t time_ns, const char* channel, const Message& message) {
    lcm::LogEvent event{};
    event.eventnum = number_++;
    event.timestamp = time_ns / 1000;
    event.channel = channel;
    event.datalen = message.encode(buffer_.data(), 0, kMaxMessageBytes);
    event.data = buffer_.data();
    if (event.datalen < 0 || log_.writeEvent(&event) != 0) {
      throw std::runtime_error(path_ + ": write failed; is the disk full?");
    }
  }

 private:
  lcm::LogFile log_;
  std::string path_;
  std::int64_t number_ = 0;
  std::array<std::uint8_t, kMaxMessageBytes> buffer_{};
};

}  // namespace limber
