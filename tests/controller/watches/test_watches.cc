// An arm that moves away while it is held, and an encoder that has stopped: when they are noticed.
#include <gtest/gtest.h>

#include <cmath>

#include "controller/watches/encoder_watch.h"
#include "controller/watches/start_watch.h"

namespace limber::controller::test_watches {
namespace {

constexpr double kPeriod_s = 1e-3;

joint_state_t state_of(int joints) {
  joint_state_t state{};
  state.num_joints = static_cast<std::int8_t>(joints);
  return state;
}

TEST(StartWatch, FindsTheJointThatMovesAwayInTheFirstSecond) {
  Robot robot;
  robot.joints.resize(4);
  for (JointConfig& joint : robot.joints) {
    joint.position_min = -1.0;
    joint.position_max = 1.0;
  }
  robot.joints[0].transmission.kind = TransmissionKind::kElastic;
  StartWatch watch(robot);
  joint_state_t state = state_of(4);
  state.theta[3] = 0.95;
  state.theta[1] = 0.7;
  EXPECT_EQ(watch.strayed(state), -1) << "not begun";
  watch.begin(state);
  state.theta[1] = 0.7 - 0.099;
  EXPECT_EQ(watch.strayed(state), -1);
  state.theta[1] = 0.7 - 0.101;
  EXPECT_EQ(watch.strayed(state), 1);
  state.time_ns = 1'000'000'000;
  EXPECT_EQ(watch.strayed(state), 1);
  state.time_ns += 1;
  EXPECT_EQ(watch.strayed(state), -1);
  watch.begin(state);
  state.theta[0] += 0.29;
  EXPECT_EQ(watch.strayed(state), -1) << "the springs give way";
  state.theta[3] -= 0.2;
  EXPECT_EQ(watch.strayed(state), -1) << "the soft wall pushes";
  state.theta[0] += 0.02;
  EXPECT_EQ(watch.strayed(state), 0);
  state.theta_dot[0] = -2.0;
  watch.begin(state);
  state.theta[1] += 0.69;
  EXPECT_EQ(watch.strayed(state), -1) << "it swings: 0.1 + 0.3 * 2";
  state.theta[1] += 0.02;
  EXPECT_EQ(watch.strayed(state), 1);
  watch.begin(state);
  state.theta[2] = std::nan("");
  EXPECT_EQ(watch.strayed(state), 2);
  watch.end();
  EXPECT_EQ(watch.strayed(state), -1);
}

/// Two joints of 40 N m, 3 N m of friction in the first; M = diag(0.5, 0.2).
class EncoderWatchTest : public ::testing::Test {
 protected:
  EncoderWatchTest() : watch_(robot()) { M_.diagonal() << 0.5, 0.2; }

  static Robot robot() {
    Robot robot;
    robot.joints.resize(2);
    for (JointConfig& joint : robot.joints) {
      joint.torque_limit_Nm = 40.0;
      joint.velocity_limit = 100.0;
    }
    robot.joints[0].friction.coulomb_Nm = 3.0;
    return robot;
  }
  /// Cycles until a stop is found, 5000 if it is not; the other joint turns at `other` rad/s.
  int cycles_until_found(double tau, double other, int joint = 0) {
    joint_state_t state = state_of(2);
    state.tau_applied[joint] = tau;
    VectorJ gravity = VectorJ::Zero(2);
    gravity[joint] = kGravity;
    state.tau_applied[joint] = kGravity + kLoad;
    for (int k = 0; k < 1000; ++k) watch_.stopped(state, {gravity, CTv_, M_}, kPeriod_s);
    state.tau_applied[joint] = tau + kLoad;
    for (int cycle = 1; cycle < 5000; ++cycle) {
      state.theta[1 - joint] = state.q[1 - joint] += other * kPeriod_s;
      const int found = watch_.stopped(state, {gravity, CTv_, M_}, kPeriod_s);
      if (found >= 0) {
        EXPECT_EQ(found, joint);
        return cycle;
      }
      if (moves_) state.theta[joint] += 1e-6;
    }
    return 5000;
  }
  /// t^2 = 2 kExpected M / excess; the residual, whose memory is 20 ms, comes to
  /// friction and then to all of it.
  static void expect_found(int cycles, double excess, double M) {
    const double free_s = std::sqrt(2.0 * EncoderWatch::kExpected * M / excess);
    EXPECT_NEAR(cycles * kPeriod_s, free_s + 0.025, 0.01);
  }

  static constexpr double kGravity = 2.0;
  static constexpr double kLoad = 9.0;  ///< carried from the start, unknown to the model
  EncoderWatch watch_;
  MatrixJ M_ = MatrixJ::Zero(2, 2);
  VectorJ CTv_ = VectorJ::Zero(2);
  bool moves_ = false;
};

TEST_F(EncoderWatchTest, NoticesWhenTheFreeJointWouldHaveMoved) {
  // Beyond gravity and friction, which may have held the other way: 18 - 2 - 2 * 3 = 10 N m.
  expect_found(cycles_until_found(18.0, 1.0), 10.0, 0.5);
  watch_.reset();  // and beyond no load at all: 20 - 9 + 2 - 3
  expect_found(cycles_until_found(-20.0, 1.0), 10.0, 0.5);
  watch_.reset();  // without friction in robot.yaml: a twentieth of the limit, 2 N m
  expect_found(cycles_until_found(10.0, 1.0, 1), 4.0, 0.2);
}

TEST_F(EncoderWatchTest, AnArmThatLeansAgainstSomethingIsLeftAlone) {
  EXPECT_EQ(cycles_until_found(15.0, 0.0), 5000);
}

// Leaving a wall takes the load off every joint, and friction may keep one of them where it is.
TEST_F(EncoderWatchTest, ALoadThatGoesIsNoSignOfAStop) {
  const auto cycles_at_load = [this](double load) {
    watch_.reset();
    return cycles_until_found(load - kLoad + kGravity, 1.0);
  };
  EXPECT_EQ(cycles_at_load(0.0), 5000) << "from 9 N m to none";
  EXPECT_EQ(cycles_at_load(-2.9), 5000) << "and friction beyond";
  EXPECT_LT(cycles_at_load(-3.5), 5000);
}

TEST_F(EncoderWatchTest, FrictionMayHoldAJoint) { EXPECT_EQ(cycles_until_found(4.9, 1.0), 5000); }

TEST_F(EncoderWatchTest, AnEncoderThatCountsIsLeftAlone) {
  moves_ = true;
  EXPECT_EQ(cycles_until_found(15.0, 1.0), 5000);
}

}  // namespace
}  // namespace limber::controller::test_watches
