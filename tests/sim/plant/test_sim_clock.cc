// Simulated time in steps that need not be whole nanoseconds.
#include <gtest/gtest.h>

#include "sim/plant/sim_clock.h"

namespace limber::sim::test_sim_clock {
namespace {

TEST(SimClock, PeriodsHaveNoRoundingThatAddsUp) {
  SimClock clock(1000.0, 3);  // 333,333.3 ns a step
  EXPECT_DOUBLE_EQ(clock.step_s(), 1e-3 / 3.0);
  EXPECT_EQ(clock.next_ns(), 333'333);
  for (int i = 0; i < 3 * 1000; ++i) clock.advance();
  EXPECT_EQ(clock.now_ns(), 1'000'000'000);
  EXPECT_EQ(clock.periods(), 1000);
  clock.advance();
  clock.advance();
  EXPECT_EQ(clock.now_ns(), 1'000'666'666);
  EXPECT_EQ(clock.periods(), 1000);
}

TEST(SimClock, ArmTimePassesWithSimulatedTime) {
  SimClock clock(1000.0, 4);
  clock.advance();
  EXPECT_FALSE(clock.arm_time_known());
  clock.set_arm_time_ns(7'000'000'000);
  EXPECT_TRUE(clock.arm_time_known());
  EXPECT_EQ(clock.arm_time_ns(), 7'000'000'000);
  clock.advance();
  EXPECT_EQ(clock.arm_time_ns(), 7'000'250'000);
}

}  // namespace
}  // namespace limber::sim::test_sim_clock
