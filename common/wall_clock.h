// The wall clock, for what people read. It may be set at any time: whoever dates more than one
// thing reads it once, and goes on by CLOCK_MONOTONIC.
#pragma once

#include <chrono>
#include <cstdint>

#include "common/clock.h"

namespace limber {

/// What makes a CLOCK_MONOTONIC time one since 1970, as the wall clock is set now.
inline std::int64_t epoch_minus_monotonic_ns() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::nanoseconds(now).count() - monotonic_ns();
}

}  // namespace limber
