// At rest at a mark an encoder reads the mark, whatever the last bit of the angle.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/nodes/encoder_counts.h"

namespace limber::sim::test_encoder_counts {
namespace {

TEST(EncoderCounts, CountsDownToTheMark) {
  EXPECT_EQ(whole_counts(0.0), 0.0);
  EXPECT_EQ(whole_counts(-1e-13), 0.0) << "1e-17 rad of a turn of 65536 counts";
  EXPECT_EQ(whole_counts(-1e-8), -1.0);
  EXPECT_EQ(whole_counts(0.999), 0.0);
  EXPECT_EQ(whole_counts(std::nextafter(8e6, 0.0)), 8e6) << "where a last bit is 1e-9";
  EXPECT_EQ(whole_counts(-3.5), -4.0);
}

}  // namespace
}  // namespace limber::sim::test_encoder_counts
