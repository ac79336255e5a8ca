// Bytes of unknown origin as a message. The generated decoders throw at a string or a list whose
// length is negative; an exception must not reach LCM's C code.
#pragma once

#include <cstddef>
#include <exception>

namespace limber {

/// Longest encoded message: never fragmented on any link.
inline constexpr int kMaxMessageBytes = 1400;

/// True if `data` is exactly one message of this type and version, of at most kMaxMessageBytes;
/// else `message` is unspecified. Messages with strings or lists may allocate.
template <typename Message>
[[nodiscard]] bool decode_message(const void* data, std::size_t size, Message* message) noexcept {
  if (size > static_cast<std::size_t>(kMaxMessageBytes)) return false;
  const int bytes = static_cast<int>(size);
  try {
    return message->decode(data, 0, bytes) == bytes;
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace limber
