// Two motors that pull against each other: their preload, their limits.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "controller/output/preload_servo.h"
#include "tests/controller/one_joint.h"
#include "tools/allocations/allocations.h"

namespace limber::controller::test_preload_servo {
namespace {

constexpr double kT = 1e-3;
constexpr double kB = 0.04;

VectorJ one(double x) { return VectorJ::Constant(1, x); }

class Preload : public ::testing::Test {
 protected:
  Preload() : robot(limber::testing::one_pair({.B = kB}).robot), servo(robot), state(1) {
    state.period_s = kT;
  }

  // B c'' = tau_preload - k2 (c^2 + x^2)
  void run(double seconds, double wanted, double x, double tau) {
    for (int i = 0; i < static_cast<int>(seconds / kT); ++i) {
      control(one(wanted), one(x), one(tau));
      const double force = servo.torque()[0] - 400.0 * (std::pow(state.preload[0], 2) + x * x);
      state.preload_dot[0] += kT * force / kB;
      state.preload[0] += kT * state.preload_dot[0];
    }
  }

  // The drives apply what they were sent.
  void control(const VectorJ& wanted, const VectorJ& x, const VectorJ& tau) {
    state.tau_preload_applied = servo.torque();
    servo.control(state, wanted, x, tau, kT);
  }

  // The drives carry tau; no law runs.
  void take_over(double tau) {
    state.tau_preload_applied[0] = tau;
    servo.rest(state, PreloadAtRest::kAsApplied, false);
  }

  Robot robot;
  PreloadServo servo;
  ArmState state;
};

TEST_F(Preload, MovesAlongItsRampAndHoldsTheSprings) {
  state.preload[0] = 0.1;
  take_over(400.0 * 0.01);
  EXPECT_EQ(servo.torque()[0], 400.0 * 0.01);
  run(0.25, 0.4, 0.0, 0.0);
  EXPECT_NEAR(state.preload[0], 0.1 + 0.25 * 0.6, 0.02) << "preload_max a second";
  run(1.0, 0.4, 0.05, 0.0);
  EXPECT_NEAR(state.preload[0], 0.4, 1e-4);
  EXPECT_NEAR(servo.torque()[0], 400.0 * (0.16 + 0.0025), 0.02);
  run(2.0, 5.0, 0.0, 0.0);
  EXPECT_NEAR(state.preload[0], 0.6, 1e-4) << "no further than preload_max";
}

TEST_F(Preload, LeavesTheMotorsWhatTheJointNeeds) {
  state.preload[0] = 0.3;
  take_over(36.0);
  state.preload[0] = -5.0;  // far off: it would pull with all it has
  for (int i = 0; i < 500; ++i) {
    const double before = servo.torque()[0];
    const double tau = 50.0 * std::sin(0.02 * i);
    control(one(0.3), one(0.0), one(tau));
    EXPECT_LE(std::abs(servo.torque()[0] - before), 0.8 + 1e-12) << "the gate's step";
  }
  for (const double tau : {-50.0, 10.0}) {
    for (int i = 0; i < 200; ++i) control(one(0.3), one(0.0), one(tau));
    EXPECT_NEAR(servo.torque()[0] + std::abs(tau), 2.0 * 80.0, 1e-9);  // |tau +- tau_preload| / 2
  }
}

// The springs are not those of robot.yaml, 36 N m at this preload: whatever the drives apply goes
// on without a step, and fades over to what robot.yaml's springs need.
TEST_F(Preload, StartsFromWhatTheDrivesApply) {
  state.preload[0] = 0.3;
  for (const double applied : {0.0, 21.0, 50.0}) {
    take_over(applied);
    EXPECT_EQ(servo.torque()[0], applied);
    control(one(0.3), one(0.0), one(0.0));
    EXPECT_NEAR(servo.torque()[0], applied, 1e-12);
    for (int i = 1; i <= 500; ++i) {
      control(one(0.3), one(0.0), one(0.0));
      const double left = 0.5 + 0.5 * std::cos(std::numbers::pi * i / 500.0);
      EXPECT_NEAR(servo.torque()[0], 36.0 + left * (applied - 36.0), 1e-9);
    }
  }
}

// The gate's step is 2 N m: nine tenths of it, however many answers are lost.
TEST_F(Preload, StaysNearDrivesThatAreSentNothingNew) {
  state.preload[0] = 0.3;
  take_over(36.0);
  for (const double far : {-5.0, 5.0}) {
    state.preload[0] = far;
    for (int i = 0; i < 500; ++i) {
      servo.control(state, one(0.3), one(0.0), one(0.0), kT);
      EXPECT_LE(std::abs(servo.torque()[0] - 36.0), 1.8 + 1e-12);
    }
    EXPECT_NEAR(servo.torque()[0], far < 0.0 ? 37.8 : 34.2, 1e-12);
  }
}

TEST_F(Preload, LetsGoInSteps) {
  state.preload[0] = 0.3;
  take_over(36.0);
  servo.rest(state, PreloadAtRest::kReleased, true);
  EXPECT_NEAR(servo.torque()[0], 36.0 - 0.8, 1e-12);
  for (int i = 0; i < 100; ++i) servo.rest(state, PreloadAtRest::kReleased, true);
  EXPECT_EQ(servo.torque()[0], 0.0);
}

TEST_F(Preload, DoesNotAllocate) {
  const auto before = limber::allocations();
  run(0.01, 0.3, 0.0, 1.0);
  servo.rest(state, PreloadAtRest::kAsApplied, true);
  EXPECT_EQ(limber::allocations(), before);
}

}  // namespace
}  // namespace limber::controller::test_preload_servo
