// Answers of rtnetlink, byte by byte: what the kernel tells of CAN interfaces.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "drivers/can/link_details.h"

namespace limber::test_link_details {
namespace {

using Bytes = std::vector<std::uint8_t>;

// Little-endian, as on the machines that this is built for.
Bytes u16(unsigned v) { return {std::uint8_t(v), std::uint8_t(v >> 8)}; }
Bytes u32(unsigned v) {
  return {std::uint8_t(v), std::uint8_t(v >> 8), std::uint8_t(v >> 16), std::uint8_t(v >> 24)};
}
Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}
Bytes text(const char* word) {
  Bytes bytes(word, word + std::string(word).size());
  bytes.push_back(0);
  return bytes;
}
/// Length with its own four bytes, type, content, padded to four.
Bytes attribute(unsigned type, const Bytes& content) {
  Bytes bytes = u16(4 + static_cast<unsigned>(content.size())) + u16(type) + content;
  while (bytes.size() % 4 != 0) bytes.push_back(0);
  return bytes;
}
/// struct can_bittiming: bit rate, and seven numbers more.
Bytes timing(unsigned bitrate) { return u32(bitrate) + Bytes(28, 0x11); }

/// RTM_NEWLINK = 16; ifinfomsg of 16 bytes.
Bytes message(const Bytes& attributes, unsigned type = 16) {
  return u32(32 + static_cast<unsigned>(attributes.size())) + u16(type) + u16(0) + u32(0) + u32(0) +
         Bytes(16, 0) + attributes;
}
// IFLA_TXQLEN = 13, IFLA_LINKINFO = 18, IFLA_INFO_KIND = 1, IFLA_INFO_DATA = 2; of CAN: bit timing
// 1, state 4, control mode 5 (FD: 20h), restart-ms 6, data bit timing 9.
Bytes controller() {
  return attribute(1, timing(1'000'000)) + attribute(4, u32(2)) +
         attribute(5, u32(0x20) + u32(0x20)) + attribute(6, u32(100)) +
         attribute(9, timing(5'000'000));
}
Bytes can_link() {
  return message(attribute(3, text("can0")) + attribute(13, u32(64)) +
                 attribute(18, attribute(1, text("can")) + attribute(2 | 0x8000, controller())));
}

std::optional<LinkDetails> parse(const Bytes& bytes) {
  return parse_link_details(std::as_bytes(std::span(bytes)));
}

TEST(LinkDetails, OfAController) {
  const auto link = parse(can_link());
  ASSERT_TRUE(link);
  EXPECT_EQ(link->kind, "can");
  EXPECT_TRUE(link->has_bit_timing());
  EXPECT_EQ(link->queue_frames, 64U);
  EXPECT_EQ(link->bitrate, 1'000'000U);
  EXPECT_EQ(link->data_bitrate, 5'000'000U);
  EXPECT_TRUE(link->fd);
  EXPECT_EQ(link->restart_ms, 100U);
  EXPECT_EQ(link->state, CanControllerState::kErrorPassive);
}

TEST(LinkDetails, OfAVirtualInterfaceThereIsNoBitTiming) {
  const auto link = parse(message(attribute(18, attribute(1, text("vcan")))));
  ASSERT_TRUE(link);
  EXPECT_EQ(link->kind, "vcan");
  EXPECT_FALSE(link->has_bit_timing());
}

TEST(LinkDetails, WhatIsNoneOrDamagedIsNothing) {
  EXPECT_FALSE(parse({}));
  EXPECT_FALSE(parse(message({}, 2)));  // an error
  Bytes whole = can_link();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(parse({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)})) << size;
  }
  for (unsigned length : {0U, 3U, 200U}) {  // of an attribute
    Bytes bytes = can_link();
    bytes[32] = static_cast<std::uint8_t>(length);
    bytes[33] = length == 200 ? 3 : 0;
    EXPECT_FALSE(parse(bytes)) << length;
  }
}

TEST(LinkDetails, ReadsThisMachines) {
  const auto loopback = read_link_details("lo");
  ASSERT_TRUE(loopback);
  EXPECT_FALSE(loopback->has_bit_timing());
  EXPECT_FALSE(read_link_details("no_such_link"));
  EXPECT_FALSE(read_link_details(""));
  EXPECT_FALSE(read_link_details("a_name_that_is_too_long"));
}

}  // namespace
}  // namespace limber::test_link_details
