// The hand's law against closed forms, and against a mass that it moves.
#include <gtest/gtest.h>

#include <cmath>

#include "controller/hand/hand_law.h"
#include "controller/output/torque_limiter.h"

namespace limber::controller::test_hand_law {
namespace {

constexpr double kPeriod_s = 1e-3;

/// 80 mm over -1 rad, and half as steep beyond 40 mm.
HandConfig hand() {
  HandConfig hand;
  hand.travel.count = 3;
  hand.travel.points[0] = {0.0, 0.0};
  hand.travel.points[1] = {0.04, -0.5};
  hand.travel.points[2] = {0.08, -1.5};
  hand.stiffness_N_per_m = 2000.0;
  hand.damping_Ns_per_m = 40.0;
  hand.force_limit_N = 60.0;
  hand.hold_force_N = 20.0;
  hand.speed_limit_m_per_s = 0.2;
  hand.rated_torque_Nm = 2.0;
  hand.heat_time_constant_s = 10.0;
  hand.drive.drive.peak_torque_Nm = 6.0;
  hand.drive.torque_limit_Nm = 4.8;
  hand.drive.torque_rate_limit_Nm_per_s = 500.0;
  return hand;
}

HandReading at_width(const HandConfig& hand, double width, double speed = 0.0) {
  const double angle = hand.travel.angle(width);
  return {angle, speed / hand.travel.slope(angle)};
}

TEST(HandTravel, InvertsItselfAndHasItsSlopes) {
  const HandTravel travel = hand().travel;
  for (const double width : {0.0, 0.01, 0.04, 0.05, 0.08, -0.01, 0.09})
    EXPECT_NEAR(travel.width(travel.angle(width)), width, 1e-15);
  EXPECT_DOUBLE_EQ(travel.slope(-0.2), -0.08);
  EXPECT_DOUBLE_EQ(travel.slope(-1.0), -0.04);
  EXPECT_DOUBLE_EQ(travel.steepest(), 0.08);
  EXPECT_DOUBLE_EQ(travel.flattest(), 0.04);
}

TEST(HandHeat, IsWarmWhenTheClosedFormSays) {
  constexpr double kTorque = 5.0;
  constexpr double kT = 10.0;
  HandHeat heat(2.0, 6.0, kT);
  double warm_s = 0.0;
  while (!heat.warm()) {
    heat.add(kTorque, kPeriod_s);
    warm_s += kPeriod_s;
    ASSERT_LT(warm_s, 100.0);
  }
  const double expected_s = -kT * std::log(1.0 - HandHeat::kWarm * std::pow(2.0 / kTorque, 2));
  EXPECT_NEAR(warm_s, expected_s, 2.0 * kPeriod_s);
}

TEST(HandHeat, TorqueAtItsBoundSettlesAtTheRatedOne) {
  HandHeat heat(2.0, 6.0, 10.0);
  double last = heat.bound();
  for (int i = 0; i < 600'000; ++i) {
    const double torque = heat.bound();
    EXPECT_LE(last - torque, 0.02) << "the bound jumps";
    last = torque;
    heat.add(torque, kPeriod_s);
    ASSERT_LE(heat.heat(), 1.0 + 1e-9);
  }
  EXPECT_NEAR(heat.bound(), 2.0, 1e-3);
}

TEST(HandLaw, PressesABlockedFingerWithItsForceBySlopeOfTheTable) {
  for (const double width : {0.02, 0.06}) {
    HandConfig config = hand();
    config.hold_force_N = 60.0;
    HandLaw law(config);
    const HandReading at = at_width(config, width);
    law.begin(at, 0.0);
    law.set_goal({0.0, 30.0, 0.2});
    double torque = 0.0;
    for (int i = 0; i < 1000; ++i) {
      const double next = law.step(at, kPeriod_s);
      EXPECT_LE(std::abs(next - torque), kShareOfGateStep * 500.0 * kPeriod_s * (1.0 + 1e-12));
      torque = next;
    }
    EXPECT_DOUBLE_EQ(torque, -30.0 * config.travel.slope(at.angle_rad)) << width;
  }
}

TEST(HandLaw, FollowsItsRampADampersWayBehind) {
  const HandConfig config = hand();
  constexpr double kMass = 0.3;
  constexpr double kSpeed = 0.05;
  HandLaw law(config);
  double w = 0.035;
  double v = 0.0;
  law.begin(at_width(config, w), 0.0);
  law.set_goal({0.0, 60.0, kSpeed});
  for (int i = 0; i < 500; ++i) {
    const HandReading at = at_width(config, w, v);
    const double force = law.step(at, kPeriod_s) / config.travel.slope(at.angle_rad);
    v += force / kMass * kPeriod_s;
    w += v * kPeriod_s;
  }
  EXPECT_NEAR(v, -kSpeed, 1e-4);
  const double lag = config.damping_Ns_per_m * kSpeed / config.stiffness_N_per_m;
  EXPECT_NEAR(w - law.target_m(), lag, 0.06 * lag);  // the target is a step ahead
}

TEST(HandLaw, FallsToItsHoldForceOnceItGraspsAndLosesWhatComesFree) {
  const HandConfig config = hand();
  HandLaw law(config);
  const HandReading at = at_width(config, 0.03);
  law.begin(at, 0.0);
  law.set_goal({-0.02, 50.0, 0.2});
  int grasped_after = 0;
  while (!law.grasped() && grasped_after < 1000) {
    law.step(at, kPeriod_s);
    ++grasped_after;
  }
  // 19 mm of target way at 0.2 m/s give 0.8 of the force, then 0.1 s.
  EXPECT_NEAR(grasped_after * kPeriod_s, 0.8 * 50.0 / 2000.0 / 0.2 + 0.1, 0.01);
  double torque = 0.0;
  for (int i = 0; i < 200; ++i) torque = law.step(at, kPeriod_s);
  EXPECT_TRUE(law.grasped());
  EXPECT_FALSE(law.moving());
  EXPECT_DOUBLE_EQ(torque, 20.0 * 0.08);
  law.step(at_width(config, law.target_m() + 0.5e-3), kPeriod_s);
  EXPECT_FALSE(law.grasped());
}

TEST(HandLaw, GraspsNothingWhereItIsClosedAndThinThingsAre) {
  for (const auto& [width, grasped] : {std::pair{-0.0005, false}, {0.0001, false}, {0.001, true}}) {
    const HandConfig config = hand();
    HandLaw law(config);
    const HandReading at = at_width(config, width);
    law.begin(at, 0.0);
    law.set_goal({-HandLaw::kPress_m, 20.0, 0.2});
    for (int i = 0; i < 1000; ++i) law.step(at, kPeriod_s);
    EXPECT_EQ(law.grasped(), grasped) << width;
  }
}

TEST(HandLaw, FingersThatComeFreeCloseWithTheGoalsSpeed) {
  const HandConfig config = hand();
  constexpr double kMass = 0.3;
  HandLaw law(config);
  double w = 0.06;
  double v = 0.0;
  law.begin(at_width(config, w), 0.0);
  law.set_goal({0.0, 40.0, 0.05});
  for (int i = 0; i < 1000; ++i) law.step(at_width(config, w), kPeriod_s);
  double fastest = 0.0;
  double after = 0.0;
  for (int i = 0; i < 700; ++i) {
    const HandReading at = at_width(config, w, v);
    v += law.step(at, kPeriod_s) / config.travel.slope(at.angle_rad) / kMass * kPeriod_s;
    w += v * kPeriod_s;
    fastest = std::max(fastest, -v);
    if (i > 400) after = std::max(after, -v);
  }
  const double lead = 40.0 / config.stiffness_N_per_m + 4e-3;
  EXPECT_LT(fastest, config.stiffness_N_per_m * lead / config.damping_Ns_per_m)
      << "over the way by which the target leads, spring against damper";
  EXPECT_NEAR(after, 0.05, 0.005);
}

TEST(HandLaw, StaysWhereItIsOrWithWhatItHolds) {
  const HandConfig config = hand();
  HandLaw law(config);
  const HandReading at = at_width(config, 0.03);
  law.begin(at, 0.0);
  law.set_goal({0.06, 50.0, 0.1});
  for (int i = 0; i < 20; ++i) law.step(at, kPeriod_s);
  law.stay();
  for (int i = 0; i < 200; ++i) law.step(at, kPeriod_s);
  EXPECT_NEAR(law.target_m(), 0.03 + 0.02 * 0.1, 1e-9);
  law.set_goal({0.0, 50.0, 0.2});
  double torque = 0.0;
  for (int i = 0; i < 500; ++i) torque = law.step(at, kPeriod_s);
  ASSERT_TRUE(law.grasped());
  for (int i = 0; i < 500; ++i) {
    law.stay();
    EXPECT_EQ(law.step(at, kPeriod_s), torque);
  }
}

TEST(HandLaw, TakesOverTheTorquePresent) {
  const HandConfig config = hand();
  const HandReading at = at_width(config, 0.03);
  HandLaw law(config);
  law.begin(at, 1.4);
  double torque = 0.0;
  for (int i = 0; i < 300; ++i) {
    torque = law.step(at, kPeriod_s);
    EXPECT_NEAR(torque, 1.4, 1e-9);
  }
  EXPECT_TRUE(law.grasped()) << "what was held before";
}

}  // namespace
}  // namespace limber::controller::test_hand_law
