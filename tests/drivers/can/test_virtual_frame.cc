// The datagrams of the virtual bus against bytes that python-can itself has written, and against
// everything it has not.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/can/virtual_frame.h"
#include "tools/allocations/allocations.h"

namespace limber::test_virtual_frame {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes from_hex(std::string_view hex) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
    bytes.push_back(
        static_cast<std::uint8_t>(std::stoul(std::string(hex.substr(i, 2)), nullptr, 16)));
  }
  return bytes;
}

Bytes encoded(const CanFrame& frame) {
  Bytes bytes(kLongestEncodedBytes);
  bytes.resize(encode_datagram(frame, bytes));
  return bytes;
}

/// A map written by hand: pairs of an ASCII key and the hexadecimal bytes of its value.
Bytes map_of(const std::vector<std::pair<std::string, std::string>>& pairs) {
  Bytes bytes = {static_cast<std::uint8_t>(0x80 | pairs.size())};
  for (const auto& [key, value] : pairs) {
    bytes.push_back(static_cast<std::uint8_t>(0xA0 | key.size()));
    bytes.insert(bytes.end(), key.begin(), key.end());
    const Bytes more = from_hex(value);
    bytes.insert(bytes.end(), more.begin(), more.end());
  }
  return bytes;
}

bool decodes(const Bytes& bytes) {
  CanFrame frame;
  return decode_datagram(bytes, &frame);
}

void expect_same(const CanFrame& a, const CanFrame& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.extended, b.extended);
  EXPECT_EQ(a.remote, b.remote);
  EXPECT_EQ(a.error, b.error);
  EXPECT_EQ(a.fd, b.fd);
  EXPECT_EQ(a.bitrate_switch, b.bitrate_switch);
  EXPECT_EQ(a.length, b.length);
  EXPECT_TRUE(a.remote || std::equal(a.data.begin(), a.data.begin() + a.length, b.data.begin()));
}

// python-can 4.6: pack_message(Message(timestamp=1.5, arbitration_id=0x123, is_extended_id=False,
// data=...)) and so on.
constexpr std::string_view kClassicBytes =
    "8ba974696d657374616d70cb3ff8000000000000ae6172626974726174696f6e5f6964cd0123ae69735f657874656e"
    "6465645f6964c2"
    "af69735f72656d6f74655f6672616d65c2ae69735f6572726f725f6672616d65c2a76368616e6e656cc0a3646c6308"
    "a464617461c408"
    "8a3c7771eb4cc9ffa569735f6664c2ae626974726174655f737769746368c2b56572726f725f73746174655f696e64"
    "696361746f72c2";
constexpr std::string_view kFdBytes =
    "8ba974696d657374616d70cb0000000000000000ae6172626974726174696f6e5f6964ce1ffffff0ae69735f657874"
    "656e6465645f6964"
    "c3af69735f72656d6f74655f6672616d65c2ae69735f6572726f725f6672616d65c2a76368616e6e656cc0a3646c63"
    "0ca464617461c40c"
    "000102030405060708090a0ba569735f6664c3ae626974726174655f737769746368c3b56572726f725f7374617465"
    "5f696e6469636174"
    "6f72c2";
constexpr std::string_view kRemoteBytes =
    "8ba974696d657374616d70cb0000000000000000ae6172626974726174696f6e5f696407ae69735f657874656e6465"
    "645f6964c2af6973"
    "5f72656d6f74655f6672616d65c3ae69735f6572726f725f6672616d65c2a76368616e6e656cc0a3646c6304a46461"
    "7461c400a569735f"
    "6664c2ae626974726174655f737769746368c2b56572726f725f73746174655f696e64696361746f72c2";

CanFrame classic_frame() {
  CanFrame frame;
  frame.id = 0x123;
  frame.length = 8;
  const Bytes data = from_hex("8A3C7771EB4CC9FF");
  std::copy(data.begin(), data.end(), frame.data.begin());
  frame.timestamp_ns = 1'500'000'000;
  return frame;
}

