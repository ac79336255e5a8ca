// One CAN frame, classic or FD, as every bus of limber carries it.
#pragma once

#include <array>
#include <cstdint>

#pragma GCC visibility push(default)
namespace limber {

inline constexpr std::uint32_t kStandardIdMax = 0x7FF;
inline constexpr std::uint32_t kExtendedIdMax = 0x1FFFFFFF;

struct CanFrame {
  std::uint32_t id = 0;   ///< 11 or 29 bits, without flags
  bool extended = false;  ///< 29-bit identifier
  bool remote = false;    ///< RTR
  bool error = false;     ///< error frame; id holds the error class bits (SocketCAN)
  bool fd = false;
  bool bitrate_switch = false;
  std::uint8_t length = 0;  ///< data bytes: 0..8, or an FD length up to 64
  std::array<std::uint8_t, 64> data{};
  std::int64_t timestamp_ns = 0;  ///< receive time, see Stamps; 0 unknown
};

/// Rounds a payload length up to one an FD frame can have (0..8, 12, 16, 20, 24, 32, 48, 64). -1
/// above 64.
int fd_length(int bytes);

/// Whether a bus could carry this frame: id within 11 or 29 bits, a length the format has, no
/// remote FD frame. Every bus refuses to send what is not possible, and counts it as malformed when
/// received. Allowed inside the cycle.
bool is_possible(const CanFrame& frame) noexcept;

/// A data frame with this identifier: 11 bits long if it fits, else 29. Allowed inside the cycle.
inline bool has_id(const CanFrame& frame, std::uint32_t id) noexcept {
  return frame.id == id && frame.extended == (id > kStandardIdMax) && !frame.error;
}

}  // namespace limber
#pragma GCC visibility pop
