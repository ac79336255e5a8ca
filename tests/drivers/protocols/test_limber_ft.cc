// limber's own force/torque frames on CAN-FD, written down by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "drivers/protocols/limber_ft.h"
#include "tests/support/frame_text.h"

namespace limber::limber_ft::test_limber_ft {
namespace {

using testing::text;

// float32: 1 = 3F800000, -2 = C0000000, 0.5 = 3F000000, 10 = 41200000, -0.25 = BE800000.
const WrenchReading kReading{{1.0, -2.0, 0.5, 10.0, -0.25, 0.0}, 0x08};
constexpr const char* kReply =
    "055#0A2A0800"
    "0000803F"
    "000000C0"
    "0000003F"
    "00002041"
    "000080BE"
    "00000000"
    "00000000";

CanFrame reply() {
  CanFrame frame;
  EXPECT_TRUE(encode_reply(kReading, 0x2A, 0x55, &frame));
  return frame;
}

TEST(LimberFt, Request) {
  const CanFrame request = encode_request(0x54, 0x2A);
  EXPECT_EQ(text(request), "054#0A2A");
  EXPECT_TRUE(request.fd);
  std::uint8_t counter = 0;
  EXPECT_TRUE(decode_request(request, 0x54, &counter));
  EXPECT_EQ(counter, 0x2A);
  EXPECT_FALSE(decode_request(request, 0x55, &counter));
  CanFrame classic = request;
  classic.fd = false;
  EXPECT_FALSE(decode_request(classic, 0x54, &counter));
}

TEST(LimberFt, WorkedReply) {
  EXPECT_EQ(text(reply()), kReply);
  EXPECT_TRUE(reply().fd);
  std::uint8_t counter = 0;
  WrenchReading read;
  ASSERT_TRUE(decode_reply(reply(), &counter, &read));
  EXPECT_EQ(counter, 0x2A);
  EXPECT_EQ(read.F, kReading.F);
  EXPECT_EQ(read.overload, 0x08);
}

TEST(LimberFt, ErrorIsThatOfFloat32) {
  WrenchReading reading;
  reading.F[0] = 123.456789012345;
  CanFrame frame;
  ASSERT_TRUE(encode_reply(reading, 0, 1, &frame));
  std::uint8_t counter = 0;
  WrenchReading read;
  ASSERT_TRUE(decode_reply(frame, &counter, &read));
  EXPECT_NE(read.F[0], reading.F[0]);
  EXPECT_NEAR(read.F[0], reading.F[0], std::ldexp(reading.F[0], -24));
}

TEST(LimberFt, WhatIsNotFinitePassesNeitherWay) {
  CanFrame frame;
  WrenchReading bad = kReading;
  bad.F[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(encode_reply(bad, 0, 1, &frame));

  for (const char* raw : {"0000C07F", "0000807F", "000080FF"}) {  // nan, inf, -inf
    frame = reply();
    const CanFrame value = testing::parse(std::string("0#") + raw);
    for (std::size_t i = 0; i < 4; ++i) frame.data[8 + i] = value.data[i];
    std::uint8_t counter = 7;
    WrenchReading read;
    EXPECT_FALSE(decode_reply(frame, &counter, &read)) << raw;
    EXPECT_EQ(counter, 7);
    EXPECT_EQ(read.F, SixAxes{});
  }
}

TEST(LimberFt, SaturatesAtFloat32) {
  WrenchReading reading;
  reading.F[0] = 1e300;
  CanFrame frame;
  ASSERT_TRUE(encode_reply(reading, 0, 1, &frame));
  EXPECT_EQ(text(frame).substr(12, 8), "FFFF7F7F");
}

TEST(LimberFt, TakesNoOtherFrame) {
  std::uint8_t counter = 0;
  WrenchReading read;
  CanFrame classic = reply();
  classic.fd = false;
  CanFrame shorter = reply();
  shorter.length = 24;
  CanFrame other = reply();
  other.data[0] = 0x0B;
  for (const CanFrame& frame : {classic, shorter, other})
    EXPECT_FALSE(decode_reply(frame, &counter, &read));
}

}  // namespace
}  // namespace limber::limber_ft::test_limber_ft
