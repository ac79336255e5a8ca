// Frame lengths against the standard's worst cases and against frames whose length other people's
// tools report.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>

#include "drivers/can/frame_time.h"

namespace limber::test_frame_time {
namespace {

constexpr double kClassic = 1e6;
constexpr double kFast = 5e6;

CanFrame parse(const std::string& candump) {
  CanFrame frame;
  const auto hash = candump.find('#');
  frame.id = static_cast<std::uint32_t>(std::stoul(candump.substr(0, hash), nullptr, 16));
  frame.extended = hash > 3;
  for (std::size_t i = hash + 1; i + 1 < candump.size(); i += 2) {
    frame.data[frame.length++] =
        static_cast<std::uint8_t>(std::stoul(candump.substr(i, 2), nullptr, 16));
  }
  return frame;
}

double classic_bits(int bytes, bool extended) {
  return worst_frame_time_s(bytes, extended, false, kClassic, kFast) * kClassic;
}
double fd_microseconds(int bytes, bool extended) {
  return worst_frame_time_s(bytes, extended, true, kClassic, kFast) * 1e6;
}

TEST(WorstFrameTime, Classic) {
  constexpr std::array kBits = {55, 65, 75, 85, 95, 105, 115, 125, 135};
  for (int n = 0; n <= 8; ++n)
    EXPECT_NEAR(classic_bits(n, false), kBits[static_cast<std::size_t>(n)], 1e-9);
  EXPECT_NEAR(classic_bits(8, true), 160, 1e-9);
  EXPECT_NEAR(worst_frame_time_s(8, false, false, 500e3, kFast), 270e-6, 1e-12);
}

TEST(WorstFrameTime, Fd) {
  constexpr std::array kBytes = {8, 12, 16, 20, 24, 32, 48, 64};
  constexpr std::array kStandard_us = {57, 65, 73, 82, 90, 106, 138, 170};
  constexpr std::array kExtended_us = {80, 88, 96, 105, 113, 129, 161, 193};
  for (std::size_t i = 0; i < kBytes.size(); ++i) {
    EXPECT_EQ(std::lround(fd_microseconds(kBytes[i], false)), kStandard_us[i]) << kBytes[i];
    EXPECT_EQ(std::lround(fd_microseconds(kBytes[i], true)), kExtended_us[i]) << kBytes[i];
  }
  EXPECT_EQ(fd_microseconds(9, false), fd_microseconds(12, false)) << "FD frames come in steps";
}

// Lengths as reported by canbusload -e.
TEST(FrameTime, OfRealClassicFrames) {
  EXPECT_EQ(classic_frame_bits(parse("001#7FFF7FF0000007FF")), 126);
  EXPECT_EQ(classic_frame_bits(parse("011#1180007FF7FF231F")), 121);
  EXPECT_NEAR(classic_frame_bits(parse("04E#0000A03F")), 86, 1);
  EXPECT_NEAR(frame_time_s(parse("001#7FFF7FF0000007FF"), 500e3, kFast), 252e-6, 1e-12);
}

TEST(FrameTime, ARemoteFrameCarriesNoData) {
  CanFrame frame = parse("123#0102030405060708");
  frame.remote = true;
  EXPECT_GE(classic_frame_bits(frame), 47);
  EXPECT_LE(classic_frame_bits(frame), 55);
}

TEST(FrameTime, AnErrorMessageIsNoFrameOnTheBus) {
  CanFrame frame = parse("040#0000000000000000");
  frame.error = true;
  EXPECT_EQ(frame_time_s(frame, kClassic, kFast), 0.0);
}

TEST(FrameTime, LiesBetweenNoStuffingAndTheWorstCase) {
  std::mt19937 random(1);
  double sum = 0.0;
  constexpr int kFrames = 20'000;
  for (int i = 0; i < kFrames; ++i) {
    CanFrame frame;
    frame.extended = (i & 1) != 0;
    frame.id = random() & (frame.extended ? kExtendedIdMax : kStandardIdMax);
    frame.length = 8;
    for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random());
    const int bits = classic_frame_bits(frame);
    ASSERT_GE(bits, frame.extended ? 131 : 111);
    ASSERT_LE(bits, frame.extended ? 160 : 135);
    if (!frame.extended) sum += bits;
    frame.fd = frame.bitrate_switch = true;
    ASSERT_LE(frame_time_s(frame, kClassic, kFast),
              worst_frame_time_s(8, frame.extended, true, kClassic, kFast) + 1e-12);
    ASSERT_GE(frame_time_s(frame, kClassic, kFast),
              (frame.extended ? 49e-6 + 19e-6 : 49e-6) - 0.5e-6);
  }
  EXPECT_NEAR(sum / (kFrames / 2), 115, 1) << "average of random 8-byte frames";
}

/// The standard's text bit by bit: the frame as a word of zeros and ones up to the end of the CRC.
std::string written_out(const CanFrame& frame) {
  const auto binary = [](std::uint32_t value, int bits) {
    std::string word;
    while (bits-- > 0) word += (value >> static_cast<unsigned>(bits) & 1U) != 0 ? '1' : '0';
    return word;
  };
  std::string word = "0" + binary(frame.id, 11) + "000" + binary(frame.length, 4);
  for (std::size_t i = 0; i < frame.length; ++i) word += binary(frame.data[i], 8);
  // The remainder of the division by x^15 + x^14 + x^10 + x^8 + x^7 + x^4 + x^3 + 1.
  const std::string divisor = "1100010110011001";
  std::string rest = word + std::string(15, '0');
  for (std::size_t i = 0; i < word.size(); ++i) {
    if (rest[i] == '0') continue;
    for (std::size_t k = 0; k < divisor.size(); ++k)
      rest[i + k] = rest[i + k] == divisor[k] ? '0' : '1';
  }
  word += rest.substr(word.size());
  for (std::size_t i = 0; i + 5 <= word.size(); ++i) {
    const std::string five = word.substr(i, 5);
    if (five != "00000" && five != "11111") continue;
    word.insert(i + 5, five == "00000" ? "1" : "0");
    i += 4;
  }
  return word;
}

TEST(FrameTime, OfRandomFramesIsTheirBitsWrittenOut) {
  std::mt19937 random(2);
  for (int i = 0; i < 5'000; ++i) {
    CanFrame frame;
    frame.id = random() & kStandardIdMax;
    frame.length = static_cast<std::uint8_t>(random() % 9);
    const std::uint32_t mask = (i & 1) != 0 ? random() & random() & random() : random();
    for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random() & mask);
    // Delimiter, acknowledge slot and delimiter, end of frame, gap.
    ASSERT_EQ(classic_frame_bits(frame), static_cast<int>(written_out(frame).size()) + 13) << i;
  }
}

