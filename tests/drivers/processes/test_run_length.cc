// When a run ends: cycles, arm time, or never.
#include <gtest/gtest.h>

#include "drivers/processes/run_length.h"

namespace limber::test_run_length {
namespace {

TEST(RunLengthTest, WithoutLimitsItNeverEnds) {
  EXPECT_FALSE(RunLength().reached(1'000'000'000, 1e9));
}

TEST(RunLengthTest, CyclesAndTimeEachEndIt) {
  const RunLength length{100, 0.05};
  EXPECT_FALSE(length.reached(49, 0.049));
  EXPECT_TRUE(length.reached(50, 0.05));
  EXPECT_TRUE(length.reached(100, 0.01));
  EXPECT_FALSE(length.reached(99, 0.01));
}

// 1000 cycles of 1 ms, summed up in doubles, may end just below 1 s: it is the end all the same.
TEST(RunLengthTest, ForgivesRoundingOfTheTime) {
  EXPECT_TRUE((RunLength{0, 1.0}.reached(1000, 1.0 - 1e-10)));
  EXPECT_FALSE((RunLength{0, 1.0}.reached(999, 0.999)));
}

}  // namespace
}  // namespace limber::test_run_length
