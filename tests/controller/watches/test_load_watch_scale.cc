// LoadWatch and ScaleWatch together: HOLD, then a law, with motors that make more than they report.
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/controller/watches/load_bench.h"

namespace limber::controller::test_load_watch_scale {
namespace {

using namespace load_bench;

/// HOLD and a law with motors that make `scale` times the torque that they report, and so carry the
/// arm with so much less. Returns how far the first joint gets.
struct Overdriven : Bench {
  explicit Overdriven(double scale) : scale_(scale) {
    g = vector(6.0, 3.0);
    apply(g / scale_);
    for (int k = 0; k < 32; ++k) EXPECT_EQ(next(), -1);
  }
  /// Under a law, with the torque that it reports so many times that in HOLD.
  double moves_until_found(double share = 1.0, double most = 0.2) {
    watch.end();
    apply(share * g / scale_);
    // What it makes more accelerates it.
    const VectorJ a = (share - 1.0) * (M + MatrixJ(B.asDiagonal())).inverse() * g;
    const double start = state.q[0];
    while (watch.overdriven() < 0 && state.q[0] < start + most) {
      state.q[0] += 0.001;
      Eigen::Map<VectorJ>(state.v, 2) += a * kStep_s;
      EXPECT_EQ(next(), -1);
    }
    return state.q[0] - start;
  }
  double scale_;
};

TEST(LoadWatchScale, AMotorThatMakesAMultipleIsFoundOnceItHasMoved) {
  for (const double scale : {1.8, 2.5, 4.0, 10.0}) {
    Overdriven arm(scale);
    EXPECT_EQ(arm.watch.overdriven(), -1) << "a stand may carry it";
    EXPECT_NEAR(arm.moves_until_found(), ScaleWatch::kMovedBy, 0.0011) << scale;
    EXPECT_EQ(arm.watch.overdriven(), 0);
  }
}

TEST(LoadWatchScale, OrOnceItsTorqueHasGrown) {
  EXPECT_LE(Overdriven(4.0).moves_until_found(1.5), 0.0201) << "in a third of a second";
  EXPECT_NEAR(Overdriven(4.0).moves_until_found(1.3), ScaleWatch::kMovedBy, 0.0011);
}

TEST(LoadWatchScale, LessThanTwoFifthsOfTheWeightIsAPoorModel) {
  EXPECT_GE(Overdriven(1.6).moves_until_found(), 0.2) << "3/8 of its weight are missing";
  EXPECT_LE(Overdriven(1.7).moves_until_found(), 0.06);
}

// The law lifts the arm off its stand, or presses it on: either way r / tau is another.
TEST(LoadWatchScale, AStandThatIsLeftBehindIsNone) {
  for (const double share : {1.0, 0.5, -0.2}) {
    Overdriven arm(4.0);  // so much less torque, at first
    arm.watch.end();
    arm.apply(share * arm.g);
    for (int k = 0; k < 64; ++k) {
      arm.state.q[0] += 0.002;
      ASSERT_EQ(arm.next(), -1);
      ASSERT_EQ(arm.watch.overdriven(), -1) << share << " " << k;
    }
    arm.apply(arm.g / 4.0);
    for (int k = 0; k < 64; ++k) arm.next();
    EXPECT_EQ(arm.watch.overdriven(), -1) << "it was a stand, and stays one";
  }
}

TEST(LoadWatchScale, WhatFrictionMayHoldIsNoMultiple) {
  Overdriven arm(4.0);
  arm.watch.begin();
  arm.g = vector(0.6, 0.3);  // three quarters of it are less than the friction
  arm.apply(arm.g / 4.0);
  for (int k = 0; k < 32; ++k) ASSERT_EQ(arm.next(), -1);
  EXPECT_GE(arm.moves_until_found(), 0.2);
}

TEST(LoadWatchScale, AnOverdrivenArmIsCarriedWithWhatCarriedIt) {
  Overdriven arm(4.0);
  arm.moves_until_found();
  for (int k = 0; k < 64; ++k) arm.watch.relax(kStep_s);
  EXPECT_NEAR((arm.watch.carrying(arm.g) - arm.g / 4.0).norm(), 0.0, 1e-3);
  arm.watch.begin();
  EXPECT_EQ(arm.watch.overdriven(), -1);
}

/// The cycle under a law in which an arm that moved after so many is found; 0: in none of 400.
int found_in(Bench* arm, int moves_after) {
  arm->watch.end();
  for (int k = 1; k <= 400; ++k) {
    if (k > moves_after) arm->state.q[0] = arm->state.q[1] = 0.1;
    EXPECT_EQ(arm->next(), -1);
    if (arm->watch.overdriven() >= 0) return k;
    arm->watch.end();
  }
  return 0;
}

TEST(LoadWatchScale, IsFollowedForFiveSeconds) {
  Overdriven in_time(4.0);
  EXPECT_EQ(found_in(&in_time, 319), 320);
  Overdriven too_late(4.0);
  EXPECT_EQ(found_in(&too_late, 320), 0) << "by then nobody remembers HOLD";
  too_late.watch.begin();
  too_late.state.q[0] = too_late.state.q[1] = 0.0;
  for (int k = 0; k < 32; ++k) ASSERT_EQ(too_late.next(), -1);
  EXPECT_EQ(found_in(&too_late, 319), 320) << "the next time anew";
}

// After a second of HOLD r has faded; an eighth of a second later it is there again.
TEST(LoadWatchScale, IsJudgedOnceTheEstimateHasSettled) {
  Overdriven arm(4.0);
  for (int k = 0; k < 64; ++k) ASSERT_EQ(arm.next(), -1);
  EXPECT_NEAR(arm.watch.residual().norm(), 0.0, 1e-6);
  EXPECT_EQ(found_in(&arm, 0), 8);
}

TEST(LoadWatchScale, HoldOfLessThanAnEighthOfASecondTellsNothing) {
  for (const int steps : {7, 8}) {
    Bench arm;
    arm.g = vector(6.0, 3.0);
    arm.apply(arm.g / 4.0);
    for (int k = 0; k < steps; ++k) ASSERT_EQ(arm.next(), -1);
    EXPECT_EQ(found_in(&arm, 0), steps == 8 ? 8 : 0) << steps;
  }
}

TEST(LoadWatchScale, NothingIsLeftOfAnEarlierHold) {
  Overdriven arm(4.0);
  arm.watch.begin();
  EXPECT_EQ(found_in(&arm, 0), 0);
}

TEST(LoadWatchScale, WhereNothingIsSuspectedTheEstimateFades) {
  Bench arm;
  arm.apply(0.9 * arm.g);
  for (int k = 0; k < 32; ++k) ASSERT_EQ(arm.next(), -1);
  EXPECT_GT(arm.watch.residual().norm(), 0.1);
  arm.watch.end();
  for (int k = 0; k < 64; ++k) ASSERT_EQ(arm.next(), -1);
  EXPECT_NEAR(arm.watch.residual().norm(), 0.0, 1e-6);
  Overdriven never_moved(4.0);
  for (int k = 0; k < 64; ++k) never_moved.next();
  EXPECT_NEAR(never_moved.watch.residual().norm(), 0.0, 1e-6) << "in HOLD nothing is followed";
}

TEST(LoadWatchScale, AnArmThatIsOnlySuspectedIsCarriedWithItsWeight) {
  Overdriven arm(4.0);
  EXPECT_NEAR((arm.watch.carrying(arm.g) - arm.g / 4.0).norm(), 0.0, 1e-3);
  EXPECT_EQ(found_in(&arm, 400), 0);
  EXPECT_NEAR((arm.watch.carrying(arm.g) - arm.g).norm(), 0.0, 1e-9);
  Overdriven followed(4.0);
  followed.watch.end();
  for (int k = 0; k < 64; ++k) followed.next();
  EXPECT_NEAR((followed.watch.carrying(followed.g) - followed.g).norm(), 0.0, 1e-9);
}

TEST(LoadWatchScale, NotInItsWallNorBehindASensor) {
  Overdriven in_wall(4.0);
  in_wall.watch.begin();
  in_wall.walls = vector(1e-3, -1e-3);
  for (int k = 0; k < 32; ++k) ASSERT_EQ(in_wall.next(), -1);
  EXPECT_EQ(found_in(&in_wall, 0), 0);
  Overdriven into_wall(4.0);
  into_wall.walls = vector(1e-3, -1e-3);
  ASSERT_EQ(into_wall.next(), -1);
  EXPECT_EQ(found_in(&into_wall, 0), 0) << "the last cycle of HOLD counts";
  Robot robot = two_joints();
  for (JointConfig& joint : robot.joints) {
    joint.torque_sensor.present = true;
    joint.transmission.kind = TransmissionKind::kElastic;
  }
  Bench sensed(robot);
  sensed.g = vector(6.0, 3.0);
  Eigen::Map<VectorJ>(sensed.state.tau, 2) = sensed.g / 4.0;
  for (int k = 0; k < 32; ++k) ASSERT_EQ(sensed.next(), -1);
  EXPECT_EQ(found_in(&sensed, 0), 0);
}

TEST(LoadWatchScale, TheSecondJointIsFoundAsWell) {
  Overdriven arm(4.0);
  arm.watch.end();
  arm.state.q[1] = 0.1;
  for (int k = 0; k < 8; ++k) ASSERT_EQ(arm.next(), -1);
  EXPECT_EQ(arm.watch.overdriven(), 1);
}

}  // namespace
}  // namespace limber::controller::test_load_watch_scale
