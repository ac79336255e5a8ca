// What carries the arm besides its motors: the estimate in closed form, and how much of it a
// payload, friction and a stand explain.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "controller/watches/load_watch.h"

namespace limber::controller::test_load_watch {
namespace {

constexpr double kStep_s = 1.0 / 64.0;
constexpr double kFriction_Nm = 0.5;
constexpr double kLimit_Nm = 8.0;
constexpr double kRate_Nm_per_s = 40.0;

Robot two_joints() {
  Robot robot;  // gravity along -z
  robot.joints.resize(2);
  for (JointConfig& joint : robot.joints) {
    joint.torque_limit_Nm = kLimit_Nm;  // a twentieth is less than the friction
    joint.torque_rate_limit_Nm_per_s = kRate_Nm_per_s;
    joint.friction.coulomb_Nm = kFriction_Nm;
  }
  return robot;
}

VectorJ vector(double a, double b) {
  VectorJ out(2);
  out << a, b;
  return out;
}

/// At rest, unless told otherwise: weight 2 and 1 N m, tip 0.5 and 0.25 m in front of the joints.
struct Bench {
  explicit Bench(const Robot& robot = two_joints()) : watch(robot) {
    M << 0.5, 0.1, 0.1, 0.2;
    J.row(2) << 0.5, 0.25;
    state.num_joints = 2;
    state.period_ns = std::int64_t{1'000'000'000} / 64;
    watch.begin();
  }
  int next(double dt_s = kStep_s) { return watch.wrong(state, {g, Cv, M, B, J, walls}, dt_s); }
  void apply(const VectorJ& tau) { Eigen::Map<VectorJ>(state.tau_applied, 2) = tau; }
  /// The joint that is found within half a second of this torque from outside, -1: none.
  int found(const VectorJ& outside_Nm) {
    apply(g - outside_Nm);
    for (int k = 0; k < 32; ++k)
      if (const int joint = next(); joint >= 0) return joint;
    EXPECT_NEAR((watch.residual() - outside_Nm).norm(), 0.0, 1e-9);
    return -1;
  }

  /// What is found when it is as it is for as long as it has to: two steps.
  int lasting() {
    EXPECT_EQ(next(), -1);
    return next();
  }

  LoadWatch watch;
  joint_state_t state{};
  VectorJ g = vector(2.0, 1.0);
  VectorJ Cv = vector(0.0, 0.0);
  VectorJ B = vector(0.1, 0.05);
  MatrixJ M = MatrixJ::Zero(2, 2);
  Matrix6J J = Matrix6J::Zero(6, 2);
  VectorJ walls = vector(0.0, 0.0);
};

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

TEST(LoadWatch, AMotorThatMakesAMultipleIsFoundOnceItHasMoved) {
  for (const double scale : {1.8, 2.5, 4.0, 10.0}) {
    Overdriven arm(scale);
    EXPECT_EQ(arm.watch.overdriven(), -1) << "a stand may carry it";
    EXPECT_NEAR(arm.moves_until_found(), LoadWatch::kMovedBy, 0.0011) << scale;
    EXPECT_EQ(arm.watch.overdriven(), 0);
  }
}

TEST(LoadWatch, OrOnceItsTorqueHasGrown) {
  EXPECT_LE(Overdriven(4.0).moves_until_found(1.5), 0.0201) << "in a third of a second";
  EXPECT_NEAR(Overdriven(4.0).moves_until_found(1.3), LoadWatch::kMovedBy, 0.0011);
}

TEST(LoadWatch, LessThanTwoFifthsOfTheWeightIsAPoorModel) {
  EXPECT_GE(Overdriven(1.6).moves_until_found(), 0.2) << "3/8 of its weight are missing";
  EXPECT_LE(Overdriven(1.7).moves_until_found(), 0.06);
}

// The law lifts the arm off its stand, or presses it on: either way r / tau is another.
TEST(LoadWatch, AStandThatIsLeftBehindIsNone) {
  for (const double share : {1.0, 0.5, 0.1}) {
    Overdriven arm(4.0);  // so much less torque, at first
    arm.watch.end();
    arm.apply(share == 0.5 ? 0.5 * arm.g : share * arm.g);
    if (share < 0.25) arm.apply(-0.2 * arm.g);
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

TEST(LoadWatch, WhatFrictionMayHoldIsNoMultiple) {
  Overdriven arm(4.0);
  arm.watch.begin();
  arm.g = vector(0.6, 0.3);  // three quarters of it are less than the friction
  arm.apply(arm.g / 4.0);
  for (int k = 0; k < 32; ++k) ASSERT_EQ(arm.next(), -1);
  EXPECT_GE(arm.moves_until_found(), 0.2);
}

TEST(LoadWatch, AnOverdrivenArmIsCarriedWithWhatCarriedIt) {
  Overdriven arm(4.0);
  arm.moves_until_found();
  for (int k = 0; k < 64; ++k) arm.watch.relax(kStep_s);
  EXPECT_NEAR((arm.watch.carrying(arm.g) - arm.g / 4.0).norm(), 0.0, 1e-3);
  arm.watch.begin();
  EXPECT_EQ(arm.watch.overdriven(), -1);
}

TEST(LoadWatch, IsFollowedForFiveSeconds) {
  Overdriven arm(4.0);
  arm.watch.end();
  arm.apply(arm.g / 4.0);
  for (int k = 0; k < 64 * 5; ++k) ASSERT_EQ(arm.next(), -1);
  EXPECT_GE(arm.moves_until_found(), 0.2) << "by then nobody remembers HOLD";
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
