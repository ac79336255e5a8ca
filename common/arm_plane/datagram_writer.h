// Messages as datagrams in LCM's wire format.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "common/arm_plane/lcm_datagram.h"
#include "common/decode_message.h"

namespace limber {

/// Room for the longest datagram that limber sends or takes.
using DatagramBuffer =
    std::array<std::uint8_t, kLcmHeaderBytes + kLongestChannel + 1 + kMaxMessageBytes>;

/// Encodes into a buffer of its own, each message with the next sequence number. Allowed in the
/// cycle.
class DatagramWriter {
 public:
  struct Written {
    std::span<const std::uint8_t> datagram;
    std::span<const std::uint8_t> message;  ///< the part of it behind the header
  };

  /// Nothing if the message is too long; valid until the next call.
  template <typename Message>
  std::optional<Written> write(std::string_view channel, const Message& message) noexcept {
    const std::size_t header = write_lcm_header(channel, sequence_++, buffer_);
    const int size = message.encode(buffer_.data(), static_cast<int>(header), kMaxMessageBytes);
    if (size < 0) return std::nullopt;
    const std::span datagram = std::span(buffer_).first(header + static_cast<unsigned>(size));
    return Written{datagram, datagram.subspan(header)};
  }

 private:
  std::uint32_t sequence_ = 0;
  DatagramBuffer buffer_{};
};

}  // namespace limber
