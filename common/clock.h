// The only clock limber reads.
#pragma once

#include <time.h>

#include <cstdint>

namespace limber {

/// CLOCK_MONOTONIC in nanoseconds. Allowed inside the cycle.
inline std::int64_t monotonic_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1'000'000'000LL + now.tv_nsec;
}

}  // namespace limber
