// Which identifiers an end of a bus wants to hear.
#pragma once

#include <cstdint>

#include "drivers/can/can_frame.h"

namespace limber {

/// Frames whose identifier has the same length, and the same bits where the mask has ones.
struct CanFilter {
  std::uint32_t id = 0;
  std::uint32_t mask = 0;
  bool extended = false;

  bool passes(const CanFrame& frame) const noexcept {
    return frame.extended == extended && ((frame.id ^ id) & mask) == 0;
  }
};

/// One identifier: 11 bits long if it fits, else 29.
constexpr CanFilter exactly(std::uint32_t id) noexcept {
  const bool extended = id > kStandardIdMax;
  return {id, extended ? kExtendedIdMax : kStandardIdMax, extended};
}

}  // namespace limber
