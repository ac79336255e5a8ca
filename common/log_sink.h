// Log lines to the standard error output that never wait for their reader.
#pragma once

#include <spdlog/sinks/base_sink.h>

#include <cstdint>
#include <mutex>

namespace limber {

/// A line that finds the pipe or terminal full (its reader hangs, or Ctrl-S) is left out and
/// counted; the next one that finds room is preceded by the count. So a process that controls an
/// arm never stands still for its log. Lines longer than 4 KiB are cut.
class LogSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  /// `descriptor`: where lines go; stays open as long as the sink.
  explicit LogSink(int descriptor) : descriptor_(descriptor) {}

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override;
  void flush_() override {}

 private:
  int descriptor_;
  std::int64_t left_out_ = 0;
};

}  // namespace limber
