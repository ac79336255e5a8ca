// Frames as candump prints them: ID#DATA.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

#include "drivers/can/can_frame.h"

namespace limber::testing {

inline std::string text(const CanFrame& frame) {
  char part[16];
  std::snprintf(part, sizeof(part), "%03X#", frame.id);
  std::string all = part;
  for (std::size_t i = 0; i < frame.length; ++i) {
    std::snprintf(part, sizeof(part), "%02X", frame.data[i]);
    all += part;
  }
  return all;
}

/// A classic frame.
inline CanFrame parse(const std::string& candump) {
  CanFrame frame;
  const auto hash = candump.find('#');
  frame.id = static_cast<std::uint32_t>(std::stoul(candump.substr(0, hash), nullptr, 16));
  for (std::size_t i = hash + 1; i + 1 < candump.size(); i += 2) {
    frame.data[frame.length++] =
        static_cast<std::uint8_t>(std::stoul(candump.substr(i, 2), nullptr, 16));
  }
  return frame;
}

}  // namespace limber::testing
