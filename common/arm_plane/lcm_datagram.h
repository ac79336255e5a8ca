// LCM's wire format for short messages, so that LCM's tools can listen to the arm plane and tests
// can send to it. A datagram is "LC02", a sequence number (4 bytes, big-endian), the channel's name
// with a terminating zero, and the encoded message
// (https://lcm-proj.github.io/lcm/content/udp-multicast-protocol.html). Longer messages come in
// fragments ("LC03", lcm_fragments.h); limber's never do.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace limber {

inline constexpr std::size_t kLcmHeaderBytes = 8;
/// LCM's limit, without the terminating zero.
inline constexpr std::size_t kLongestChannel = 63;

struct LcmDatagram {
  std::string_view channel;
  std::span<const std::uint8_t> message;
};

/// Writes all that precedes the message; returns its size, at most kLcmHeaderBytes +
/// kLongestChannel + 1. Allowed in the cycle.
inline std::size_t write_lcm_header(std::string_view channel, std::uint32_t sequence,
                                    std::span<std::uint8_t> out) noexcept {
  auto end = std::ranges::copy(std::string_view("LC02"), out.begin()).out;
  for (int shift = 24; shift >= 0; shift -= 8)
    *end++ = static_cast<std::uint8_t>(sequence >> shift);
  end = std::ranges::copy(channel.substr(0, kLongestChannel), end).out;
  *end++ = 0;
  return static_cast<std::size_t>(end - out.begin());
}

/// The channel's name in front, with its terminating zero, and what is behind it; nothing if the
/// name does not end in time. The views are into `bytes`. Allowed in the cycle.
inline std::optional<LcmDatagram> split_lcm_channel(std::span<const std::uint8_t> bytes) noexcept {
  const auto name = bytes.first(std::min(bytes.size(), kLongestChannel + 1));
  const auto zero = std::ranges::find(name, 0);
  if (zero == name.end()) return std::nullopt;
  const auto length = static_cast<std::size_t>(zero - name.begin());
  return LcmDatagram{{reinterpret_cast<const char*>(bytes.data()), length},
                     bytes.subspan(length + 1)};
}

/// Nothing if it is no short message. The views are into `datagram`. Allowed in the cycle.
inline std::optional<LcmDatagram> read_lcm_datagram(
    std::span<const std::uint8_t> datagram) noexcept {
  constexpr std::string_view kShort = "LC02";
  if (datagram.size() < kLcmHeaderBytes ||
      !std::equal(kShort.begin(), kShort.end(), datagram.begin()))
    return std::nullopt;
  return split_lcm_channel(datagram.subspan(kLcmHeaderBytes));
}

}  // namespace limber
