// What pushes one joint along, a hand or a wall, may be what holds another joint's reading still.
#include <gtest/gtest.h>

#include <cmath>

#include "controller/watches/encoder_watch.h"

namespace limber::controller::test_encoder_watch_push {
namespace {

constexpr int kJoints = 3;
/// 32 cycles a second: the residual's filter forgets within a cycle, and all numbers are exact.
constexpr double kPeriod_s = 1.0 / 32.0;
constexpr double kFriction_Nm = 2.0;  ///< of each joint: a twentieth of its limit

/// The reading of joint 1 stands still from the first state on; a hand is at joint 0.
class Bench {
 public:
  Bench() : watch_(robot()) {
    state_.num_joints = kJoints;
    M_.diagonal() << 2.0, 2.0, 2.0;
  }
  /// The joint that is found in a state one period later.
  int next() { return watch_.stopped(state_, {gravity_, CTv_, M_}, kPeriod_s); }
  void settle() {
    for (int k = 0; k < 8; ++k) EXPECT_EQ(next(), -1);
  }
  /// The motor of joint 0 holds against a hand that pushes forward.
  void push(double hand_Nm) { state_.tau_applied[0] = -hand_Nm; }
  /// The reading of joint 1 changes: its rest begins anew.
  void count() { state_.theta[1] += 1e-3; }
  void reset() { watch_.reset(); }
  joint_state_t& state() { return state_; }
  MatrixJ& M() { return M_; }
  VectorJ& gravity() { return gravity_; }
  VectorJ& CTv() { return CTv_; }

 private:
  static Robot robot() {
    Robot robot;
    robot.rate_hz = 1.0 / kPeriod_s;
    robot.joints.resize(kJoints);
    for (JointConfig& joint : robot.joints) {
      joint.torque_limit_Nm = 40.0;
      joint.velocity_limit = 100.0;
    }
    return robot;
  }

