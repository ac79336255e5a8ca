// The drive's joint torque loop against its closed forms, on a rotor behind a spring whose link is
// held: B theta'' = tau_m - K theta - D theta'.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "sim/nodes/joint_torque_loop.h"

namespace limber::sim::test_joint_torque_loop {
namespace {

constexpr double kB = 0.2;
constexpr double kK = 5000.0;
constexpr double kD = 2.0;

struct Ringing {
  double omega = 0.0;  // rad/s, damped
  double zeta = 0.0;
  double growth = 0.0;  // of the peaks over the run
};

/// Lets the rotor go at 1 mrad and times its swings, in steps of 1 us against 20 ms of a swing.
Ringing ring(double ratio, double rate_hz, double delay_s = 0.0) {
  constexpr std::int64_t kStep_ns = 1000;
  JointTorqueLoop loop({ratio, rate_hz, delay_s});
  loop.set(ratio, kD / kK);
  double theta = 1e-3;
  double speed = 0.0;
  std::vector<double> crossings, peaks;
  for (std::int64_t now = kStep_ns; now < 200'000'000; now += kStep_ns) {
    const double h = 1e-9 * static_cast<double>(kStep_ns);
    const double before = theta;
    const double speed_before = speed;
    speed += h / kB * (loop.torque(0.0) - kK * theta - kD * speed);
    theta += h * speed;
    loop.update(kK * theta, now);
    if (before > 0.0 && theta <= 0.0)
      crossings.push_back(1e-9 * static_cast<double>(now) + h * theta / (before - theta));
    if (speed_before > 0.0 && speed <= 0.0) peaks.push_back(theta);
  }
  const auto n = static_cast<double>(crossings.size() - 1);
  Ringing out;
  out.omega = 2.0 * M_PI * n / (crossings.back() - crossings.front());
  out.growth = peaks.back() / peaks[1];
  const double decrement = -std::log(out.growth) / static_cast<double>(peaks.size() - 2);
  out.zeta = decrement / std::hypot(2.0 * M_PI, decrement);
  return out;
}

/// B_theta = B / rho takes the rotor's place; hold and difference are a delay of half a period T,
/// which takes (rho - 1) K T / 2 off the damping.
TEST(JointTorqueLoop, TheRotorSeemsLighter) {
  for (const double ratio : {1.0, 2.0, 4.0}) {
    constexpr double kRate = 10'000.0;
    const Ringing seen = ring(ratio, kRate);
    const double natural = std::sqrt(ratio * kK / kB);
    const double damping = ratio * kD - (ratio - 1.0) * kK / (2.0 * kRate);
    const double zeta = damping / (2.0 * std::sqrt(ratio * kK * kB));
    EXPECT_NEAR(seen.omega / (natural * std::sqrt(1.0 - zeta * zeta)), 1.0, 0.01) << ratio;
    EXPECT_NEAR(seen.zeta / zeta, 1.0, 0.05) << ratio;
  }
}

/// Held for T and delayed by t_d it is stable while (rho - 1) K (T / 2 + t_d) < rho D, all that
/// damps the motor.
TEST(JointTorqueLoop, StableUpToTheSampledLimit) {
  constexpr double kRate = 8000.0;
  constexpr double kDelay_s = 4.0 / kRate;
  constexpr double kHold = kK * (0.5 / kRate + kDelay_s);
  constexpr double kLimit = kHold / (kHold - kD);
  EXPECT_LT(ring(0.9 * kLimit, kRate, kDelay_s).growth, 1.0);
  EXPECT_GT(ring(1.1 * kLimit, kRate, kDelay_s).growth, 1.0);
}

TEST(JointTorqueLoop, AtRestItIsTheFormula) {
  JointTorqueLoop loop({4.0, 4000.0, 0.0});
  loop.set(4.0, kD / kK);
  for (std::int64_t i = 1; i <= 100; ++i) loop.update(10.0, i * 250'000);
  EXPECT_DOUBLE_EQ(loop.torque(3.0), 4.0 * 3.0 - 3.0 * 10.0);
  loop.set(1.0, kD / kK);
  EXPECT_DOUBLE_EQ(loop.torque(3.0), 3.0);
}

TEST(JointTorqueLoop, SamplesAtItsRateWhateverTheSteps) {
  for (const double rate_hz : {3000.0, 4000.0, 10'000.0}) {
    JointTorqueLoop loop({2.0, rate_hz, 0.0});
    loop.set(2.0, 0.0);
    int samples = 0;
    double last = loop.torque(0.0);
    for (std::int64_t i = 1; i <= 60'000;
         ++i) {  // a second in steps of 1/60 ms, cut to nanoseconds
      loop.update(static_cast<double>(i), i * 1'000'000 / 60);
      samples += loop.torque(0.0) != last ? 1 : 0;
      last = loop.torque(0.0);
    }
    EXPECT_EQ(samples, static_cast<int>(rate_hz));
  }
}

TEST(JointTorqueLoop, DelayIsWholeSamples) {
  JointTorqueLoop loop({2.0, 1000.0, 3.2e-3});
  loop.set(2.0, 0.0);
  for (std::int64_t i = 1; i <= 10; ++i) {
    loop.update(static_cast<double>(i), i * 1'000'000);
    EXPECT_DOUBLE_EQ(loop.torque(0.0), i > 3 ? -static_cast<double>(i - 3) : 0.0);
  }
}

TEST(JointTorqueLoop, TheDerivativeSettlesOnARamp) {
  constexpr double kSlope = 700.0;  // N m/s
  JointTorqueLoop loop({3.0, 4000.0, 0.0});
  loop.set(3.0, kD / kK);
  double sensed = 0.0;
  for (std::int64_t i = 1; i <= 40; ++i) {
    sensed = kSlope * static_cast<double>(i) / 4000.0;
    loop.update(sensed, i * 250'000);
  }
  EXPECT_NEAR(loop.torque(0.0), -2.0 * (sensed + kD / kK * kSlope), 1e-9);
}

}  // namespace
}  // namespace limber::sim::test_joint_torque_loop