CanFrame fd_frame() {
  CanFrame frame;
  frame.id = 0x1FFFFFF0;
  frame.extended = frame.fd = frame.bitrate_switch = true;
  frame.length = 12;
  for (std::uint8_t i = 0; i < 12; ++i) frame.data[i] = i;
  return frame;
}

CanFrame remote_frame() {
  CanFrame frame;
  frame.id = 7;
  frame.remote = true;
  frame.length = 4;
  return frame;
}

TEST(VirtualFrame, EncodesAsPythonCanDoes) {
  EXPECT_EQ(encoded(classic_frame()), from_hex(kClassicBytes));
  EXPECT_EQ(encoded(fd_frame()), from_hex(kFdBytes));
  EXPECT_EQ(encoded(remote_frame()), from_hex(kRemoteBytes));
}

TEST(VirtualFrame, DecodesWhatPythonCanWrites) {
  CanFrame frame;
  ASSERT_TRUE(decode_datagram(from_hex(kClassicBytes), &frame));
  expect_same(frame, classic_frame());
  EXPECT_EQ(frame.timestamp_ns, 1'500'000'000) << "which a bus overwrites, but in lock step";
  ASSERT_TRUE(decode_datagram(from_hex(kFdBytes), &frame));
  expect_same(frame, fd_frame());
  ASSERT_TRUE(decode_datagram(from_hex(kRemoteBytes), &frame));
  expect_same(frame, remote_frame());
}

CanFrame random_frame(std::mt19937* random) {
  CanFrame frame;
  frame.extended = ((*random)() & 1U) != 0;
  frame.id = (*random)() & (frame.extended ? kExtendedIdMax : kStandardIdMax);
  frame.fd = ((*random)() & 1U) != 0;
  frame.bitrate_switch = frame.fd && ((*random)() & 1U) != 0;
  frame.remote = !frame.fd && (*random)() % 8 == 0;
  frame.length =
      static_cast<std::uint8_t>(fd_length(static_cast<int>((*random)() % (frame.fd ? 65U : 9U))));
  for (std::size_t i = 0; i < frame.length && !frame.remote; ++i)
    frame.data[i] = static_cast<std::uint8_t>((*random)());
  return frame;
}

TEST(VirtualFrame, EveryPossibleFrameSurvives) {
  std::mt19937 random(2);
  for (int i = 0; i < 20'000; ++i) {
    const CanFrame sent = random_frame(&random);
    ASSERT_TRUE(is_possible(sent));
    CanFrame got;
    ASSERT_TRUE(decode_datagram(encoded(sent), &got));
    expect_same(got, sent);
    ASSERT_FALSE(HasFailure()) << "frame " << i;
  }
}

TEST(VirtualFrame, AnErrorFrameKeepsItsClassBits) {
  CanFrame sent;
  sent.error = true;
  sent.id = 0x40;
  sent.length = 8;
  CanFrame got;
  ASSERT_TRUE(decode_datagram(encoded(sent), &got));
  EXPECT_TRUE(got.error);
  EXPECT_EQ(got.id, 0x40U);
}

TEST(VirtualFrame, MissingKeysHavePythonCansDefaults) {
  CanFrame frame;
  ASSERT_TRUE(decode_datagram(map_of({{"arbitration_id", "05"}}), &frame));
  EXPECT_TRUE(frame.extended);
  EXPECT_FALSE(frame.fd || frame.remote || frame.error);
  EXPECT_EQ(frame.length, 0);
  ASSERT_TRUE(decode_datagram(
      map_of({{"arbitration_id", "05"}, {"data", "C4020102"}, {"dlc", "C0"}}), &frame));
  EXPECT_EQ(frame.length, 2) << "without dlc the data tells";
  EXPECT_FALSE(decodes(map_of({{"is_fd", "C2"}}))) << "no identifier";
}

TEST(VirtualFrame, KeysInAnyOrderAndIntegersOfAnyWidth) {
  for (const char* five : {"05", "CC05", "CD0005", "CE00000005", "CF0000000000000005", "D005",
                           "D10005", "D200000005", "D30000000000000005"}) {
    CanFrame frame;
    ASSERT_TRUE(decode_datagram(
        map_of({{"data", "C4020102"}, {"dlc", "02"}, {"arbitration_id", five}}), &frame))
        << five;
    EXPECT_EQ(frame.id, 5U);
  }
  for (const char* other :
       {"FB", "D0FB", "D1FFFB", "D3FFFFFFFFFFFFFFFB", "CA40A00000", "A105", "C3", "C0"}) {
    EXPECT_FALSE(decodes(map_of({{"arbitration_id", other}}))) << other << " is no identifier";
  }
}

TEST(VirtualFrame, UnknownKeysAreSkippedWhateverTheyHold) {
  for (const char* value : {"7F",
                            "E0",
                            "C0",
                            "C2",
                            "C3",
                            "C403010203",
                            "C50001AA",
                            "C600000001AA",
                            "C70105AA",
                            "C800010501",
                            "C9000000010501",
                            "CA00000000",
                            "CB0000000000000000",
                            "CC01",
                            "CD0001",
                            "CE00000001",
                            "CF0000000000000001",
                            "D001",
                            "D10001",
                            "D200000001",
                            "D30000000000000001",
                            "D40501",
                            "D5050102",
                            "D60501020304",
                            "D7050102030405060708",
                            "D80501020304050607080910111213141516",
                            "A3414243",
                            "D90141",
                            "DA000141",
                            "DB0000000141",
                            "80",
                            "90",
                            "81A14105",
                            "92C0C0",
                            "DC0002C0C0",
                            "DD00000001C0",
                            "DE0001A141C0",
                            "DF00000001A141C0",
                            "919191919105",
                            "82A14192C0C3A14281A1430C"}) {
    CanFrame frame;
    EXPECT_TRUE(decode_datagram(map_of({{"extra", value}, {"arbitration_id", "05"}}), &frame))
        << value;
    EXPECT_EQ(frame.id, 5U) << value;
  }
}

TEST(VirtualFrame, FramesThatNoBusCouldCarry) {
  EXPECT_FALSE(decodes(map_of({{"arbitration_id", "CE20000000"}}))) << "30 bits";
  EXPECT_FALSE(decodes(map_of({{"arbitration_id", "CD0800"}, {"is_extended_id", "C2"}})))
      << "12 bits";
  EXPECT_FALSE(decodes(map_of({{"arbitration_id", "05"}, {"data", "C409000000000000000000"}})))
      << "classic with 9 bytes";
  EXPECT_FALSE(
      decodes(map_of({{"arbitration_id", "05"}, {"is_fd", "C3"}, {"is_remote_frame", "C3"}})));
  EXPECT_FALSE(decodes(map_of({{"arbitration_id", "05"}, {"bitrate_switch", "C3"}})))
      << "classic with two rates";
  EXPECT_FALSE(decodes(map_of({{"arbitration_id", "05"}, {"data", "C40100"}, {"dlc", "02"}})))
      << "dlc and data differ";
  EXPECT_FALSE(
      decodes(map_of({{"arbitration_id", "05"}, {"is_remote_frame", "C3"}, {"dlc", "CD0104"}})))
      << "260 bytes";
  EXPECT_FALSE(decodes(map_of({{"arbitration_id", "05"}, {"is_fd", "01"}}))) << "1 is not true";
}

TEST(VirtualFrame, BrokenDatagrams) {
  const Bytes whole = from_hex(kFdBytes);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(decodes(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))))
        << size;
  }
  Bytes longer = whole;
  longer.push_back(0xC0);
  EXPECT_FALSE(decodes(longer)) << "something after the map";
  EXPECT_FALSE(decodes(from_hex("DFFFFFFFFF"))) << "four thousand million pairs, none there";
  EXPECT_FALSE(decodes(from_hex("9005"))) << "not a map";
  const auto with_extra = [](const char* value) {
    return map_of({{"arbitration_id", "05"}, {"extra", value}});
  };
  EXPECT_TRUE(decodes(with_extra("C0")));
  EXPECT_FALSE(decodes(with_extra("DDFFFFFFFF"))) << "array without elements";
  EXPECT_FALSE(decodes(with_extra("C6FFFFFFFFAA"))) << "binary longer than the datagram";
  EXPECT_FALSE(decodes(with_extra("C1"))) << "0xC1 is no type";
  Bytes nested = {0x81, 0xA1, 0x78};
  nested.resize(1000, 0x91);
  EXPECT_FALSE(decodes(nested)) << "arrays in arrays to the end";
}

