// Every type of message: bytes are read or refused, and what was read can be encoded. The first
// byte is the type, the rest the message behind its fingerprint; tests/fuzz/test_messages_alike.py
// compares with Python.
#include "tests/fuzz/support/message_types.h"
#include "tests/fuzz/support/require.h"

using namespace limber;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const fuzz::Bytes bytes = fuzz::with_fingerprint(std::span(data, size));
  const auto again = fuzz::message_type_of(data[0]).encoded_again(bytes);
  if (again) fuzz::require(again->size() <= bytes.size(), "an encoding does not grow");
  return 0;
}
