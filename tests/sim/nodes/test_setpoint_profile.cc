// Setpoints on their way: times and distances by the formulas of uniform acceleration.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/nodes/setpoint_profile.h"

namespace limber::sim::test_setpoint_profile {
namespace {

constexpr double kStep_s = 1e-3;

/// Time until the goal is reached, up to 20 s; speed and acceleration are within the limits.
double time_to_goal(SetpointProfile* profile, const ProfileGoal& goal, double first_speed = 0.0) {
  profile->aim(goal);
  double time_s = 0.0;
  double before = first_speed;
  while (!profile->complete() && time_s < 20.0) {
    profile->advance(kStep_s);
    time_s += kStep_s;
    const double change = std::abs(profile->velocity() - before);
    // At the end the setpoint is put onto the goal: a step's change more.
    if (!std::isnan(goal.acceleration_limit)) {
      EXPECT_LE(change, 2.0 * goal.acceleration_limit * kStep_s + 1e-12) << time_s;
    }
    if (!std::isnan(goal.velocity_limit)) {
      EXPECT_LE(std::abs(profile->velocity()), goal.velocity_limit + 1e-12) << time_s;
    }
    before = profile->velocity();
  }
  return time_s;
}

TEST(SetpointProfile, WithoutLimitsAtOnce) {
  SetpointProfile profile;
  profile.aim({.position = 2.0, .velocity = 0.5});
  EXPECT_TRUE(profile.complete());
  profile.advance(0.1);
  EXPECT_NEAR(profile.position(), 2.05, 1e-12);
}

// s = a t^2 / 4 for a triangle, s = v t - v^2 / a for a trapezoid.
TEST(SetpointProfile, TriangleAndTrapezoid) {
  for (const double way : {1.0, -1.0, 0.01, -0.3}) {
    SetpointProfile profile;
    EXPECT_NEAR(time_to_goal(&profile, {.position = way, .acceleration_limit = 4.0}),
                2.0 * std::sqrt(std::abs(way) / 4.0), 5e-3);
    EXPECT_EQ(profile.position(), way);
    EXPECT_EQ(profile.velocity(), 0.0);
  }
  SetpointProfile profile;
  EXPECT_NEAR(
      time_to_goal(&profile, {.position = 3.0, .velocity_limit = 1.0, .acceleration_limit = 2.0}),
      3.0 + 0.5, 5e-3);
}

// From rest with a = 2 behind a goal that moves at 0.5 and is 1 ahead: the way to it is that of a
// start at -0.5 in its frame: 0.25 s to lose that, by which it is 0.0625 further, then a triangle.
TEST(SetpointProfile, AMovingGoalIsCaughtUpWith) {
  SetpointProfile profile;
  const double time_s =
      time_to_goal(&profile, {.position = 1.0, .velocity = 0.5, .acceleration_limit = 2.0});
  EXPECT_NEAR(time_s, 0.25 + 2.0 * std::sqrt(1.0625 / 2.0), 1e-2);
  EXPECT_NEAR(profile.position(), 1.0 + 0.5 * time_s, 1e-9);
  EXPECT_EQ(profile.velocity(), 0.5);
}

TEST(SetpointProfile, AChangedMindTurnsRoundWithinTheLimit) {
  SetpointProfile profile;
  profile.aim({.position = 10.0, .acceleration_limit = 2.0});
  for (int i = 0; i < 500; ++i) profile.advance(kStep_s);
  EXPECT_NEAR(profile.velocity(), 1.0, 1e-9);
  time_to_goal(&profile, {.position = 0.0, .acceleration_limit = 2.0}, 1.0);
  EXPECT_EQ(profile.position(), 0.0);
}

TEST(SetpointProfile, StrangeLimitsDoNoHarm) {
  for (const double strange : {0.0, -1.0, 1e300, 1e-300}) {
    SetpointProfile profile;
    profile.aim({.position = 1.0,
                 .velocity = 0.1,
                 .velocity_limit = strange,
                 .acceleration_limit = strange});
    for (int i = 0; i < 1000; ++i) profile.advance(kStep_s);
    profile.advance(0.0);
    EXPECT_TRUE(std::isfinite(profile.position())) << strange;
    EXPECT_TRUE(std::isfinite(profile.velocity())) << strange;
  }
}

}  // namespace
}  // namespace limber::sim::test_setpoint_profile
