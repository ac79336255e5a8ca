// What a driver on kernel sockets does between its commands and its state.
#pragma once

#include <cstdint>
#include <span>

#include "drivers/arm_driver.h"

namespace limber {

/// Reads replies until the cycle is complete (true) or the deadline has come (false);
/// CLOCK_MONOTONIC, ns. Allowed in the cycle.
inline bool wait_for_replies(ArmDriver* driver, std::span<CanBus* const> buses,
                             std::int64_t deadline_ns) noexcept {
  while (!driver->complete()) {
    if (!wait_readable(buses, deadline_ns)) return false;
    driver->poll();
  }
  return true;
}

}  // namespace limber
