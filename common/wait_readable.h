// Waiting for file descriptors with nanosecond deadlines.
#pragma once

#include <cstdint>
#include <span>

namespace limber {

/// Waits until a descriptor (-1 entries are ignored) is readable or the absolute CLOCK_MONOTONIC
/// time has come (ns; <= 0: return at once). At most eight descriptors count. False on time-out.
/// Allowed in the cycle.
bool wait_readable(std::span<const int> descriptors, std::int64_t deadline_ns) noexcept;
inline bool wait_readable(int descriptor, std::int64_t deadline_ns) noexcept {
  return wait_readable(std::span(&descriptor, 1), deadline_ns);
}

}  // namespace limber
