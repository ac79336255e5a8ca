// Messages longer than a datagram, which LCM sends in fragments: "LC03", sequence number (4 bytes),
// bytes of the message (4), offset of the fragment (4), its number (2), how many there are (2), all
// big-endian; of number 0 the channel's name with a terminating zero; a part of the message
// (https://lcm-proj.github.io/lcm/content/udp-multicast-protocol.html). limber sends none itself.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/arm_plane/lcm_datagram.h"

namespace limber {

struct LcmFragment {
  std::uint32_t sequence;
  std::uint32_t message_bytes;
  std::uint32_t offset;
  std::uint16_t number;
  std::uint16_t count;
  std::string_view channel;  ///< of number 0 alone
  std::span<const std::uint8_t> part;
};

/// Nothing if it is no fragment, if it would not lie within its message, or if the message is
/// longer than kLongestWhole_bytes. The views are into `datagram`.
std::optional<LcmFragment> read_lcm_fragment(std::span<const std::uint8_t> datagram) noexcept;
inline constexpr std::uint32_t kLongestWhole_bytes = 1U << 20U;

/// Puts messages together from fragments in any order, of several senders and messages at a time.
/// Not allowed in the cycle.
class LcmFragments {
 public:
  /// Memory is bounded by so many messages: one more replaces the one that has waited longest.
  static constexpr std::size_t kMostWaiting = 16;

  /// `sender`: any number that tells senders apart. The message, if this fragment was the last that
  /// it lacked; valid until the next call.
  std::optional<LcmDatagram> add(std::uint64_t sender, const LcmFragment& fragment);
  /// Messages that were given up, since fragments were lost or did not agree.
  std::int64_t given_up() const { return given_up_; }
  std::size_t waiting() const { return messages_.size(); }

 private:
  struct Message {
    std::uint64_t sender;
    std::uint32_t sequence;
    std::uint32_t lacking_fragments;
    std::uint32_t lacking_bytes;
    std::string channel;
    std::vector<bool> has;  ///< by number
    std::vector<std::uint8_t> bytes;
  };

  void give_up(std::vector<Message>::iterator message);
  std::vector<Message>::iterator find_or_begin(std::uint64_t sender, const LcmFragment& fragment);

  std::vector<Message> messages_;  ///< the one that has waited longest is first
  Message whole_{};
  std::int64_t given_up_ = 0;
};

}  // namespace limber