/// Changes, inserts, removes or repeats a few bytes.
void mutate(Bytes* bytes, std::mt19937* random) {
  const auto pick = [&](std::size_t size) {
    return static_cast<std::ptrdiff_t>((*random)() % std::max<std::size_t>(size, 1));
  };
  for (std::size_t changes = 1 + (*random)() % 4; changes > 0 && !bytes->empty(); --changes) {
    const auto at = bytes->begin() + pick(bytes->size());
    const auto value = static_cast<std::uint8_t>((*random)());
    switch ((*random)() % 5) {
      case 0:
        *at = value;
        break;
      case 1:
        *at ^= static_cast<std::uint8_t>(1U << (value % 8U));
        break;
      case 2:
        bytes->insert(at, value);
        break;
      case 3:
        bytes->erase(at, at + std::min<std::ptrdiff_t>(1 + value % 8, bytes->end() - at));
        break;
      default:
        *at = static_cast<std::uint8_t>(0xC0 | (value & 0x1FU));
        break;  // another type
    }
  }
}

// Accepts nothing but possible frames, and never reads outside: the sanitizer builds see that.
TEST(VirtualFrame, MutatedDatagramsAreRefusedOrPossible) {
  std::mt19937 random(3);
  int accepted = 0;
  constexpr int kDatagrams = 200'000;
  for (int i = 0; i < kDatagrams; ++i) {
    const Bytes original = encoded(random_frame(&random));
    Bytes bytes = original;
    mutate(&bytes, &random);
    const Bytes exact(bytes);  // no spare capacity behind the end
    CanFrame frame;
    if (!decode_datagram(exact, &frame)) continue;
    ++accepted;
    ASSERT_TRUE(is_possible(frame));
  }
  EXPECT_GT(accepted, kDatagrams / 100);
  EXPECT_LT(accepted, kDatagrams / 2);
}

TEST(VirtualFrame, RandomBytesAreRefusedOrPossible) {
  std::mt19937 random(4);
  for (int i = 0; i < 100'000; ++i) {
    Bytes bytes(random() % 64);
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(random());
    if (!bytes.empty()) bytes[0] = static_cast<std::uint8_t>(0x80 | (bytes[0] & 0x0FU));
    CanFrame frame;
    if (decode_datagram(bytes, &frame)) {
      ASSERT_TRUE(is_possible(frame));
    }
  }
}

TEST(VirtualFrame, DoesNotAllocate) {
  std::array<std::uint8_t, kLongestEncodedBytes> bytes{};
  const CanFrame sent = fd_frame();
  CanFrame got;
  const auto before = allocations();
  const std::size_t size = encode_datagram(sent, bytes);
  const bool decoded = decode_datagram(std::span(bytes.data(), size), &got);
  EXPECT_EQ(allocations(), before);
  EXPECT_TRUE(decoded);
}

}  // namespace
}  // namespace limber::test_virtual_frame
