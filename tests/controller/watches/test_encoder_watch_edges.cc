// A stopped encoder: what counts as friction, as a change of the reading, and as motion elsewhere.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "controller/watches/encoder_watch.h"

namespace limber::controller::test_encoder_watch_edges {
namespace {

constexpr int kJoints = 3;
constexpr double kLimit_Nm = 40.0;
constexpr double kFastest = 100.0;  // rad/s
constexpr double kInertia = 2.0;
constexpr double kLong_s = 1.0;

/// The watch of joint 1: at rest for kRests_s without torque, then states of kLong_s each.
class Bench {
 public:
  explicit Bench(const std::function<void(JointConfig&)>& change = [](JointConfig&) {})
      : watch_(robot(change)) {
    state_.num_joints = kJoints;
    next();
    next(EncoderWatch::kRests_s);
  }
  /// The joint that is found in a state `dt_s` later; `gravity`: of joint 1, N m.
  int next(double dt_s = kLong_s, double gravity = 0.0) {
    const MatrixJ M = MatrixJ::Identity(kJoints, kJoints) * kInertia;
    const VectorJ g = VectorJ::Unit(kJoints, 1) * gravity;
    return watch_.stopped(state_, {g, VectorJ::Zero(kJoints), M}, dt_s);
  }
  /// What drives joint 1 from now on, N m; the residual has come to it, in no time.
  void torque(double motor, double gravity = 0.0) {
    state_.tau_applied[1] = motor;
    for (int k = 0; k < 2; ++k) EXPECT_EQ(next(0.0, gravity), -1);
  }
  joint_state_t& state() { return state_; }

 private:
  static Robot robot(const std::function<void(JointConfig&)>& change) {
    Robot robot;
    robot.rate_hz = 32.0;  // the residual's filter forgets within a cycle, and numbers are exact
    robot.joints.resize(kJoints);
    for (JointConfig& joint : robot.joints) {
      joint.torque_limit_Nm = kLimit_Nm;
      joint.velocity_limit = kFastest;
    }
    change(robot.joints[1]);
    return robot;
  }

