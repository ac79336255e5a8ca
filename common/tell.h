// Log lines cost memory. Where there is none a line is lost and counted; what the program does for
// the arm goes on.
#pragma once

#include <spdlog/spdlog.h>

#include <atomic>
#include <cstdint>
#include <new>

namespace limber {

/// Lines of this process that were lost, until somebody was told.
inline std::atomic<std::int64_t> lines_lost = 0;

/// Calls `lines`, which logs, or prepares what is logged. Where memory is missing it is given up.
template <typename Lines>
void tell(Lines lines) noexcept {
  try {
    lines();
    if (const std::int64_t lost = lines_lost.exchange(0); lost > 0)
      spdlog::warn("warning: lines of this log were lost for want of memory, {} times", lost);
  } catch (const std::bad_alloc&) {
    ++lines_lost;
  }
}

}  // namespace limber
