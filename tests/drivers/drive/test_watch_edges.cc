// The watches of one drive where they begin, at their limits, and after a reset.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "drivers/drive/drive_warning.h"
#include "drivers/drive/torque_watch.h"
#include "drivers/drive/velocity_watch.h"

namespace limber::test_watch_edges {
namespace {

// One step of 10 ms: e = v dt - q' dt, with no time to forget it. Limit: 4 / 4 * 0.5 + 2 * 0.25.
constexpr double kLimit = 4.0, kCount = 0.25;
constexpr double kMost = 1.0;
constexpr double kStep_s = 0.0625;

bool contradicts(double moved, double velocity_before, double velocity) {
  VelocityWatch watch(kLimit, kCount);
  watch.add(0.0, velocity_before, 10.0);
  watch.add(moved, velocity, 10.0 + kStep_s);
  return watch.contradicts();
}

TEST(VelocityWatchEdges, TheLimitIsAQuarterOfTheFastestAndTwoCounts) {
  EXPECT_FALSE(contradicts(kMost, 0.0, 0.0));
  EXPECT_FALSE(contradicts(-kMost, 0.0, 0.0));
  EXPECT_TRUE(contradicts(std::nextafter(kMost, 2.0), 0.0, 0.0));
  EXPECT_TRUE(contradicts(-std::nextafter(kMost, 2.0), 0.0, 0.0));
}

TEST(VelocityWatchEdges, TheMeanOfBothVelocitiesCounts) {
  // (12 + 20) / 2 * 0.0625 s = 1 rad
  EXPECT_FALSE(contradicts(2.0, 12.0, 20.0));
  EXPECT_TRUE(contradicts(2.0 + 1e-9, 12.0, 20.0));
  EXPECT_FALSE(contradicts(0.0, 12.0, 20.0));
  EXPECT_TRUE(contradicts(-1e-9, 12.0, 20.0));
}

TEST(VelocityWatchEdges, TheFirstStateIsComparedWithNothing) {
  VelocityWatch watch(kLimit, kCount);
  EXPECT_FALSE(watch.contradicts());
  watch.add(100.0, 0.0, 5.0);
  EXPECT_FALSE(watch.contradicts());
  watch.reset();
  watch.add(-100.0, 0.0, 6.0);
  EXPECT_FALSE(watch.contradicts()) << "nor the first after a reset";
}

TEST(VelocityWatchEdges, AResetForgetsWhatHasAddedUp) {
  VelocityWatch watch(kLimit, kCount);
  watch.add(0.0, 0.0, 0.0);
  watch.add(2.0, 0.0, kStep_s);
  ASSERT_TRUE(watch.contradicts());
  watch.reset();
  EXPECT_FALSE(watch.contradicts());
  watch.add(2.0, 0.0, 2.0 * kStep_s);
  EXPECT_FALSE(watch.contradicts());
}

TEST(VelocityWatchEdges, AStateOfTheSameTimeAddsNothing) {
  VelocityWatch watch(kLimit, kCount);
  watch.add(0.0, 0.0, 1.0);
  watch.add(50.0, 0.0, 1.0);
  EXPECT_FALSE(watch.contradicts());
}

// After tau nothing is left of what was, however long ago.
TEST(VelocityWatchEdges, HalfASecondIsRemembered) {
  for (const double pause_s : {0.25, 0.5, 0.75}) {
    VelocityWatch watch(kLimit, kCount);
    watch.add(0.0, 0.0, 0.0);
    watch.add(3.0, 0.0, kStep_s);            // e = -3
    watch.add(3.0, 0.0, kStep_s + pause_s);  // e = -3 (1 - pause / 0.5 s)
    EXPECT_EQ(watch.contradicts(), pause_s < 0.3) << pause_s;
  }
}

// Margin 4 N m: half of 8. The time of a dyadic step, so that the sum is exact: 0.1 s lie between.
TEST(TorqueWatchEdges, HalfTheLimitBeyondTheCommandOrZero) {
  const auto contradicts = [](double reported, double commanded) {
    TorqueWatch watch(8.0);
    watch.add(reported, commanded, 0.2);
    return watch.contradicts();
  };
  for (double sign : {1.0, -1.0}) {
    EXPECT_FALSE(contradicts(sign * 6.0, sign * 2.0));
    EXPECT_TRUE(contradicts(sign * std::nextafter(6.0, 7.0), sign * 2.0));
    EXPECT_FALSE(contradicts(sign * 4.0, sign * -2.0));
    EXPECT_TRUE(contradicts(sign * std::nextafter(4.0, 5.0), sign * -2.0));
  }
}

TEST(TorqueWatchEdges, LongerThanATenthOfASecondWithoutABreak) {
  TorqueWatch watch(8.0);
  EXPECT_FALSE(watch.contradicts());
  watch.add(9.0, 0.0, 0.1);
  EXPECT_FALSE(watch.contradicts()) << "not longer";
  watch.add(9.0, 0.0, 1e-9);
  EXPECT_TRUE(watch.contradicts());
  watch.add(0.0, 0.0, 1e-3);
  EXPECT_FALSE(watch.contradicts());
  watch.add(9.0, 0.0, 0.2);
  ASSERT_TRUE(watch.contradicts());
  watch.reset();
  EXPECT_FALSE(watch.contradicts());
}

TEST(DriveWarningEdges, AnyAndAnother) {
  const DriveWarning none;
  EXPECT_FALSE(none.any() || none.differs({}));
  EXPECT_EQ(none.temperature_degC, 0);
  const DriveWarning warnings[] = {{true, false, 0, 0}, {false, true, 0, 0}, {false, false, 1, 0}};
  for (const DriveWarning& warning : warnings) {
    EXPECT_TRUE(warning.any());
    EXPECT_TRUE(warning.differs(none));
    EXPECT_FALSE(warning.differs(warning));
  }
  EXPECT_FALSE(none.differs({false, false, 0, 90})) << "a temperature alone is none";
}

}  // namespace
}  // namespace limber::test_watch_edges
