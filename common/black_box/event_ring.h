// The last messages of a process, as records of an LCM event log bent into a ring: readable for
// whoever reads such logs, whenever the writer stops.
#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <string_view>

namespace limber {

/// A record is LCM's (https://lcm-proj.github.io/lcm/content/log-file-format.html): sync word,
/// event number, time stamp in microseconds, two lengths, channel, data, big-endian; each begins at
/// a multiple of eight bytes. Its sync word is written last, so that an unfinished record is none.
/// The event number counts from 0 and tells the order.
class EventRing {
 public:
  static constexpr std::size_t kHeaderBytes = 28;

  /// `bytes` are zero, begin at a multiple of eight, and outlive this.
  explicit EventRing(std::span<std::uint8_t> bytes) noexcept : bytes_(bytes) {}

  /// Overwrites the oldest records. What is longer than an eighth of the ring is left out. From any
  /// thread; allowed in the cycle.
  void write(std::string_view channel, std::int64_t time_us,
             std::span<const std::uint8_t> data) noexcept;

 private:
  std::span<std::uint8_t> bytes_;
  std::atomic<std::uint64_t> next_{0};  ///< bytes claimed so far, gaps at the ring's end included
  std::atomic<std::int64_t> number_{0};
};

}  // namespace limber