  EncoderWatch watch_;
  joint_state_t state_{};
};

/// Friction of `holds`, which may have held as much the other way before, hides twice that torque
/// but not one a little greater.
void expect_friction(double holds, const std::function<void(JointConfig&)>& change) {
  for (const double sign : {1.0, -1.0}) {
    Bench bench(change);
    bench.state().theta[0] = 1.0;
    bench.torque(sign * (2.0 * holds - 0.01));
    EXPECT_EQ(bench.next(1e3), -1) << holds;
    bench.torque(sign * (2.0 * holds + 0.01));
    EXPECT_EQ(bench.next(1e3), 1) << holds;  // 0.01 N m / 2 kg m^2 (1000 s)^2
  }
}

TEST(EncoderWatchEdges, FrictionIsTheGreaterOfBothKindsPlusTheLinks) {
  expect_friction(7.0, [](JointConfig& joint) {
    joint.friction.coulomb_Nm = 4.0;
    joint.friction.static_Nm = 3.0;
    joint.link_friction.coulomb_Nm = 1.0;
    joint.link_friction.static_Nm = 3.0;
  });
  expect_friction(7.0, [](JointConfig& joint) {
    joint.friction.coulomb_Nm = 1.0;
    joint.friction.static_Nm = 5.0;
    joint.link_friction.coulomb_Nm = 2.0;
  });
}

TEST(EncoderWatchEdges, ATorqueThatCarriesTheWeightMovesNothing) {
  Bench bench;
  bench.state().theta[0] = 1.0;
  bench.torque(8.0, 8.0);
  EXPECT_EQ(bench.next(1.0, 8.0), -1);
  bench.torque(8.0, -1.0);
  EXPECT_EQ(bench.next(1.0, -1.0), 1) << "it would rise now";
}

TEST(EncoderWatchEdges, TwoMotorsHaveItTwice) {
  expect_friction(9.0, [](JointConfig& joint) {
    joint.has_antagonist = true;
    joint.friction.coulomb_Nm = 4.0;
    joint.link_friction.coulomb_Nm = 1.0;
  });
}

TEST(EncoderWatchEdges, ATwentiethOfTheTorqueLimitAtLeast) {
  expect_friction(2.0, [](JointConfig& joint) { joint.friction.coulomb_Nm = 1.9; });
  expect_friction(2.1, [](JointConfig& joint) { joint.friction.coulomb_Nm = 2.1; });
}

// Half a radian is expected at once; each reading of a drive's four shows that the encoder counts.
TEST(EncoderWatchEdges, AnyReadingThatChangesBeginsAfresh) {
  const auto found_after = [](const std::function<void(joint_state_t&)>& change) {
    Bench bench;
    bench.torque(5.0);  // 1 N m beyond twice friction: 0.5 rad in 1 s
    bench.state().theta[0] = 1.0;
    change(bench.state());
    return bench.next();
  };
  EXPECT_EQ(found_after([](joint_state_t&) {}), 1);
  constexpr double kBit = 1e-300;
  EXPECT_EQ(found_after([](joint_state_t& state) { state.theta[1] = kBit; }), -1);
  EXPECT_EQ(found_after([](joint_state_t& state) { state.q[1] = kBit; }), -1);
  EXPECT_EQ(found_after([](joint_state_t& state) { state.theta_dot[1] = kBit; }), -1);
  EXPECT_EQ(found_after([](joint_state_t& state) { state.v[1] = kBit; }), -1);
}

TEST(EncoderWatchEdges, AfreshMeansFromTheNewReadingAndItsLoad) {
  Bench bench;
  joint_state_t& state = bench.state();
  bench.torque(5.0);
  state.theta[0] = 0.011;
  EXPECT_EQ(bench.next(0.2), -1);  // 0.5 rad/s^2 (0.2 s)^2 = 0.02 rad
  state.theta[1] = state.q[1] = state.theta_dot[1] = state.v[1] = 1e-6;
  EXPECT_EQ(bench.next(0.3), -1);
  EXPECT_EQ(bench.next(1e3), -1) << "5 N m are balanced since then";
  bench.torque(10.0);  // 1 N m beyond load and twice friction
  EXPECT_EQ(bench.next(0.2), -1) << "neither angle nor speed is left from before";
  EXPECT_EQ(bench.next(0.2), -1) << "0.06 rad are expected, but no other joint has moved since";
  state.theta[2] = -0.011;
  EXPECT_EQ(bench.next(1e-6), 1);
}

// What was held may be held no longer, in both directions. Friction, 2 N m, may have helped to hold
// it, and may hold against it now: neither the other way.
TEST(EncoderWatchEdges, BetweenNoLoadAndThatOfBeforeNothingMoves) {
  for (const double sign : {1.0, -1.0}) {
    const auto found_at = [sign](double load) {
      Bench bench;
      bench.torque(sign * 8.0);
      bench.state().theta[1] = 1e-6;
      bench.next(1e-3);
      bench.next(EncoderWatch::kRests_s);
      bench.torque(sign * load);
      bench.state().theta[0] = 1.0;
      return bench.next(1e3);
    };
    for (const double load : {8.0, 4.0, 0.0, -1.99, 11.99}) EXPECT_EQ(found_at(load), -1) << load;
    for (const double load : {-2.01, 12.01}) EXPECT_EQ(found_at(load), 1) << load;
  }
}

TEST(EncoderWatchEdges, FrictionOfAJointThatHasJustComeToRestCountsOnce) {
  const auto found_after = [](double rest_s) {
    Bench bench;
    bench.state().theta[1] = 1e-6;
    bench.next(1e-3);
    bench.next(rest_s);
    bench.torque(4.0);  // 2 N m beyond friction
    bench.state().theta[0] = 1.0;
    return bench.next(1e3);
  };
  EXPECT_EQ(found_after(std::nextafter(EncoderWatch::kRests_s, 0.0)), 1);
  EXPECT_EQ(found_after(EncoderWatch::kRests_s), -1);
}

TEST(EncoderWatchEdges, AnotherJointMovesByMoreThanAHundredth) {
  for (const int other : {0, 2}) {
    for (const double sign : {1.0, -1.0}) {
      Bench bench;
      bench.torque(5.0);
      bench.state().theta[other] = sign * 0.01;
      EXPECT_EQ(bench.next(), -1);
      bench.state().theta[other] = sign * std::nextafter(0.01, 1.0);
      EXPECT_EQ(bench.next(), 1);
    }
  }
}

TEST(EncoderWatchEdges, ThreeHundredthsAreExpectedAtLeast) {
  Bench exact([](JointConfig& joint) { joint.torque_limit_Nm = 0.0; });
  exact.torque(kInertia * 0.03);
  exact.state().theta[0] = 1.0;
  EXPECT_EQ(exact.next(), 1) << "0.03 rad in a second";
  for (const double sign : {1.0, -1.0}) {
    Bench bench;
    bench.torque(sign * (4.0 + 2.0 * kInertia));
    bench.state().theta[0] = 1.0;       // 2 rad/s^2
    EXPECT_EQ(bench.next(0.1224), -1);  // 0.02996 rad
    Bench later;
    later.torque(sign * (4.0 + 2.0 * kInertia));
    later.state().theta[0] = 1.0;
    EXPECT_EQ(later.next(0.1226), 1);  // 0.03006 rad
  }
}

/// Cycles of `dt_s` that a joint stands still after `speed` before it is found; -1: not in 10,000.
/// No other joint moves. Friction: 2 N m; with the limit of 40 N m it brakes by 21 rad/s^2.
int cycles_after(
    double speed, double dt_s = 1e-3,
    const std::function<void(JointConfig&)>& change = [](JointConfig&) {}) {
  Bench bench(change);
  bench.state().theta_dot[1] = speed;
  bench.next(dt_s);
  bench.state().theta_dot[1] = 0.0;
  for (int k = 0; k <= 10'000; ++k)
    if (bench.next(dt_s) == 1) return k;
  return -1;
}

TEST(EncoderWatchEdges, ASuddenStopIsFoundAfterAHundredthOfARadian) {
  for (const double sign : {1.0, -1.0}) {
    EXPECT_EQ(cycles_after(sign * 0.41), 25);
    EXPECT_EQ(cycles_after(sign * 0.0625), 160);
    EXPECT_NEAR(cycles_after(sign * 0.05), 200, 1);
    EXPECT_EQ(cycles_after(sign, 0.01), 1);
    EXPECT_EQ(cycles_after(sign * std::nextafter(0.05, 0.0)), -1) << "friction may have stopped it";
  }
}

TEST(EncoderWatchEdges, AFastJointThatMovesOnIsLeftAlone) {
  Bench bench;
  for (int k = 0; k < 1000; ++k) {
    bench.state().theta_dot[1] = 50.0;
    bench.state().theta[1] = 0.05 * k;
    ASSERT_EQ(bench.next(1e-3), -1) << k;
  }
}

TEST(EncoderWatchEdges, AFastReadingMayStandFor10Ms) {
  // 8 rad/s: a hundredth of a radian in less than two cycles. Dyadic steps: 1/128 s, 1/64 s.
  Bench bench;
  bench.state().theta_dot[1] = 8.0;
  bench.next(1.0 / 128.0);
  bench.state().theta_dot[1] = 0.0;
  for (int k = 0; k < 2; ++k) EXPECT_EQ(bench.next(1.0 / 128.0), -1);
  EXPECT_EQ(bench.next(1.0 / 128.0), 1);
  EXPECT_NEAR(cycles_after(8.0), 10, 1);
  Bench exact;
  exact.state().theta_dot[1] = 8.0;
  exact.next(0.005);
  exact.state().theta_dot[1] = 0.0;
  for (int k = 0; k < 2; ++k) EXPECT_EQ(exact.next(0.005), -1);
  EXPECT_EQ(exact.next(0.005), 1);
}

TEST(EncoderWatchEdges, AStopThatMotorAndFrictionCanMakeIsNotSudden) {
  // Within 10 ms: 21 rad/s^2 10 ms = 0.21 rad/s.
  for (const double sign : {1.0, -1.0}) {
    EXPECT_EQ(cycles_after(sign * 0.2099, 0.01), -1);
    EXPECT_EQ(cycles_after(sign * 0.2101, 0.01), 5);
  }
}

// A hard contact gives way by a thousandth at the torque limit: at v within 6.8 ms 6.8 v
// thousandths are 272 v N m, friction is 2 N m, and 2 kg m^2 lose v by 294.1 v N m. From 0.0905
// rad/s on.
TEST(EncoderWatchEdges, AStopThatAHardContactCanMakeIsNotSudden) {
  for (const double sign : {1.0, -1.0}) {
    EXPECT_EQ(cycles_after(sign * 0.0902, 0.0068), -1);
    EXPECT_GT(cycles_after(sign * 0.0909, 0.0068), 0);
  }
}

// Within 5 ms: 400 v N m for the stop, 200 v of the contact, 2 of friction, 15 of the motor.
TEST(EncoderWatchEdges, WhatDrivesTheJointMayBrakeItToo) {
  const auto found = [](double speed, double motor_Nm, double gravity) {
    Bench bench;
    bench.torque(motor_Nm, gravity);
    bench.state().theta_dot[1] = bench.state().v[1] = speed;
    bench.next(0.005, gravity);
    bench.state().theta_dot[1] = bench.state().v[1] = 0.0;  // a jump that the residual shows
    for (int k = 0; k < 1000; ++k)
      if (bench.next(0.005, gravity) == 1) return true;
    return false;
  };
  for (const double sign : {1.0, -1.0}) {
    EXPECT_FALSE(found(sign * 0.0849, -15.0, 0.0));
    EXPECT_FALSE(found(sign * 0.0849, 15.0, 0.0));
    EXPECT_TRUE(found(sign * 0.0851, 15.0, 0.0));
    EXPECT_TRUE(found(sign * 0.0849, 15.0, 15.0)) << "the weight is carried";
  }
}

// Within 5 ms: 21 rad/s^2 5 ms = 0.105 rad/s.
TEST(EncoderWatchEdges, ASpringStopsItsRotorByTheTorqueLimit) {
  const auto elastic = [](JointConfig& joint) {
    joint.transmission.kind = TransmissionKind::kElastic;
  };
  EXPECT_EQ(cycles_after(0.1049, 0.005, elastic), -1);
  EXPECT_GT(cycles_after(0.1051, 0.005, elastic), 0);
}

TEST(EncoderWatchEdges, NoJointStopsFromMoreThanTwiceItsLimit) {
  for (const double sign : {1.0, -1.0}) {
    EXPECT_EQ(cycles_after(sign * 2.0 * kFastest), 10);
    EXPECT_EQ(cycles_after(sign * std::nextafter(2.0 * kFastest, 1e3)), -1);
    EXPECT_EQ(cycles_after(std::nan("")), -1);
  }
}

TEST(EncoderWatchEdges, AfterASuddenStopTheTorqueGoesOnToo) {
  Bench bench;
  bench.state().theta_dot[1] = 0.1;
  bench.next(1e-3);
  bench.state().theta_dot[1] = 0.0;
  bench.next(1e-3);                     // 0.0001 rad
  bench.state().tau_applied[1] = 60.0;  // 30 rad/s^2, whatever friction holds
  EXPECT_EQ(bench.next(0.01), -1);      // 0.0001 + 0.4 rad/s 0.01 s
  EXPECT_EQ(bench.next(0.01), 1);       // and 0.7 rad/s 0.01 s
}

TEST(EncoderWatchEdges, AfterASuddenStopATorqueThatCarriesTheWeightIsNone) {
  Bench bench;
  bench.state().theta_dot[1] = 0.1;
  bench.next(1e-3);
  bench.state().theta_dot[1] = 0.0;
  bench.next(1e-3);
  bench.state().tau_applied[1] = 60.0;
  for (int k = 0; k < 4; ++k) EXPECT_EQ(bench.next(0.01, 60.0), -1) << "0.1 rad/s, 0.01 s";
}

// v_0 = 0.04 rad/s; 1.5 rad/s^2 along it or against it, 1 rad/s^2 of friction: after 0.22 s 0.033
// or 0.015 rad.
TEST(EncoderWatchEdges, ATorqueDrivesTheJointItsOwnWay) {
  for (const double sign : {1.0, -1.0}) {
    Bench bench;
    bench.state().theta_dot[1] = 0.04;
    bench.next(1e-3);
    bench.state().theta_dot[1] = 0.0;
    bench.next(1e-3);
    bench.torque(sign * 3.0);
    bench.state().theta[0] = 1.0;
    EXPECT_EQ(bench.next(0.22), sign > 0.0 ? 1 : -1);
  }
}

// v_0 = 0.04 rad/s, 1 rad/s^2 of friction: at rest after 40 cycles, 0.8 mrad on.
TEST(EncoderWatchEdges, FrictionEndsWhatIsNotSudden) {
  Bench bench;
  bench.state().theta_dot[1] = 0.04;
  bench.next(1e-3);
  bench.state().theta_dot[1] = 0.0;
  bench.state().theta[0] = 1.0;
  for (int k = 0; k < 10'000; ++k) ASSERT_EQ(bench.next(1e-3), -1) << k;
}

TEST(EncoderWatchEdges, CyclesWithoutAnAnswerDoNotCount) {
  Bench bench;
  bench.state().theta_dot[1] = 0.41;
  bench.next(1e-3);
  bench.state().theta_dot[1] = 0.0;
  for (int k = 0; k < 10; ++k) ASSERT_EQ(bench.next(1e-3), -1) << k;
  bench.state().age_cycles[1] = 1;
  for (int k = 0; k < 1000; ++k) ASSERT_EQ(bench.next(1e-3), -1) << "the last answer again";
  bench.state().age_cycles[1] = 0;
  for (int k = 10; k < 25; ++k) ASSERT_EQ(bench.next(1e-3), -1) << k;
  EXPECT_EQ(bench.next(1e-3), 1);
}

}  // namespace
}  // namespace limber::controller::test_encoder_watch_edges