  EncoderWatch watch_;
  joint_state_t state_{};
  MatrixJ M_ = MatrixJ::Zero(kJoints, kJoints);
  VectorJ gravity_ = VectorJ::Zero(kJoints);
  VectorJ CTv_ = VectorJ::Zero(kJoints);
};

/// Joint 1 gets 6 N m, 2 beyond twice its friction: 1 rad/s^2. The residual follows a period later:
/// after n periods n (n - 1) / 2048 rad are expected.
constexpr double kLoad_Nm = 6.0;
constexpr int kUnexplained = 9;  ///< periods to 0.03 rad
constexpr int kHeld = 200;       ///< as long as a test lasts

/// A hand that may hold 3.5 N m of the 4 beyond friction: 0.25 rad/s^2. After n periods n (n - 1) /
/// 8192 rad are expected.
constexpr double kHalf_Nm = 3.5 / EncoderWatch::kHeldShare;
constexpr int kHalfExplained = 17;

int periods_until_found(Bench& bench) {
  for (int n = 1; n < kHeld; ++n)
    if (bench.next() == 1) return n;
  return kHeld;
}

struct Push {
  double hand_Nm = 8.0;
  double before_Nm = 0.0;  ///< while the reading of joint 1 changed last
  double way = 0.1;        ///< of joint 0 since, rad
  double load_before_Nm = 0.0;
  double load_Nm = kLoad_Nm;
  double speed = 0.0;  ///< of joint 0, rad/s
  double M_00 = 2.0;
  double start = 0.0;  ///< of joint 0, rad
};

int periods_until_found(const Push& push) {
  Bench bench;
  bench.M()(0, 0) = push.M_00;
  bench.push(push.before_Nm);
  bench.state().theta[0] = push.start;
  bench.settle();
  bench.state().tau_applied[1] = push.load_before_Nm;
  bench.next();
  bench.count();
  bench.settle();
  bench.push(push.hand_Nm);
  bench.state().theta[0] = push.start + push.way;
  bench.state().theta_dot[0] = push.speed;
  bench.state().theta[2] = 0.1;  // the arm has moved in any case
  bench.state().tau_applied[1] = push.load_Nm;
  return periods_until_found(bench);
}

TEST(EncoderWatchPush, AHandMayHoldAShareOfItsPush) {
  for (const double way : {0.1, -0.1}) {
    for (const double load_Nm : {kLoad_Nm, -kLoad_Nm}) {
      const double sign = std::copysign(1.0, way);
      const auto found = [&](double hand_Nm) {
        return periods_until_found({.hand_Nm = sign * hand_Nm, .way = way, .load_Nm = load_Nm});
      };
      EXPECT_EQ(found(0.0), kUnexplained);
      EXPECT_EQ(found(kHalf_Nm), kHalfExplained);
      EXPECT_EQ(found(6.0), kHeld);
    }
  }
}

TEST(EncoderWatchPush, ComparedByTheJointsInertia) {
  EXPECT_EQ(periods_until_found({.hand_Nm = 2.0 * kHalf_Nm, .M_00 = 8.0}), kHalfExplained);
  EXPECT_EQ(periods_until_found({.hand_Nm = 0.75 * kHalf_Nm, .M_00 = 1.125}), kHalfExplained);
}

TEST(EncoderWatchPush, OnlyTheLoadThatWasNotBalancedBeforeHasToBeHeld) {
  const auto found = [](double hand_Nm) {
    return periods_until_found({.hand_Nm = hand_Nm, .load_before_Nm = 3.0, .load_Nm = 9.0});
  };
  EXPECT_EQ(found(kHalf_Nm), kHalfExplained);
  EXPECT_EQ(found(6.0), kHeld);
}

TEST(EncoderWatchPush, WithinFrictionThereNeedBeNoHand) {
  EXPECT_EQ(periods_until_found({.hand_Nm = 0.7 * kFriction_Nm, .M_00 = 0.1}), kUnexplained);
  EXPECT_EQ(periods_until_found({.hand_Nm = 0.701 * kFriction_Nm, .M_00 = 0.1}), kHeld);
}

TEST(EncoderWatchPush, AJointThatMovesAgainstTheHandIsNotPushedByIt) {
  EXPECT_EQ(periods_until_found({.hand_Nm = -8.0}), kUnexplained);
  EXPECT_EQ(periods_until_found({.way = -0.1}), kUnexplained);
  EXPECT_EQ(periods_until_found({.way = -0.1, .start = 1.0}), kUnexplained);
}

TEST(EncoderWatchPush, WhatHungOnTheArmBeforeIsNoPush) {
  EXPECT_EQ(periods_until_found({.before_Nm = 8.0}), kUnexplained);
  EXPECT_EQ(periods_until_found({.before_Nm = 8.0 - kHalf_Nm}), kHalfExplained);
  EXPECT_EQ(periods_until_found({.hand_Nm = kHalf_Nm, .before_Nm = -4.0}), kHalfExplained);
}

TEST(EncoderWatchPush, AJointThatHasNotGivenWayIsNotPushed) {
  for (const double sign : {1.0, -1.0}) {
    const auto found = [sign](double way) {
      return periods_until_found({.hand_Nm = sign * 8.0, .way = sign * way});
    };
    EXPECT_EQ(found(0.01), kUnexplained);
    EXPECT_EQ(found(std::nextafter(0.01, 1.0)), kHeld);
  }
}

TEST(EncoderWatchPush, AJointThatIsFastIsNotPushedByAHand) {
  for (const double sign : {1.0, -1.0}) {
    EXPECT_EQ(periods_until_found({.speed = sign * 2.5}), kHeld);
    EXPECT_EQ(periods_until_found({.speed = sign * std::nextafter(2.5, 3.0)}), kUnexplained);
  }
}

/// Joint 1 has its load, and joint 0 has given way, from the next state on.
void load(Bench& bench) {
  bench.state().theta[0] = 0.1;
  bench.state().tau_applied[1] = kLoad_Nm;
}

// Weight, and what momentum has of it while the arm moves, are no hand.
TEST(EncoderWatchPush, TheModelsTorquesAreNoPush) {
  for (const double hand_Nm : {0.0, 8.0}) {
    Bench bench;
    bench.settle();
    bench.gravity()[0] = -5.0;
    bench.CTv()[0] = 7.0;
    bench.state().tau_applied[0] = -12.0 - hand_Nm;
    load(bench);
    EXPECT_EQ(periods_until_found(bench), hand_Nm > 0.0 ? kHeld : kUnexplained);
  }
}

TEST(EncoderWatchPush, ATorqueThatSlowsTheJointDownIsNoPush) {
  Bench bench;
  bench.settle();
  load(bench);
  int found = -1;
  int n = 0;
  while (found < 0 && n < kHeld) {
    bench.state().tau_applied[0] = -8.0;
    found = bench.next();
    bench.state().v[0] -= 8.0 / 2.0 * kPeriod_s;
    ++n;
  }
  EXPECT_EQ(n, kUnexplained);
}

// Joint 1 swings unseen and throws joint 0, whose motor stands against it, as hard as any inertia
// can: M_01^2 = M_00 M_11.
TEST(EncoderWatchPush, AnUnseenSwingIsFoundWithinATenthOfARadian) {
  const int n = periods_until_found({.hand_Nm = kLoad_Nm - kFriction_Nm});
  const double swing = n * (n + 1) / 1024.0;  // 2 rad/s^2
  EXPECT_GT(swing, 0.03);
  EXPECT_LT(swing, 0.1 + 4.0 * n * kPeriod_s * kPeriod_s) << "and what two periods add";
}

TEST(EncoderWatchPush, AHandThatLetsGoHoldsNothing) {
  Bench bench;
  bench.settle();
  load(bench);
  bench.push(8.0);
  for (int n = 1; n < 100; ++n) ASSERT_EQ(bench.next(), -1) << n;
  bench.push(0.0);
  EXPECT_EQ(periods_until_found(bench), kUnexplained);
}

// A hand that may hold less than friction turning the other way: no more than that turning.
TEST(EncoderWatchPush, AWeakHandAddsNothingToFrictionThatTurns) {
  EXPECT_EQ(periods_until_found({.hand_Nm = 1.99 / EncoderWatch::kHeldShare}), kUnexplained);
  EXPECT_EQ(periods_until_found({.hand_Nm = kHalf_Nm}), kHalfExplained);
}

// Without friction: a joint that was set going turns on.
TEST(EncoderWatchPush, NoPushHoldsNoLoad) {
  Robot robot;
  robot.joints.resize(2);
  EncoderWatch watch(robot);
  joint_state_t state{};
  state.num_joints = 2;
  const VectorJ none = VectorJ::Zero(2);
  const MatrixJ M = MatrixJ::Identity(2, 2);
  watch.stopped(state, {none, none, M}, 1.0);
  state.tau_applied[1] = 0.02;
  for (int k = 0; k < 1000; ++k) watch.stopped(state, {none, none, M}, 0.0);
  EXPECT_EQ(watch.stopped(state, {none, none, M}, 1.0), -1) << "0.02 rad, and 0.02 rad/s";
  state.theta[0] = 0.1;
  state.tau_applied[1] = 0.0;
  for (int k = 0; k < 1000; ++k) watch.stopped(state, {none, none, M}, 0.0);
  EXPECT_EQ(watch.stopped(state, {none, none, M}, 1.0), 1);
}

TEST(EncoderWatchPush, NoPushHidesASuddenStop) {
  for (const double hand_Nm : {0.0, 100.0}) {
    Bench bench;
    bench.settle();
    bench.state().theta_dot[1] = 1.0;
    bench.state().tau_applied[1] = kLoad_Nm;
    bench.count();
    bench.next();
    bench.state().theta_dot[1] = 0.0;
    bench.state().theta[0] = 0.1;
    bench.push(hand_Nm);
    EXPECT_EQ(bench.next(), -1);
    EXPECT_EQ(bench.next(), 1);
  }
}

// The residual begins at zero when the drives come on, whatever hangs on the arm: the first time,
// and after a reset.
TEST(EncoderWatchPush, WhatHangsOnTheArmAtTheStartIsNoPush) {
  for (const bool again : {false, true}) {
    for (const int period : {1, 2, 3, 4}) {
      Bench bench;
      if (again) {
        bench.push(50.0);
        bench.settle();
        bench.reset();
      }
      bench.push(0.0);
      for (int n = 1; n < 8; ++n) {
        if (n == period) bench.push(8.0);
        ASSERT_EQ(bench.next(), -1);
      }
      load(bench);
      EXPECT_EQ(periods_until_found(bench), period < 3 ? kUnexplained : kHeld) << period;
    }
  }
}

// Half a kg m^2 between joint 0, which reads so fast for a period, and joint 1, which rests.
TEST(EncoderWatchPush, ASpeedThatNoJointHasMovesNoOther) {
  const auto found = [](double speed) {
    Bench bench;
    bench.M()(0, 1) = bench.M()(1, 0) = 0.5;
    bench.settle();
    bench.state().theta[0] = 1.0;
    bench.state().v[0] = speed;
    for (int n = 0; n < kHeld; ++n) {
      if (bench.next() == 1) return true;
      bench.state().v[0] = 0.0;
    }
    return false;
  };
  for (const double sign : {1.0, -1.0}) {
    EXPECT_TRUE(found(sign * 199.0));
    EXPECT_FALSE(found(sign * 201.0));
  }
}

}  // namespace
}  // namespace limber::controller::test_encoder_watch_push
