// Messages in fragments, byte by byte as LCM's description of its format has them: in any order, of
// several senders, lost, doubled, garbled.
#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "common/lcm_fragments.h"

namespace limber::test_lcm_fragments {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

/// "LC03", sequence number 7, 10 bytes in all, from byte 0, number 0 of 3, channel "ARM".
const Bytes kFirst = {'L', 'C', '0', '3', 0, 0, 0,   7,   0,   0, 0,   10,  0,   0,
                      0,   0,   0,   0,   0, 3, 'A', 'R', 'M', 0, 'a', 'b', 'c', 'd'};
const Bytes kSecond = {'L', 'C', '0', '3', 0, 0, 0, 7, 0,   0,   0,   10,
                       0,   0,   0,   4,   0, 1, 0, 3, 'e', 'f', 'g', 'h'};
const Bytes kThird = {'L', 'C', '0', '3', 0, 0, 0, 7, 0, 0,   0,
                      10,  0,   0,   0,   8, 0, 2, 0, 3, 'i', 'j'};

/// The same with another number in the field of two or four bytes that begins at `at`.
Bytes with(Bytes datagram, std::size_t at, std::size_t size, std::uint32_t value) {
  for (std::size_t i = size; i-- > 0; value >>= 8U)
    datagram[at + i] = static_cast<std::uint8_t>(value);
  return datagram;
}
constexpr std::size_t kSequence = 4, kSize = 8, kOffset = 12, kNumber = 16, kCount = 18;

class LcmFragmentsTest : public ::testing::Test {
 protected:
  /// "CHANNEL message" of what became whole; "" if nothing did, "refused" if it is no fragment.
  std::string add(const Bytes& datagram, std::uint64_t sender = 1) {
    const auto fragment = read_lcm_fragment(datagram);
    if (!fragment) return "refused";
    const auto whole = fragments.add(sender, *fragment);
    if (!whole) return "";
    return std::string(whole->channel) + " " +
           std::string(whole->message.begin(), whole->message.end());
  }
  LcmFragments fragments;
};

TEST_F(LcmFragmentsTest, AreOneMessageInAnyOrder) {
  std::vector<const Bytes*> order = {&kFirst, &kSecond, &kThird};
  std::sort(order.begin(), order.end());
  do {
    EXPECT_EQ(add(*order[0]), "");
    EXPECT_EQ(add(*order[1]), "");
    EXPECT_EQ(add(*order[2]), "ARM abcdefghij");
  } while (std::next_permutation(order.begin(), order.end()));
  EXPECT_EQ(fragments.given_up(), 0);
  EXPECT_EQ(fragments.waiting(), 0);
}

TEST_F(LcmFragmentsTest, ADoubledOneCountsOnce) {
  add(kFirst);
  add(kFirst);
  add(kThird);
  EXPECT_EQ(add(kThird), "");
  EXPECT_EQ(add(kSecond), "ARM abcdefghij");
}

TEST_F(LcmFragmentsTest, OfTwoSendersAndTwoMessagesDoNotMix) {
  const auto next = [](const Bytes& datagram) { return with(datagram, kSequence, 4, 8); };
  add(kFirst, 1);
  add(with(kFirst, kFirst.size() - 4, 1, 'A'), 2);
  add(with(next(kFirst), kFirst.size() - 4, 1, '1'), 1);
  for (const std::uint64_t sender : {1U, 2U}) add(kSecond, sender);
  add(next(kSecond), 1);
  EXPECT_EQ(add(kThird, 2), "ARM Abcdefghij");
  EXPECT_EQ(add(next(kThird), 1), "ARM 1bcdefghij");
  EXPECT_EQ(add(kThird, 1), "ARM abcdefghij");
}

TEST_F(LcmFragmentsTest, AMessageThatLacksOneIsGivenUpWhenOthersNeedItsPlace) {
  add(kFirst);
  for (std::uint32_t i = 0; i < LcmFragments::kMostWaiting; ++i)
    add(with(kSecond, kSequence, 4, 100 + i));
  EXPECT_EQ(fragments.waiting(), LcmFragments::kMostWaiting);
  EXPECT_EQ(fragments.given_up(), 1);
  EXPECT_EQ(add(kSecond), "");  // begins the message anew
  EXPECT_EQ(add(kThird), "");
  EXPECT_EQ(fragments.waiting(), LcmFragments::kMostWaiting);
}

TEST_F(LcmFragmentsTest, ANumberThatIsUsedAgainIsAnotherMessage) {
  add(kFirst);
  EXPECT_EQ(add(with(kSecond, kSize, 4, 11)), "");
  EXPECT_EQ(add(kThird), "");
  EXPECT_EQ(fragments.given_up(), 2);
  EXPECT_EQ(add(kSecond), "");
  EXPECT_EQ(add(kFirst), "ARM abcdefghij");
}

TEST_F(LcmFragmentsTest, WhatDoesNotFillItsMessageOnceIsNoMessage) {
  add(kFirst);
  add(kSecond);
  EXPECT_EQ(add(with(kSecond, kNumber, 2, 2)), "");  // bytes 4 to 7 once more: 12 of 10
  EXPECT_EQ(fragments.given_up(), 1);
  add(kFirst);
  add(kSecond);
  Bytes shorter = kThird;
  shorter.pop_back();
  EXPECT_EQ(add(shorter), "");
  EXPECT_EQ(fragments.given_up(), 2);
  EXPECT_EQ(fragments.waiting(), 0);
}

TEST_F(LcmFragmentsTest, AMessageMayBeEmptyOrOfOneFragment) {
  Bytes whole = with(kFirst, kCount, 2, 1);
  EXPECT_EQ(add(with(whole, kSize, 4, 4)), "ARM abcd");
  whole.resize(whole.size() - 4);
  EXPECT_EQ(add(with(whole, kSize, 4, 0)), "ARM ");
}

TEST_F(LcmFragmentsTest, ImpossibleSizesAreRefused) {
  EXPECT_EQ(add(with(kSecond, kOffset, 4, 7)), "refused");
  EXPECT_EQ(add(with(kSecond, kOffset, 4, 0xFFFFFFFF)), "refused");
  EXPECT_EQ(add(with(kSecond, kSize, 4, 7)), "refused");
  EXPECT_EQ(add(with(kSecond, kSize, 4, kLongestWhole_bytes + 1)), "refused");
  EXPECT_EQ(add(with(kSecond, kNumber, 2, 3)), "refused");
  EXPECT_EQ(add(with(kSecond, kCount, 2, 0)), "refused");
  EXPECT_EQ(add(bytes_of("LC02" + std::string(kSecond.begin() + 4, kSecond.end()))), "refused");
  EXPECT_EQ(add(with(kFirst, 23, 1, 'X')), "refused");  // a name that does not end
  EXPECT_EQ(add(Bytes(kSecond.begin(), kSecond.begin() + 19)), "refused");
  EXPECT_EQ(add({}), "refused");
  EXPECT_EQ(fragments.waiting(), 0);
  EXPECT_EQ(add(with(kSecond, kSize, 4, kLongestWhole_bytes)), "");
}

/// Whatever comes: no byte is touched outside of the message (address sanitizer), memory is
/// bounded, and a message in between comes through.
TEST_F(LcmFragmentsTest, GarbledOnesPass) {
  std::mt19937 random(1);
  for (std::uint32_t round = 0; round < 20'000; ++round) {
    Bytes datagram = round % 3 == 0 ? kFirst : round % 3 == 1 ? kSecond : kThird;
    for (auto changes = 1 + random() % 4; changes > 0; --changes)
      datagram[4 + random() % (datagram.size() - 4)] = static_cast<std::uint8_t>(random() % 12);
    add(datagram, random() % 2);
    ASSERT_LE(fragments.waiting(), LcmFragments::kMostWaiting);
    if (round % 100 != 0) continue;
    const auto other = [&](const Bytes& part) {
      return with(part, kSequence, 4, 1U << 31U | round);
    };
    add(other(kThird));
    add(other(kFirst));
    ASSERT_EQ(add(other(kSecond)), "ARM abcdefghij");
  }
}

}  // namespace
}  // namespace limber::test_lcm_fragments
