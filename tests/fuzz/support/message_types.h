// Every type of message, by its place in the alphabet.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/decode_message.h"
#include "fuzz/message_list.h"

namespace limber::fuzz {

using Bytes = std::vector<std::uint8_t>;

struct MessageType {
  std::int64_t fingerprint;
  std::optional<Bytes> (*encoded_again)(std::span<const std::uint8_t>);
};

template <typename Message>
MessageType message_type() {
  return {Message::getHash(), [](std::span<const std::uint8_t> bytes) -> std::optional<Bytes> {
            Message message;
            if (!decode_message(bytes.data(), bytes.size(), &message)) return std::nullopt;
            Bytes again(static_cast<std::size_t>(message.getEncodedSize()));
            const int size = message.encode(again.data(), 0, static_cast<int>(again.size()));
            again.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
            return again;
          }};
}

/// Type `number` (counted round) in alphabetical order.
inline const MessageType& message_type_of(std::uint8_t number) {
#define LIMBER_MESSAGE_TYPE(name) message_type<name>(),
  static const MessageType kTypes[] = {LIMBER_MESSAGES(LIMBER_MESSAGE_TYPE)};
#undef LIMBER_MESSAGE_TYPE
  return kTypes[number % std::size(kTypes)];
}

/// An input of the target `messages`: the type's number, and the message behind its fingerprint, so
/// that kept inputs outlive a change of the type. Returns the message as it is on the wire.
inline Bytes with_fingerprint(std::span<const std::uint8_t> input) {
  Bytes bytes;
  const std::int64_t fingerprint = message_type_of(input[0]).fingerprint;
  for (int shift = 56; shift >= 0; shift -= 8)
    bytes.push_back(static_cast<std::uint8_t>(fingerprint >> shift));
  bytes.insert(bytes.end(), input.begin() + 1, input.end());
  return bytes;
}

}  // namespace limber::fuzz
