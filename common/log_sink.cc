#include "common/log_sink.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <climits>
#include <iterator>

namespace limber {
namespace {

/// A pipe that is ready takes PIPE_BUF bytes at once.
bool has_room(int descriptor) {
  pollfd entry{descriptor, POLLOUT, 0};
  return poll(&entry, 1, 0) == 1 && (entry.revents & (POLLOUT | POLLERR)) != 0;
}

bool write_line(int descriptor, const char* text, std::size_t size) {
  return has_room(descriptor) &&
         ::write(descriptor, text, std::min<std::size_t>(size, PIPE_BUF)) >= 0;
}

}  // namespace

void LogSink::sink_it_(const spdlog::details::log_msg& message) {
  spdlog::memory_buf_t text;
  if (left_out_ > 0)
    fmt::format_to(std::back_inserter(text), "({} log lines left out: nobody read them)\n",
                   left_out_);
  formatter_->format(message, text);
  if (write_line(descriptor_, text.data(), text.size())) {
    left_out_ = 0;
  } else {
    ++left_out_;
  }
}

}  // namespace limber
