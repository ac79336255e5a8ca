// What the generated decoders cannot refuse by themselves is refused, and nothing is thrown.
#include <gtest/gtest.h>

#include <cstdint>
#include <limber/compliance_gains_t.hpp>
#include <limber/push_t.hpp>
#include <vector>

#include "common/decode_message.h"

namespace limber::test_decode_message {
namespace {

template <typename Message>
std::vector<std::uint8_t> encoded(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  EXPECT_EQ(message.encode(bytes.data(), 0, static_cast<int>(bytes.size())),
            static_cast<int>(bytes.size()));
  return bytes;
}

template <typename Message>
bool is_read(const std::vector<std::uint8_t>& bytes) {
  Message message;
  return decode_message(bytes.data(), bytes.size(), &message);
}

/// Where push_t has the four bytes of its string's length: fingerprint, then the fields before.
std::size_t length_of_link(const std::vector<std::uint8_t>& bytes) {
  for (std::size_t i = 8; i + 8 < bytes.size(); ++i) {
    if (bytes[i + 3] == 5 && bytes[i + 4] == 'h' && bytes[i + 5] == 'a') return i;
  }
  ADD_FAILURE() << "no string in the message";
  return 0;
}

TEST(DecodeMessage, ReadsWhatWasEncodedAndNothingMoreOrLess) {
  push_t push{};
  push.link = "hand";
  std::vector<std::uint8_t> bytes = encoded(push);
  EXPECT_TRUE(is_read<push_t>(bytes));
  EXPECT_FALSE(is_read<compliance_gains_t>(bytes));
  bytes.push_back(0);
  EXPECT_FALSE(is_read<push_t>(bytes));
  bytes.pop_back();
  bytes.pop_back();
  EXPECT_FALSE(is_read<push_t>(bytes));
  EXPECT_FALSE(is_read<push_t>({}));
}

TEST(DecodeMessage, AStringsLengthIsNeitherZeroNorNegativeNorBeyondTheEnd) {
  push_t push{};
  push.link = "hand";
  for (const std::uint32_t length : {0U, 0xFFFFFFFFU, 0x80000000U, 0x7FFFFFFFU}) {
    std::vector<std::uint8_t> bytes = encoded(push);
    const std::size_t at = length_of_link(bytes);
    for (std::size_t i = 0; i < 4; ++i)
      bytes[at + i] = static_cast<std::uint8_t>(length >> (24U - 8U * i));
    EXPECT_FALSE(is_read<push_t>(bytes)) << length;
  }
}

TEST(DecodeMessage, AListsLengthIsNotNegative) {
  compliance_gains_t gains{};
  std::vector<std::uint8_t> bytes = encoded(gains);
  EXPECT_TRUE(is_read<compliance_gains_t>(bytes));
  bytes.back() = 0xFF;  // num_parameters
  EXPECT_FALSE(is_read<compliance_gains_t>(bytes));
}

TEST(DecodeMessage, TooLongIsRefusedBeforeItIsRead) {
  push_t push{};
  push.link = std::string(kMaxMessageBytes, 'x');
  EXPECT_FALSE(is_read<push_t>(encoded(push)));
}

}  // namespace
}  // namespace limber::test_decode_message
