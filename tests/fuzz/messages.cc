// Every type of message: bytes are read or refused, and what was read can be encoded. The first
// byte says which type; tests/fuzz/test_messages_alike.py asks Python the same.
#include "tests/fuzz/support/message_types.h"
#include "tests/fuzz/support/require.h"

using namespace limber;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::span<const std::uint8_t> bytes(data + 1, size - 1);
  const auto again = fuzz::decoded_and_encoded(data[0], bytes);
  if (again) fuzz::require(again->size() <= bytes.size(), "an encoding does not grow");
  return 0;
}
