#include "common/lcm_fragments.h"

#include <algorithm>
#include <utility>

namespace limber {
namespace {

constexpr std::size_t kFragmentHeaderBytes = 20;

std::uint32_t big_endian(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t value = 0;
  for (const std::uint8_t byte : bytes) value = value << 8U | byte;
  return value;
}

}  // namespace

std::optional<LcmFragment> read_lcm_fragment(std::span<const std::uint8_t> datagram) noexcept {
  constexpr std::string_view kFragmented = "LC03";
  if (datagram.size() < kFragmentHeaderBytes ||
      !std::equal(kFragmented.begin(), kFragmented.end(), datagram.begin()))
    return std::nullopt;
  const auto field = [&](std::size_t at, std::size_t bytes) {
    return big_endian(datagram.subspan(at, bytes));
  };
  LcmFragment fragment{field(4, 4),
                       field(8, 4),
                       field(12, 4),
                       static_cast<std::uint16_t>(field(16, 2)),
                       static_cast<std::uint16_t>(field(18, 2)),
                       {},
                       datagram.subspan(kFragmentHeaderBytes)};
  if (fragment.number == 0) {
    const auto channel = split_lcm_channel(fragment.part);
    if (!channel) return std::nullopt;
    fragment.channel = channel->channel;
    fragment.part = channel->message;
  }
  const bool fits = fragment.message_bytes <= kLongestWhole_bytes &&
                    fragment.offset <= fragment.message_bytes &&
                    fragment.part.size() <= fragment.message_bytes - fragment.offset;
  if (!fits || fragment.number >= fragment.count) return std::nullopt;
  return fragment;
}

std::optional<LcmDatagram> LcmFragments::add(std::uint64_t sender, const LcmFragment& fragment) {
  const auto message = find_or_begin(sender, fragment);
  if (message->has[fragment.number]) return std::nullopt;
  if (fragment.part.size() > message->lacking_bytes) {
    give_up(message);
    return std::nullopt;
  }
  message->has[fragment.number] = true;
  message->lacking_bytes -= static_cast<std::uint32_t>(fragment.part.size());
  if (fragment.number == 0) message->channel = fragment.channel;
  std::ranges::copy(fragment.part, message->bytes.begin() + fragment.offset);
  if (--message->lacking_fragments != 0) return std::nullopt;
  if (message->lacking_bytes != 0) {
    give_up(message);
    return std::nullopt;
  }
  whole_ = std::move(*message);
  messages_.erase(message);
  return LcmDatagram{whole_.channel, whole_.bytes};
}

std::vector<LcmFragments::Message>::iterator LcmFragments::find_or_begin(
    std::uint64_t sender, const LcmFragment& fragment) {
  const auto found = std::ranges::find_if(messages_, [&](const Message& message) {
    return message.sender == sender && message.sequence == fragment.sequence;
  });
  if (found != messages_.end()) {
    if (found->bytes.size() == fragment.message_bytes && found->has.size() == fragment.count)
      return found;
    give_up(found);  // the sender has begun anew, with the same number
  }
  if (messages_.size() == kMostWaiting) give_up(messages_.begin());
  messages_.push_back({sender, fragment.sequence, fragment.count, fragment.message_bytes, "",
                       std::vector<bool>(fragment.count),
                       std::vector<std::uint8_t>(fragment.message_bytes)});
  return std::prev(messages_.end());
}

void LcmFragments::give_up(std::vector<Message>::iterator message) {
  messages_.erase(message);
  ++given_up_;
}

}  // namespace limber
