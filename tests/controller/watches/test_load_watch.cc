// What carries the arm besides its motors: the estimate in closed form, and how much of it a
// payload, friction and a stand explain.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "tests/controller/watches/load_bench.h"

namespace limber::controller::test_load_watch {
namespace {

using namespace load_bench;

TEST(LoadWatch, FollowsATorqueFromOutsideWithTheMemoryAsTimeConstant) {
  Bench bench;
  const VectorJ outside = vector(0.4, -0.2);
  bench.apply(bench.g - outside);
  bench.next(1e-3);
  for (int k = 1; k <= 100; ++k) {
    ASSERT_EQ(bench.next(1e-3), -1);
    const double share = 1.0 - std::pow(1.0 - 1e-3 / LoadWatch::kMemory_s, k);
    ASSERT_NEAR((bench.watch.residual() - share * outside).norm(), 0.0, 1e-12) << k;
  }
}

// (M + diag(B)) a + C v + g = tau: nothing acts from outside.
TEST(LoadWatch, TheMotionThatTheMotorsMakeIsExplained) {
  Bench bench;
  bench.Cv = vector(0.3, -0.4);
  const VectorJ a = vector(3.0, -5.0);
  const MatrixJ M_total = bench.M + MatrixJ(bench.B.asDiagonal());
  bench.apply(M_total * a + bench.Cv + bench.g);
  Eigen::Map<VectorJ> v(bench.state.v, 2);
  v = vector(0.7, 0.2);
  bench.next();
  for (int k = 0; k < 30; ++k) {
    v += a * kStep_s;
    ASSERT_EQ(bench.next(), -1);
  }
  EXPECT_NEAR(bench.watch.residual().norm(), 0.0, 1e-9);
}

TEST(LoadWatch, BehindASensorTheSensorCountsAndNotTheRotor) {
  Robot robot = two_joints();
  robot.joints[1].torque_sensor.present = true;
  robot.joints[1].transmission.kind = TransmissionKind::kElastic;
  Bench bench(robot);
  const VectorJ a = vector(3.0, -5.0);
  VectorJ tau = bench.M * a + bench.g;
  tau[0] += bench.B[0] * a[0];
  bench.apply(vector(tau[0], 77.0));
  bench.state.tau[0] = 88.0;
  bench.state.tau[1] = tau[1];
  for (int k = 0; k < 30; ++k) {
    Eigen::Map<VectorJ>(bench.state.v, 2) += a * kStep_s;
    ASSERT_EQ(bench.next(), -1);
  }
  EXPECT_NEAR(bench.watch.residual().norm(), 0.0, 1e-9);
  bench.state.tau[1] -= 20.0;
  EXPECT_GE(bench.lasting(), 0) << "it is watched";
}

TEST(LoadWatch, SpringsWithoutASensorAreNotWatched) {
  Robot robot = two_joints();
  robot.joints[1].transmission.kind = TransmissionKind::kElastic;
  Bench bench(robot);
  bench.apply(vector(-100.0, 100.0));
  for (int k = 0; k < 32; ++k) ASSERT_EQ(bench.next(), -1);
  EXPECT_EQ(bench.watch.residual().norm(), 0.0);
}

TEST(LoadWatch, AnyPayloadAtTheTipIsExplained) {
  for (const double weight_N : {0.0, 1.0, 10.0, 100.0})
    EXPECT_EQ(Bench().found(weight_N * vector(-0.5, -0.25)), -1) << weight_N;
}

TEST(LoadWatch, SoIsAStandThatCarriesTheArm) {
  for (const double share : {0.1, 0.5, 1.0})
    EXPECT_EQ(Bench().found(share * vector(2.0, 1.0)), -1) << share;
}

// A joint that cannot leave its wall yet: a stand or friction takes up to all of the wall's push.
TEST(LoadWatch, SoIsWhatKeepsAJointInItsSoftWall) {
  for (const double wall_Nm : {6.0, -6.0}) {
    for (const double share : {0.3, 1.0}) {
      Bench bench;
      bench.walls = vector(0.0, wall_Nm);
      EXPECT_EQ(bench.found(vector(0.0, -share * wall_Nm)), -1) << wall_Nm << " " << share;
    }
    Bench on_a_stand;
    on_a_stand.walls = vector(0.0, wall_Nm);
    EXPECT_EQ(on_a_stand.found(vector(0.0, on_a_stand.g[1])), -1) << wall_Nm;
    Bench other_way;
    other_way.walls = vector(0.0, wall_Nm);
    EXPECT_EQ(other_way.found(vector(0.0, wall_Nm)), 1) << "the wall does not push that way";
    EXPECT_EQ(Bench().found(vector(0.0, -wall_Nm)), 1) << "without a wall";
  }
}

TEST(LoadWatch, AMotorWithTheWrongSignIsNot) {
  // It carries 4 N m, told -4 N m: twice the weight seems to come from outside.
  Bench bench;
  bench.g = vector(4.0, 0.0);
  EXPECT_EQ(bench.found(vector(8.0, 0.0)), 0);
}

// Without a lever to the tip there is no payload: friction and a quarter of the weight beyond
// [0, g], either way.
TEST(LoadWatch, FrictionAndAQuarterOfTheWeight) {
  for (const double sign : {1.0, -1.0}) {
    for (const int joint : {0, 1}) {
      const auto found = [&](double outside) {
        Bench bench;
        bench.J.setZero();
        bench.g *= sign;
        VectorJ torque = VectorJ::Zero(2);
        torque[joint] = sign * outside;
        return bench.found(torque);
      };
      const double g = joint == 0 ? 2.0 : 1.0;
      const double most = kFriction_Nm + 0.25 * g;
      EXPECT_EQ(found(g + most - 0.001), -1);
      EXPECT_EQ(found(g + most + 0.001), joint);
      EXPECT_EQ(found(-most + 0.001), -1);
      EXPECT_EQ(found(-most - 0.001), joint);
    }
  }
}

// A step as long as the memory: r is what acts, to the last bit.
TEST(LoadWatch, ExactlyTheFrictionIsExplained) {
  const auto found = [](double outside) {
    Bench bench;
    bench.state.period_ns = 20'000'000;
    bench.J.setZero();
    bench.g.setZero();
    bench.apply(vector(0.0, -outside));
    int joint = -1;
    for (int k = 0; k < 8; ++k) joint = bench.next(LoadWatch::kMemory_s);
    return joint;
  };
  EXPECT_EQ(found(kFriction_Nm), -1);
  EXPECT_EQ(found(kFriction_Nm + 1e-12), 1);
}

// (1, -2) is what no weight at the tip explains; its centre may lie 0.1 m beside the tip.
TEST(LoadWatch, WhatThePayloadLeavesMustBeSmall) {
  const auto found = [](double weight_N, double k) {
    return Bench().found(weight_N * vector(-0.5, -0.25) + k * vector(1.0, -2.0));
  };
  for (const double weight_N : {1.0, 4.0}) {
    const double most = kFriction_Nm + 0.25 + 0.1 * weight_N;
    EXPECT_EQ(found(weight_N, 0.5 * most - 0.001), -1) << weight_N;
    EXPECT_EQ(found(weight_N, 0.5 * most + 0.001), 1) << weight_N;
    EXPECT_EQ(found(weight_N, -0.5 * (1.0 + most) + 0.001), -1) << weight_N;
    EXPECT_EQ(found(weight_N, -0.5 * (1.0 + most) - 0.001), 1) << weight_N;
  }
}

TEST(LoadWatch, NothingPullsTheTipUp) {
  // A weight of -2.4 N would leave nothing of it.
  EXPECT_EQ(Bench().found(vector(3.001, 0.0)), 0);
  EXPECT_EQ(Bench().found(vector(2.999, 0.0)), -1);
}

TEST(LoadWatch, IsJudgedFromAnEighthOfASecondToOneAfterTheDrivesCameOn) {
  const VectorJ wrong = vector(5.0, -5.0);
  Bench bench;
  bench.apply(bench.g - wrong);
  for (int k = 1; k < 8; ++k) EXPECT_EQ(bench.next(), -1) << k;
  for (int k = 8; k <= 64; ++k) EXPECT_GE(bench.next(), 0) << k;
  for (int k = 65; k < 80; ++k) EXPECT_EQ(bench.next(), -1) << k;
  bench.watch.begin();
  for (int k = 1; k < 8; ++k) EXPECT_EQ(bench.next(), -1) << k;
  EXPECT_GE(bench.next(), 0);
  LoadWatch never(two_joints());
  EXPECT_EQ(
      never.wrong(bench.state, {bench.g, bench.Cv, bench.M, bench.B, bench.J, bench.walls}, 0.5),
      -1);
}

TEST(LoadWatch, WhatDoesNotLastIsNotFound) {
  const VectorJ wrong = vector(3.0, -3.0);
  const VectorJ nothing = vector(0.0, 0.0);
  Bench bench;
  const auto steps = [&](const VectorJ& outside, int count) {
    bench.apply(bench.g - outside);
    int found = -1;
    for (int k = 0; k < count; ++k) found = std::max(found, bench.next());
    return found;
  };
  ASSERT_EQ(steps(nothing, 12), -1);
  EXPECT_EQ(steps(wrong, 1), -1);
  EXPECT_EQ(steps(nothing, 3), -1);
  EXPECT_EQ(steps(wrong, 1), -1) << "it begins anew";
  EXPECT_GE(steps(wrong, 1), 0);
}

// Two steps of 15 ms are 30 ms to the last bit.
TEST(LoadWatch, ExactlyThatLongIsLongEnough) {
  Bench bench;
  bench.state.period_ns = 15'000'000;
  bench.apply(bench.g);
  for (int k = 0; k < 10; ++k) ASSERT_EQ(bench.next(0.015), -1);
  bench.apply(bench.g - vector(50.0, -50.0));
  EXPECT_EQ(bench.next(0.015), -1);
  EXPECT_GE(bench.next(0.015), 0);
}

TEST(LoadWatch, AnArmThatALawMovesIsNotWeighed) {
  Bench bench;
  bench.apply(bench.g - vector(5.0, -5.0));
  for (int k = 0; k < 7; ++k) ASSERT_EQ(bench.next(), -1);
  bench.watch.end();
  for (int k = 0; k < 20; ++k) ASSERT_EQ(bench.next(), -1);
}

TEST(LoadWatch, ANumberThatIsNoneIsWrong) {
  Bench bench;
  for (int k = 0; k < 10; ++k) bench.next();
  bench.state.v[0] = std::nan("");
  EXPECT_EQ(bench.lasting(), 0);
}

// A state of speed 1 rad/s is the first: no torque has made it.
TEST(LoadWatch, ASwingThatItBeginsWithIsNoImpulse) {
  Bench bench;
  bench.apply(bench.g);
  bench.state.v[0] = bench.state.v[1] = 1.0;
  for (int k = 0; k < 3; ++k) ASSERT_EQ(bench.next(), -1);
  EXPECT_EQ(bench.watch.residual().norm(), 0.0);
}

// What a joint does while nobody hears it shows at once afterwards: no torque of that cycle.
TEST(LoadWatch, AGapIsNoImpulse) {
  const auto residual_after = [](const std::function<void(Bench&)>& gap) {
    Bench bench;
    bench.apply(bench.g);
    for (int k = 0; k < 2; ++k) bench.next();
    gap(bench);
    return bench.watch.residual().norm();
  };
  EXPECT_GT(residual_after([](Bench& bench) {
              bench.state.v[1] = 0.5;
              bench.next();
            }),
            1.0)
      << "from one state to the next it is one";
  EXPECT_EQ(residual_after([](Bench& bench) {
              bench.state.age_cycles[1] = 1;
              bench.next();
              bench.state.age_cycles[1] = 0;
              bench.state.v[1] = 0.5;
              bench.next();
              bench.next();
            }),
            0.0);
  EXPECT_EQ(residual_after([](Bench& bench) {
              bench.state.age_cycles[0] = 1;
              bench.state.v[1] = 0.5;
              bench.next();
            }),
            0.0);
  for (const double periods : {1.6, 2.0, 3.0}) {
    EXPECT_EQ(residual_after([periods](Bench& bench) {
                bench.state.v[1] = 0.5;
                bench.next(periods * kStep_s);
              }),
              0.0)
        << periods;
  }
  EXPECT_EQ(residual_after([](Bench& bench) {
              bench.watch.begin();
              bench.state.v[1] = 0.5;
              bench.next();
            }),
            0.0)
      << "drives that come on again";
  EXPECT_GT(residual_after([](Bench& bench) {
              bench.state.v[1] = 0.5;
              bench.state.age_cycles[2] = 1;  // there are two joints
              bench.next(1.4 * kStep_s);
            }),
            1.0);
}

TEST(LoadWatch, WhatCarriesTheArmIsTheWeightLessWhatActsFromOutside) {
  Bench bench;
  EXPECT_EQ(bench.watch.carrying(bench.g), bench.g);
  ASSERT_EQ(bench.found(vector(-0.5, -0.25)), -1);
  EXPECT_NEAR((bench.watch.carrying(bench.g) - vector(2.5, 1.25)).norm(), 0.0, 1e-9);
  EXPECT_EQ(bench.watch.carrying(vector(20.0, -20.0)), vector(kLimit_Nm, -kLimit_Nm));
}

// The gate takes tau_gravity in steps of the torque only: a heavy arm that is carried by nothing of
// the motors yet, as when the drives have just come on, has all its weight as r.
TEST(LoadWatch, WhatCarriesTheArmChangesNoFasterThanATorqueMay) {
  Bench bench;
  VectorJ before = bench.watch.carrying(bench.g);
  const auto expect_within_a_step = [&](double dt_s) {
    const VectorJ now = bench.watch.carrying(bench.g);
    EXPECT_LE((now - before).cwiseAbs().maxCoeff(), kRate_Nm_per_s * dt_s * (1.0 + 1e-12));
    before = now;
  };
  bench.apply(bench.g - vector(6.0, -5.0));
  for (int k = 0; k < 400; ++k) {
    bench.next(1e-3);
    expect_within_a_step(1e-3);
  }
  EXPECT_NEAR((before - bench.g + vector(6.0, -5.0)).norm(), 0.0, 1e-3);
  for (int k = 0; k < 400; ++k) {
    bench.watch.relax(1e-3);
    expect_within_a_step(1e-3);
  }
  EXPECT_NEAR((before - bench.g).norm(), 0.0, 1e-6);
}

TEST(LoadWatch, AfterTheWatchItFades) {
  Bench bench;
  ASSERT_EQ(bench.found(vector(-0.5, -0.25)), -1);
  const VectorJ before = bench.watch.residual();
  bench.watch.relax(0.005);
  EXPECT_NEAR((bench.watch.residual() - 0.75 * before).norm(), 0.0, 1e-12);
  for (int k = 0; k < 40; ++k) bench.next();
  const VectorJ late = bench.watch.residual();
  EXPECT_LT(late.norm(), 1e-3);
  bench.watch.relax(1.0);
  EXPECT_EQ(bench.watch.residual().norm(), 0.0);
}

}  // namespace
}  // namespace limber::controller::test_load_watch
