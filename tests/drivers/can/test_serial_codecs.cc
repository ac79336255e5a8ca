// Bytes by hand: LAWICEL's manual, and the records of Damiao's adapter.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "common/config_error.h"
#include "drivers/can/serial_codec.h"

namespace limber::test_serial_codecs {
namespace {

using Bytes = std::vector<std::uint8_t>;

CanFrame frame_of(std::uint32_t id, bool extended, const Bytes& data) {
  CanFrame frame;
  frame.id = id;
  frame.extended = extended;
  frame.length = static_cast<std::uint8_t>(data.size());
  std::ranges::copy(data, frame.data.begin());
  return frame;
}

Bytes encoded(SerialCodec* codec, const CanFrame& frame) {
  Bytes bytes(SerialCodec::kLongest);
  bytes.resize(codec->encode(frame, bytes));
  return bytes;
}

struct Taken {
  std::vector<CanFrame> frames;
  int refused = 0;
  int garbage = 0;
};

Taken take(SerialCodec* codec, const Bytes& bytes) {
  Taken taken;
  CanFrame frame;
  for (const std::uint8_t byte : bytes) {
    const SerialEvent event = codec->take(byte, &frame);
    if (event == SerialEvent::kFrame) taken.frames.push_back(frame);
    taken.refused += event == SerialEvent::kRefused ? 1 : 0;
    taken.garbage += event == SerialEvent::kGarbage ? 1 : 0;
  }
  return taken;
}

Bytes bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

void expect_same(const CanFrame& a, const CanFrame& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.extended, b.extended);
  EXPECT_EQ(a.remote, b.remote);
  ASSERT_EQ(a.length, b.length);
  EXPECT_TRUE(std::equal(a.data.begin(), a.data.begin() + a.length, b.data.begin()));
}

TEST(Slcan, FramesAreLinesOfText) {
  const auto codec = make_slcan_codec();
  EXPECT_EQ(encoded(codec.get(), frame_of(0x10, false, {0x11, 0x33})), bytes_of("t01021133\r"));
  EXPECT_EQ(encoded(codec.get(), frame_of(0x100, true, {0xFF, 0xAB})),
            bytes_of("T000001002FFAB\r"));
  CanFrame remote = frame_of(0x7FF, false, {});
  remote.remote = true;
  remote.length = 3;
  EXPECT_EQ(encoded(codec.get(), remote), bytes_of("r7FF3\r"));
}

TEST(Slcan, AnswersConfirmRefuseOrAreFrames) {
  const auto codec = make_slcan_codec();
  const Taken taken = take(codec.get(), bytes_of("\rz\rZ\r\at01021133\rT000001002ffab1A2B\r"));
  ASSERT_EQ(taken.frames.size(), 2U);  // the second with a time stamp, in small letters
  expect_same(taken.frames[0], frame_of(0x10, false, {0x11, 0x33}));
  expect_same(taken.frames[1], frame_of(0x100, true, {0xFF, 0xAB}));
  EXPECT_EQ(taken.refused, 1);
  EXPECT_EQ(taken.garbage, 0);
}

TEST(Slcan, DamagedLinesAreCountedAndTheNextIsRead) {
  for (const char* damaged :
       {"t0102113\r", "t010911\r", "tXYZ0\r", "t8000\r", "T2000000000\r", "t0102113311\r", "q\r",
        "t01021133t01021133t01021133t01021133\r", "T00000100\r"}) {
    const auto codec = make_slcan_codec();
    const Taken taken = take(codec.get(), bytes_of(std::string(damaged) + "t0010\r"));
    EXPECT_EQ(taken.garbage, 1) << damaged;
    ASSERT_EQ(taken.frames.size(), 1U) << damaged;
    EXPECT_EQ(taken.frames[0].id, 1U);
  }
}

TEST(Slcan, BitRatesAreLetters) {
  const auto codec = make_slcan_codec();
  EXPECT_EQ(codec->greetings(1'000'000)[1].bytes, "S8\r");
  EXPECT_EQ(codec->greetings(125'000)[1].bytes, "S4\r");
  EXPECT_THROW(codec->greetings(999'999), ConfigError);
}

/// A record of the adapter.
Bytes record(std::uint8_t what, const CanFrame& frame) {
  Bytes bytes = {0xAA, what, static_cast<std::uint8_t>(frame.length | (frame.extended ? 0x40 : 0))};
  for (unsigned i = 0; i < 4; ++i) bytes.push_back(static_cast<std::uint8_t>(frame.id >> (8 * i)));
  bytes.insert(bytes.end(), frame.data.begin(), frame.data.begin() + 8);
  bytes.push_back(0x55);
  return bytes;
}

TEST(DamiaoSerial, AFrameIsARecordOf30Bytes) {
  const auto codec = make_damiao_serial_codec();
  const CanFrame enable = frame_of(0x01, false, {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFC});
  const Bytes wanted = {0x55, 0xAA, 0x1E, 0x03, 0x01, 0,    0,    0,    0x0A, 0,
                        0,    0,    0,    0x01, 0,    0,    0,    0,    8,    0,
                        0,    0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFC, 0};
  EXPECT_EQ(encoded(codec.get(), enable), wanted);
}

TEST(DamiaoSerial, AnswersAreRecordsOf16Bytes) {
  const auto codec = make_damiao_serial_codec();
  const CanFrame state = frame_of(0x11, false, {1, 2, 3, 0xAA, 0x55, 6, 0xAA, 8});
  const CanFrame extended = frame_of(0x028001FD, true, {1, 2, 3, 4, 5, 6, 7, 8});
  Bytes bytes = record(0x11, state);
  std::ranges::copy(record(0x12, state), std::back_inserter(bytes));  // sent
  std::ranges::copy(record(0x02, state), std::back_inserter(bytes));  // not sent
  std::ranges::copy(record(0x11, extended), std::back_inserter(bytes));
  const Taken taken = take(codec.get(), bytes);
  ASSERT_EQ(taken.frames.size(), 2U);
  expect_same(taken.frames[0], state);
  expect_same(taken.frames[1], extended);
  EXPECT_EQ(taken.refused, 1);
  EXPECT_EQ(taken.garbage, 0);
}

TEST(DamiaoSerial, StepIsFoundAgainWhereverItWasLost) {
  const CanFrame state = frame_of(0x11, false, {0xAA, 2, 0x55, 0xAA, 5, 6, 0xAA, 8});
  const Bytes one = record(0x11, state);
  for (std::size_t lost = 1; lost < one.size(); ++lost) {
    const auto codec = make_damiao_serial_codec();
    Bytes bytes(one.begin() + static_cast<std::ptrdiff_t>(lost), one.end());  // its head is lost
    for (int i = 0; i < 4; ++i) std::ranges::copy(one, std::back_inserter(bytes));
    const Taken taken = take(codec.get(), bytes);
    EXPECT_GE(taken.frames.size(), 3U) << lost;
    expect_same(taken.frames.back(), state);
    EXPECT_GE(taken.garbage, 1) << lost;
  }
}

TEST(SerialCodecs, AMillionRandomBytesMakeNoImpossibleFrame) {
  std::minstd_rand random(1);
  for (const auto& codec : {make_slcan_codec(), make_damiao_serial_codec()}) {
    CanFrame frame;
    constexpr std::string_view kLikely = "tTrR0123456789ABCDEF\r\a\xAA\x55\x11";
    for (int i = 0; i < 1'000'000; ++i) {
      const bool likely = random() % 4 != 0;
      const auto byte = likely ? static_cast<std::uint8_t>(kLikely[random() % kLikely.size()])
                               : static_cast<std::uint8_t>(random());
      if (codec->take(byte, &frame) != SerialEvent::kFrame) continue;
      ASSERT_TRUE(is_possible(frame));
      ASSERT_LE(frame.length, 8);
    }
  }
}

}  // namespace
}  // namespace limber::test_serial_codecs
