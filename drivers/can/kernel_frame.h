// The kernel's form of CAN frames, as its sockets take and give them (linux/can.h). Bytes only, no
// I/O, no allocation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "drivers/can/can_frame.h"

namespace limber {

/// Writes a possible frame; returns its size, which distinguishes classic from FD. `out` has at
/// least CANFD_MTU bytes (72). Allowed in the cycle.
std::size_t to_kernel(const CanFrame& frame, std::span<std::uint8_t> out) noexcept;

/// False if no bus could carry it; `frame` is then unspecified. Timestamp: left 0. Allowed in the
/// cycle.
[[nodiscard]] bool from_kernel(std::span<const std::uint8_t> bytes, CanFrame* frame) noexcept;

}  // namespace limber