// Runs of equal bits are the worst case where stuffing is known by hand: alternating data needs
// none.
TEST(FrameTime, FdStuffingByHand) {
  CanFrame frame = parse("555#AAAAAAAAAAAAAAAA");
  frame.fd = frame.bitrate_switch = true;
  // 0 10101010101 0 0 1 0 1 | 0 1000 1010... : no five equal bits, so 17 + 13 slow and 5 + 64 + 4 +
  // 23 fast ones.
  EXPECT_NEAR(frame_time_s(frame, kClassic, kFast), 30e-6 + 96.0 / 5e6, 1e-12);
  frame.data.fill(0);
  // Fast bits: 0 1000 and 64 zeros, so 67 zeros in a row. Every five of them are followed by a
  // stuff bit, which is a one and starts the count anew: 13.
  EXPECT_NEAR(frame_time_s(frame, kClassic, kFast), 30e-6 + (96.0 + 13) / 5e6, 1e-12);
  for (std::size_t i = 0; i < 8; ++i) frame.data[i] = i == 0 ? 0xF8 : 0x78;
  // Five ones, a stuff bit 0; it and the four zeros that follow are five, a stuff bit 1; and so on,
  // fourteen times more.
  EXPECT_NEAR(frame_time_s(frame, kClassic, kFast), 30e-6 + (96.0 + 15) / 5e6, 1e-12);
  frame.data.fill(0);
  frame.bitrate_switch =
      false;  // the switch bit becomes 0 and joins the error state bit: no run of five
  EXPECT_NEAR(frame_time_s(frame, kClassic, kFast), (30 + 96.0 + 13) / 1e6, 1e-12);
}

}  // namespace
}  // namespace limber::test_frame_time
