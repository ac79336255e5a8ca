// Saturation, then rate: what passes a limiter unchanged and what becomes of the rest.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "controller/output/torque_limiter.h"

namespace limber::controller::test_torque_limiter {
namespace {

constexpr double kT = 1e-3;
constexpr double kPi = std::numbers::pi;

VectorJ one(double x) { return VectorJ::Constant(1, x); }

double limited(TorqueLimiter* limiter, double wanted) {
  VectorJ tau = one(wanted);
  limiter->limit(kT, &tau);
  return tau[0];
}

TEST(TorqueLimiter, SaturatesBeforeItCountsTheStep) {
  TorqueLimiter limiter(one(10.0), one(4000.0));
  limiter.set_previous(one(7.0));
  VectorJ tau = one(30.0);
  const TorqueLimiter::Acted acted = limiter.limit(kT, &tau);
  EXPECT_EQ(tau[0], 10.0) << "3 N m to the limit is less than a step of 4 N m";
  EXPECT_TRUE(acted.torque);
  EXPECT_FALSE(acted.rate);
  EXPECT_EQ(limited(&limiter, -30.0), 6.0) << "counted from what was sent";
  EXPECT_EQ(limited(&limiter, 5.0), 5.0);
  EXPECT_EQ(limited(&limiter, std::nan("")), 5.0);
  EXPECT_EQ(limited(&limiter, -INFINITY), 1.0);
}

// Greatest change that a limiter of 100 N m/s makes to a sine of amplitude a, 5 Hz.
double change_of_sine(double a) {
  TorqueLimiter limiter(one(1e3), one(100.0));
  double worst = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const double wanted = a * std::sin(2.0 * kPi * 5.0 * (k + 0.5) * kT);
    worst = std::max(worst, std::abs(limited(&limiter, wanted) - wanted));
  }
  return worst;
}

TEST(TorqueLimiter, PassesASineUpToItsOnset) {
  const double onset = 100.0 * kT / (2.0 * std::sin(kPi * 5.0 * kT));
  EXPECT_LT(change_of_sine(0.9999 * onset), 1e-12);
  EXPECT_GT(change_of_sine(1.001 * onset), 1e-6);
}

TEST(TorqueLimiter, LeavesATriangleOfALargeSine) {
  TorqueLimiter limiter(one(1e6), one(100.0));
  double peak = 0.0;
  for (int k = 0; k < 4000; ++k) {
    const double tau = limited(&limiter, 1e5 * std::sin(2.0 * kPi * 2.0 * k * kT));
    if (k > 2000) peak = std::max(peak, tau);
  }
  // From rest the triangle runs between 0 and twice its amplitude.
  EXPECT_NEAR(0.5 * peak, 100.0 / (4.0 * 2.0), 0.01 * 12.5);
}

}  // namespace
}  // namespace limber::controller::test_torque_limiter
