// Wrenches in frames: the last axis, the largest number, frames of other kinds, the sensors' bits.
#include <gtest/gtest.h>

#include <limits>

#include "drivers/protocols/limber_ft.h"
#include "drivers/protocols/robotous_rft.h"

namespace limber::test_wrench_edges {
namespace {

constexpr double kFloatMost = std::numeric_limits<float>::max();

TEST(WrenchEdges, EveryAxisOfAFloatFrame) {
  // Numbers whose bytes all differ.
  const WrenchReading reading{{1.1F, -2.3F, 3.7F, -4.9F, 5.3F, -6.1F}, 0x21};
  CanFrame frame;
  ASSERT_TRUE(limber_ft::encode_reply(reading, 7, 0x55, &frame));
  EXPECT_TRUE(frame.bitrate_switch);
  for (std::size_t i = 28; i < 32; ++i) EXPECT_EQ(frame.data[i], 0) << "padding";
  std::uint8_t counter = 0;
  WrenchReading read;
  ASSERT_TRUE(limber_ft::decode_reply(frame, &counter, &read));
  EXPECT_EQ(read.F, reading.F);
  for (bool CanFrame::*kind : {&CanFrame::error, &CanFrame::extended}) {
    CanFrame other = frame;
    other.*kind = true;
    EXPECT_FALSE(limber_ft::decode_reply(other, &counter, &read));
  }
}

TEST(WrenchEdges, WhatIsBeyondFloatsIsTheLargest) {
  CanFrame frame;
  ASSERT_TRUE(limber_ft::encode_reply({{-1e300, 1e300}, 0}, 7, 0x55, &frame));
  std::uint8_t counter = 0;
  WrenchReading read;
  ASSERT_TRUE(limber_ft::decode_reply(frame, &counter, &read));
  EXPECT_EQ(read.F[0], -kFloatMost);
  EXPECT_EQ(read.F[1], kFloatMost);
}

TEST(WrenchEdges, FramesOfOtherKindsAreNoRobotousFrames) {
  const CanFrame request = robotous_rft::encode_request(100);
  ASSERT_TRUE(robotous_rft::decode_request(request, 100));
  for (bool CanFrame::*kind :
       {&CanFrame::error, &CanFrame::extended, &CanFrame::remote, &CanFrame::fd}) {
    CanFrame other = request;
    other.*kind = true;
    EXPECT_FALSE(robotous_rft::decode_request(other, 100));
  }
}

// RFT40: 50 counts a newton and 2000 a newton metre.
TEST(WrenchEdges, DefaultsAndBits) {
  robotous_rft::Scale scale;
  EXPECT_EQ(scale.counts_per_N, 50.0);
  EXPECT_EQ(scale.counts_per_Nm, 2000.0);
  EXPECT_EQ(WrenchReading{}.overload, 0);
  int bits[6] = {};
  for (std::size_t axis = 0; axis < 6; ++axis) bits[axis] = overload_bit(axis);
  const int expected[6] = {0x20, 0x10, 0x08, 0x04, 0x02, 0x01};
  for (std::size_t axis = 0; axis < 6; ++axis) EXPECT_EQ(bits[axis], expected[axis]);
}

}  // namespace
}  // namespace limber::test_wrench_edges
