// The watches of one drive where they begin, at their limits, and after a reset.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "drivers/drive/drive_warning.h"
#include "drivers/drive/torque_watch.h"
#include "drivers/drive/velocity_watch.h"

namespace limber::test_watch_edges {
namespace {

// One step: e = v dt - q' dt, with no time to forget it. Limit: 4 / 4 * 0.5 + 2 * 0.25 at most, at
// rest 0.08 + 2 * 0.25.
constexpr double kLimit = 4.0, kCount = 0.25;
constexpr double kMost = 0.08 + 0.5;
constexpr double kStep_s = 0.0625;

bool contradicts(double moved, double velocity_before, double velocity) {
  VelocityWatch watch(kLimit, kCount);
  watch.add(0.0, velocity_before, 10.0);
  watch.add(moved, velocity, 10.0 + kStep_s);
  return watch.contradicts();
}

TEST(VelocityWatchEdges, AtRestTheLimitIsEightHundredthsAndTwoCounts) {
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

// Beside two counts, 0.08 + 0.07 v_top, whichever of both velocities is the greater, up to 0.5.
TEST(VelocityWatchEdges, TheGreatestSpeedWidensTheLimit) {
  const auto expect = [](double most, double before, double now) {
    const double moved = 0.5 * (before + now) * kStep_s;
    for (const double side : {1.0, -1.0}) {
      EXPECT_FALSE(contradicts(moved + side * (0.5 + most - 1e-9), before, now));
      EXPECT_TRUE(contradicts(moved + side * (0.5 + most + 1e-9), before, now));
    }
  };
  expect(0.08 + 0.07 * 2.0, 0.0, 2.0);
  expect(0.08 + 0.07 * 2.0, 0.0, -2.0);
  expect(0.08 + 0.07 * 2.0 * (1.0 - kStep_s / 0.5), 2.0, 0.0);
  expect(0.08 + 0.07 * 5.9, 0.0, 5.9);
  expect(0.5, 0.0, 6.1);
}

TEST(VelocityWatchEdges, AResetForgetsTheSpeed) {
  VelocityWatch watch(kLimit, kCount);
  watch.add(0.0, 20.0, 0.0);
  watch.reset();
  watch.add(0.0, 0.0, 1.0);
  watch.add(0.6, 0.0, 1.0 + kStep_s);
  EXPECT_TRUE(watch.contradicts());
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
    EXPECT_FALSE(contradicts(sign * 4.0, 0.0));
    EXPECT_TRUE(contradicts(sign * std::nextafter(4.0, 5.0), 0.0));
  }
}

// Margin 0.8 N m: a tenth of 8, and only against the command's direction.
TEST(TorqueWatchEdges, OppositeByATenthOfTheLimit) {
  const auto contradicts = [](double reported, double commanded, double for_s = 0.05) {
    TorqueWatch watch(8.0);
    watch.add(reported, commanded, for_s);
    return watch.contradicts();
  };
  for (double sign : {1.0, -1.0}) {
    EXPECT_FALSE(contradicts(sign * -0.8, sign * 2.0));
    EXPECT_TRUE(contradicts(sign * std::nextafter(-0.8, -1.0), sign * 2.0));
    EXPECT_FALSE(contradicts(sign * 3.9, sign * 2.0)) << "the same direction";
    EXPECT_FALSE(contradicts(sign * 3.9, 0.0)) << "none";
    EXPECT_FALSE(contradicts(sign * -4.5, sign * 2.0, 0.01)) << "not longer";
    EXPECT_TRUE(contradicts(sign * -4.5, sign * 2.0, std::nextafter(0.01, 1.0)));
  }
}

// 3 N m were commanded 15 ms ago: half of them may still come; after 30 ms none.
TEST(TorqueWatchEdges, WhatWasCommandedFadesIn30Ms) {
  const auto contradicts = [](double reported, double for_s) {
    TorqueWatch watch(8.0);
    watch.add(3.0, 3.0, 1e-3);
    watch.add(reported, -1.0, for_s);
    return watch.contradicts();
  };
  EXPECT_FALSE(contradicts(2.299, 0.015));
  EXPECT_TRUE(contradicts(2.301, 0.015));
  for (const double long_s : {0.03, 0.06}) {
    EXPECT_FALSE(contradicts(0.799, long_s));
    EXPECT_TRUE(contradicts(0.801, long_s));
  }
  TorqueWatch watch(8.0);
  watch.add(-3.0, -3.0, 1e-3);
  watch.reset();
  watch.add(-3.0, 1.0, 0.015);
  EXPECT_TRUE(watch.contradicts()) << "a reset forgets it";
}

TEST(TorqueWatchEdges, AnotherBeginningAfterEachFitOfTheDirection) {
  TorqueWatch watch(8.0);
  watch.add(-3.0, 1.0, 0.009);
  watch.add(1.0, 1.0, 1e-3);
  watch.add(-3.0, 1.0, 0.009);
  EXPECT_FALSE(watch.contradicts());
  watch.add(-3.0, 1.0, 0.009);
  EXPECT_TRUE(watch.contradicts());
  watch.reset();
  EXPECT_FALSE(watch.contradicts());
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
  const DriveWarning too_hot{.too_hot = true};
  EXPECT_TRUE(too_hot.any() && too_hot.differs(none) && !too_hot.differs(too_hot));
}

}  // namespace
}  // namespace limber::test_watch_edges
