// A message whose encoded bytes are changed here and there, and read again: what may come out of a
// socket.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include "common/decode_message.h"
#include "tests/fuzz/support/fuzz_input.h"

namespace limber::fuzz {

/// Zero to seven patches: an offset (2 bytes), a number of bytes (1), the bytes. Nothing if the
/// result is not a message any more.
template <typename Message>
std::optional<Message> patched(const Message& good, FuzzInput& input) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(good.getEncodedSize()));
  good.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  constexpr std::size_t kFingerprint = 8;  // a wrong one is refused at once: nothing to learn
  for (int patches = input.take<std::uint8_t>() % 8; patches > 0; --patches) {
    std::size_t at = kFingerprint + input.take<std::uint16_t>() % (bytes.size() - kFingerprint);
    for (int n = 1 + input.take<std::uint8_t>() % 8; n > 0 && at < bytes.size(); --n)
      bytes[at++] = input.take<std::uint8_t>();
  }
  Message message;
  if (!decode_message(bytes.data(), bytes.size(), &message)) return std::nullopt;
  return message;
}

}  // namespace limber::fuzz
