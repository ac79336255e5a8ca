// Frames sent and received in tests of a bus.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <span>
#include <vector>

#include "common/clock.h"
#include "drivers/can/can_bus.h"

namespace limber::testing {

inline constexpr std::int64_t kSecond = 1'000'000'000;

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

/// What `from` sends is stamped at `to` when it arrives, not when it is read.
inline void expect_stamps_of_arrival(CanBus* from, CanBus* to) {
  const std::int64_t before_ns = monotonic_ns();
  from->send(numbered(1));
  usleep(20'000);
  const std::int64_t reading_ns = monotonic_ns();
  const auto got = receive(to, 1);
  ASSERT_EQ(got.size(), 1U);
  EXPECT_GE(got[0].timestamp_ns, before_ns - 1'000'000);
  EXPECT_LT(got[0].timestamp_ns, reading_ns - 1'000'000) << "time of reading instead of arrival";
}

}  // namespace limber::testing
