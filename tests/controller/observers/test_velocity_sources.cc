// Each source of velocities through the whole cycle: amplitude and lag on a sine are those of its
// equation, and a change of source at speed changes nothing at once.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "controller/observers/alpha_beta.h"
#include "tests/controller/rig.h"

namespace limber::test_velocity_sources {
namespace {

using limber::testing::Rig;
using Gains = compliance_gains_t;
using Complex = std::complex<double>;

constexpr double kT = 1e-3;
constexpr double kAmplitude = 0.1;                 // m
constexpr double kOmega = 4.0 * std::numbers::pi;  // 2 Hz: 500 samples
constexpr double kAcceleration = 50.0;             // default bound
constexpr double kSpeed = kAmplitude * kOmega;

// Moved by hand along a sine, drives off.
struct Sine {
  explicit Sine(std::int8_t source) : rig(limber::testing::slider()) { choose(source); }
  void choose(std::int8_t source) {
    Gains gains = rig.gains();
    gains.velocity = source;
    EXPECT_EQ(rig.controller.on_gains(gains), nullptr);
  }
  /// The estimate after one more step.
  double step() {
    const double phase = kOmega * kT * static_cast<double>(rig.state.seq + 1);
    rig.plant.q[0] = kAmplitude * std::sin(phase);
    rig.plant.v[0] = kSpeed * std::cos(phase);
    rig.step();
    return rig.controller.status().V_BT[0];
  }
  double exact() const {
    return kSpeed * std::cos(kOmega * kT * static_cast<double>(rig.state.seq));
  }
  /// Estimate over position as phasors, over one period after the start is forgotten.
  Complex response() {
    for (int i = 0; i < 1500; ++i) step();
    Complex sum = 0.0;
    for (int i = 0; i < 500; ++i) {
      const double v = step();
      sum += v * std::exp(Complex(0.0, -kOmega * kT * static_cast<double>(rig.state.seq)));
    }
    return sum / 250.0 / (kAmplitude * Complex(0.0, -1.0));  // sin = Re(-i exp(i phase))
  }

  Rig rig;
};

const Complex kZ = std::exp(Complex(0.0, kOmega* kT));

void expect_near(Complex found, Complex expected) {
  EXPECT_LT(std::abs(found - expected), 1e-6 * std::abs(expected));
}

TEST(VelocitySources, DriveIsExact) {
  expect_near(Sine(Gains::VELOCITY_DRIVE).response(), Complex(0.0, kOmega));
}

// (1 - a) (1 - 1/z) / T / (1 - a / z), a = exp(-300 T)
TEST(VelocitySources, FilteredDifference) {
  const double a = std::exp(-300.0 * kT);
  expect_near(Sine(Gains::VELOCITY_FILTERED_DIFFERENCE).response(),
              (1.0 - a) * (1.0 - 1.0 / kZ) / kT / (1.0 - a / kZ));
}

// (beta / T) z (z - 1) / (z^2 - (2 - alpha - beta) z + 1 - alpha)
TEST(VelocitySources, AlphaBeta) {
  Sine sine(Gains::VELOCITY_ALPHA_BETA);
  const double count =
      2.0 * std::numbers::pi / sine.rig.robot.robot.joints[0].drive.counts_per_turn;
  const controller::AlphaBetaGains gains(kAcceleration, count / std::sqrt(12.0), kT);
  expect_near(sine.response(),
              gains.beta / kT * kZ * (kZ - 1.0) /
                  (kZ * kZ - (2.0 - gains.alpha - gains.beta) * kZ + 1.0 - gains.alpha));
}

// Finite-time convergence, then an error of order L T (Levant 1998).
TEST(VelocitySources, Levant) {
  Sine sine(Gains::VELOCITY_LEVANT);
  for (int i = 0; i < 1500; ++i) sine.step();
  double worst = 0.0;
  for (int i = 0; i < 500; ++i) {
    const double v = sine.step();
    worst = std::max(worst, std::abs(v - sine.exact()));
  }
  EXPECT_LT(worst, 3.0 * kAcceleration * kT);
  EXPECT_GT(worst, 0.0) << "it is not the drive's";
}

// At full speed, from any source to any other: nothing falls back to zero. The lags are at most
// those of the slowest filter, and at the crest the speed does not change within them.
TEST(VelocitySources, AChangeGoesOnFromTheSpeedThereIs) {
  for (std::int8_t from = 0; from <= 3; ++from) {
    for (std::int8_t to = 0; to <= 3; ++to) {
      Sine sine(from);
      while (sine.rig.state.seq < 2000) sine.step();  // a crest of the speed
      sine.choose(to);
      for (int i = 0; i < 50; ++i) {
        ASSERT_NEAR(sine.step(), sine.exact(), 0.25 * kSpeed) << int{from} << int{to} << ' ' << i;
      }
    }
  }
}

TEST(VelocitySources, AChangeDoesNotJumpTheTorque) {
  Rig rig(limber::testing::seven_joint_arm());
  rig.to_active();
  compliance_goal_t circle = rig.goal();
  circle.kind = compliance_goal_t::GOAL_CIRCLE;
  circle.offset[0] = -0.05;
  circle.offset[5] = 1.0;
  circle.duration_s = 1.5;
  ASSERT_EQ(rig.controller.on_goal(circle), nullptr);
  rig.run(2.0);
  rig.clear_jumps();
  rig.run(1.5);
  const double usual = rig.jump();
  for (const std::int8_t source : {1, 2, 0, 2, 1, 0}) {
    Gains gains = rig.gains();
    gains.velocity = source;
    ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
    rig.clear_jumps();
    rig.run(0.3);
    EXPECT_LT(rig.jump(), usual + 0.1) << int{source};
  }
}

// Another rate than robot.yaml's: what counts is the period the states carry.
TEST(VelocitySources, TakeThePeriodOfTheStates) {
  Rig rig(limber::testing::slider());
  rig.state.period_ns = 500'000;
  Gains gains = rig.gains();
  gains.velocity = Gains::VELOCITY_FILTERED_DIFFERENCE;
  ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
  for (int i = 0; i < 200; ++i) {
    rig.plant.q[0] = 0.5 * 0.5e-3 * i;  // 0.5 m/s
    rig.step();
  }
  EXPECT_NEAR(rig.controller.status().V_BT[0], 0.5, 1e-9);
}

}  // namespace
}  // namespace limber::test_velocity_sources
