// Waiting without sleeping.
#pragma once

#include <sched.h>

#include <algorithm>
#include <cstdint>

#include "common/clock.h"

namespace limber {

/// Without anything for this long even a process that polls sleeps: nobody sends.
inline constexpr std::int64_t kLongestSpin_ns = 2'000'000;

/// Looks until `arrived()` (true), or until kLongestSpin_ns or the absolute CLOCK_MONOTONIC time
/// (ns) has passed. Gives the core to other processes of its priority in between, so that those
/// that wait for one another may share one. Allowed in the cycle.
template <typename Arrived>
bool spin_until(std::int64_t deadline_ns, Arrived arrived) noexcept {
  std::int64_t end_ns = 0;
  while (!arrived()) {
    const std::int64_t now_ns = monotonic_ns();
    if (end_ns == 0) end_ns = std::min(deadline_ns, now_ns + kLongestSpin_ns);
    if (now_ns >= end_ns) return false;
    sched_yield();
  }
  return true;
}

}  // namespace limber
