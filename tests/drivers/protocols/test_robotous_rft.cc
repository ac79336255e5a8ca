// Frames of Robotous RFT sensors, written down by hand from the manual's table.
#include <gtest/gtest.h>

#include <limits>

#include "drivers/protocols/robotous_rft.h"
#include "tests/support/frame_text.h"

namespace limber::robotous_rft::test_robotous_rft {
namespace {

using testing::parse;
using testing::text;

constexpr std::array<std::uint32_t, 2> kIds = {1, 2};
constexpr Scale kScale;

std::string encoded(const WrenchReading& reading, const Scale& scale = kScale) {
  std::array<CanFrame, 2> frames;
  if (!encode_reply(reading, scale, kIds, &frames)) return "refused";
  return text(frames[0]) + " " + text(frames[1]);
}

TEST(RobotousRft, RequestIsOneSampleOutput) {
  const CanFrame request = encode_request(100);
  EXPECT_EQ(text(request), "064#0A00000000000000");
  EXPECT_FALSE(request.fd);
  EXPECT_TRUE(decode_request(request, 100));
  EXPECT_FALSE(decode_request(request, 101));
  EXPECT_FALSE(decode_request(parse("064#0B00000000000000"), 100));
  EXPECT_FALSE(decode_request(parse("064#0A"), 100));
}

// 10 N = 500 = 0x01F4, -10 N = 0xFE0C, 1 N = 0x0032, 0.5 N m = 1000 = 0x03E8, -0.5 N m = 0xFC18, 1
// N m = 2000 = 0x07D0. The fourth value lies astride the frames.
TEST(RobotousRft, WorkedReply) {
  const WrenchReading reading{{10.0, -10.0, 1.0, 0.5, -0.5, 1.0}, 0};
  EXPECT_EQ(encoded(reading), "001#0A01F4FE0C003203 002#E8FC1807D0000000");

  WrenchReading read;
  ASSERT_TRUE(
      decode_reply(parse("001#0A01F4FE0C003203"), parse("002#E8FC1807D0000000"), kScale, &read));
  EXPECT_EQ(read.F, reading.F);
  EXPECT_EQ(read.overload, 0);
}

TEST(RobotousRft, CountsPerUnitAreTheSensors) {
  EXPECT_EQ(encoded({{10.0, 0.0, 0.0, 0.0, 0.0, -1.0}, 0}, {10.0, 1000.0}),
            "001#0A00640000000000 002#000000FC18000000");
}

TEST(RobotousRft, RoundsToTheNearestCount) {
  EXPECT_EQ(encoded({{0.0099, 0.0101, -0.0099, 0.00024, 0.00026, -0.00026}, 0}),
            "001#0A00000001000000 002#000001FFFF000000");
}

TEST(RobotousRft, SaturatesAtSixteenBits) {
  EXPECT_EQ(encoded({{1e3, -1e3, 1e300, 1e3, -1e3, -1e300}, 0}),
            "001#0A7FFF80007FFF7F 002#FF80008000000000");
}

TEST(RobotousRft, OverloadIsTheFourteenthByte) {
  EXPECT_EQ(encoded({{}, static_cast<std::uint8_t>(overload_bit(0) | overload_bit(5))}),
            "001#0A00000000000000 002#0000000000210000");
  WrenchReading read;
  ASSERT_TRUE(
      decode_reply(parse("001#0A00000000000000"), parse("002#0000000000080000"), kScale, &read));
  EXPECT_EQ(read.overload, overload_bit(2));
}

TEST(RobotousRft, RefusesWhatIsNotFinite) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    for (std::size_t axis = 0; axis < 6; ++axis) {
      WrenchReading reading;
      reading.F[axis] = bad;
      EXPECT_EQ(encoded(reading), "refused");
    }
  }
}

TEST(RobotousRft, TakesNothingButTheAnswerToOneSample) {
  const CanFrame first = parse("001#0A01F4FE0C003203");
  const CanFrame second = parse("002#E8FC1807D0000000");
  WrenchReading read{{7.0, 7.0, 7.0, 7.0, 7.0, 7.0}, 7};
  const auto refused = [&](const CanFrame& a, const CanFrame& b) {
    return !decode_reply(a, b, kScale, &read) && read.F[0] == 7.0;
  };
  EXPECT_TRUE(refused(parse("001#0B01F4FE0C003203"), second));  // streamed
  EXPECT_TRUE(refused(parse("001#0A01F4FE0C0032"), second));
  EXPECT_TRUE(refused(first, parse("002#E8FC1807D00000")));
  CanFrame fd = second;
  fd.fd = true;
  EXPECT_TRUE(refused(first, fd));
  CanFrame remote = first;
  remote.remote = true;
  EXPECT_TRUE(refused(remote, second));
}

}  // namespace
}  // namespace limber::robotous_rft::test_robotous_rft
