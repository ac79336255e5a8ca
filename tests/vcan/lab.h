// What the tests in the CAN lab share.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include "common/clock.h"
#include "drivers/can/can_bus.h"

namespace limber::testing {

inline constexpr std::int64_t kSecond = 1'000'000'000;

/// Runs a command line; a failure fails the test.
inline void run(const std::string& command) {
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
}

inline CanFrame numbered(std::uint32_t id) {
  CanFrame frame;
  frame.id = id;
  frame.length = 8;
  for (std::uint8_t i = 0; i < 8; ++i) frame.data[i] = static_cast<std::uint8_t>(id + i);
  return frame;
}

/// Everything that arrives until `count` frames are there or the time is over.
inline std::vector<CanFrame> receive(CanBus* bus, std::size_t count,
                                     std::int64_t timeout_ns = 2 * kSecond) {
  std::vector<CanFrame> frames;
  const std::int64_t deadline_ns = monotonic_ns() + timeout_ns;
  std::array<CanFrame, 64> some;
  while (frames.size() < count && wait_readable(std::span(&bus, 1), deadline_ns)) {
    const int taken = bus->receive(some);
    frames.insert(frames.end(), some.begin(), some.begin() + taken);
  }
  return frames;
}

inline bool is_silent(CanBus* bus) { return receive(bus, 1, kSecond / 20).empty(); }

}  // namespace limber::testing
