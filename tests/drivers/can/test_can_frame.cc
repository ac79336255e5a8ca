#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

#include "drivers/can/can_frame.h"
#include "drivers/can/lockstep_frame.h"

namespace limber::test_can_frame {
namespace {

TEST(FdLength, RoundsUpToTheLengthsOfTheStandard) {
  for (int n = 0; n <= 8; ++n) EXPECT_EQ(fd_length(n), n);
  EXPECT_EQ(fd_length(9), 12);
  EXPECT_EQ(fd_length(12), 12);
  EXPECT_EQ(fd_length(13), 16);
  EXPECT_EQ(fd_length(17), 20);
  EXPECT_EQ(fd_length(21), 24);
  EXPECT_EQ(fd_length(25), 32);
  EXPECT_EQ(fd_length(33), 48);
  EXPECT_EQ(fd_length(49), 64);
  EXPECT_EQ(fd_length(64), 64);
}

TEST(FdLength, RefusesWhatNoFrameCanHold) {
  EXPECT_EQ(fd_length(65), -1);
  EXPECT_EQ(fd_length(-1), -1);
}

CanFrame frame_of(std::uint32_t id, bool extended, bool fd, int length) {
  CanFrame frame;
  frame.id = id;
  frame.extended = extended;
  frame.fd = fd;
  frame.length = static_cast<std::uint8_t>(length);
  return frame;
}

TEST(IsPossible, IdentifiersOfElevenAndTwentyNineBits) {
  EXPECT_TRUE(is_possible(frame_of(0x7FF, false, false, 8)));
  EXPECT_FALSE(is_possible(frame_of(0x800, false, false, 8)));
  EXPECT_TRUE(is_possible(frame_of(0x1FFFFFFF, true, false, 8)));
  EXPECT_FALSE(is_possible(frame_of(0x20000000, true, false, 8)));
}

TEST(IsPossible, LengthsOfBothFormats) {
  EXPECT_FALSE(is_possible(frame_of(1, false, false, 9)));
  EXPECT_TRUE(is_possible(frame_of(1, false, true, 12)));
  EXPECT_FALSE(is_possible(frame_of(1, false, true, 13)));
  EXPECT_TRUE(is_possible(frame_of(1, false, true, 64)));
  EXPECT_FALSE(is_possible(frame_of(1, false, true, 65)));
}

TEST(IsPossible, CombinationsThatDoNotExist) {
  CanFrame frame = frame_of(1, false, true, 8);
  frame.remote = true;
  EXPECT_FALSE(is_possible(frame)) << "FD has no remote frames";
  frame.fd = false;
  EXPECT_TRUE(is_possible(frame));
  frame.error = true;
  EXPECT_FALSE(is_possible(frame));
  frame = frame_of(1, false, false, 8);
  frame.bitrate_switch = true;
  EXPECT_FALSE(is_possible(frame)) << "a classic frame has one bit rate";
}

TEST(Lockstep, NumberIsLittleEndian) {
  const CanFrame frame = lockstep::tick(0x0102030405060708);
  EXPECT_EQ(frame.id, 0x1FFFFFF0U);
  EXPECT_TRUE(frame.extended);
  EXPECT_EQ(frame.length, 8);
  EXPECT_EQ(frame.data[0], 0x08);
  EXPECT_EQ(frame.data[7], 0x01);
  EXPECT_TRUE(is_possible(frame));
}

TEST(Lockstep, NumbersSurvive) {
  for (const std::int64_t seq :
       {std::int64_t{0}, std::int64_t{1}, std::int64_t{-1}, std::int64_t{1} << 40,
        std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()}) {
    EXPECT_EQ(lockstep::sequence(lockstep::tick(seq)), seq);
    EXPECT_EQ(lockstep::sequence(lockstep::tock(seq)), seq);
  }
}

TEST(Lockstep, TickIsNoTockAndNoMotorFrameIsEither) {
  EXPECT_TRUE(lockstep::is_tick(lockstep::tick(5)));
  EXPECT_FALSE(lockstep::is_tock(lockstep::tick(5)));
  EXPECT_TRUE(lockstep::is_tock(lockstep::tock(5)));
  EXPECT_FALSE(lockstep::is_tick(lockstep::tock(5)));
  CanFrame frame = lockstep::tick(5);
  frame.extended = false;
  EXPECT_FALSE(lockstep::is_tick(frame));
  frame = lockstep::tick(5);
  frame.remote = true;
  EXPECT_FALSE(lockstep::is_tick(frame));
  frame = lockstep::tick(5);
  frame.length = 7;
  EXPECT_FALSE(lockstep::is_tick(frame));
}

}  // namespace
}  // namespace limber::test_can_frame
