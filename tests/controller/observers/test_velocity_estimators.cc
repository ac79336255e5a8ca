// Three ways to a velocity, each against what its equation promises.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "common/config_error.h"
#include "controller/observers/alpha_beta.h"
#include "controller/observers/filtered_difference.h"
#include "controller/observers/levant.h"
#include "tools/allocations/allocations.h"

namespace limber::controller::test_velocity_estimators {
namespace {

constexpr double kT = 1e-3;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

VectorJ one(double x) { return VectorJ::Constant(1, x); }

TEST(FilteredDifference, OfARampRisesAsOnePole) {
  FilteredDifference<VectorJ> filter(2, 50.0, kT);
  const VectorJ rate = (VectorJ(2) << 2.0, -0.5).finished();
  for (int k = 0; k < 200; ++k) {
    const VectorJ v = filter.update(k * kT * rate);
    EXPECT_LT((v - (1.0 - std::exp(-50.0 * kT * k)) * rate).norm(), 1e-10) << k;
  }
}

TEST(FilteredDifference, NoiseGainIsTheEnergyOfTheImpulseResponse) {
  FilteredDifference<VectorJ> filter(1, 300.0, kT);
  filter.update(one(0.0));
  double energy = 0.0;
  for (int k = 0; k < 400; ++k) energy += std::pow(filter.update(one(k == 0 ? 1.0 : 0.0))[0], 2);
  const double a = std::exp(-300.0 * kT);
  EXPECT_NEAR(std::sqrt(energy), (1.0 - a) / kT * std::sqrt(2.0 / (1.0 + a)), 1e-9);
}

TEST(FilteredDifference, LagsByItsDelay) {
  FilteredDifference<VectorJ> filter(1, 100.0, kT);
  constexpr double acceleration = 3.0;
  double v = 0.0;
  for (int k = 0; k <= 1000; ++k) v = filter.update(one(0.5 * acceleration * k * k * kT * kT))[0];
  const double a = std::exp(-100.0 * kT);
  const double delay = a * kT / (1.0 - a) + 0.5 * kT;
  EXPECT_NEAR(v, acceleration * (1000 * kT - delay), 1e-9);
}

// The stationary Kalman filter by iterating its Riccati equation.
Eigen::Vector2d kalman_gain(double s_a, double s_x) {
  const Eigen::Vector2d G(0.5 * kT * kT, kT);
  Eigen::Matrix2d F;
  F << 1.0, kT, 0.0, 1.0;
  Eigen::Matrix2d P = Eigen::Matrix2d::Identity();
  Eigen::Vector2d K;
  for (int i = 0; i < 20000; ++i) {
    P = (F * P * F.transpose() + s_a * s_a * G * G.transpose()).eval();
    K = P.col(0) / (P(0, 0) + s_x * s_x);
    P = (P - K * P.row(0)).eval();
  }
  return K;
}

TEST(AlphaBeta, GainsSolveTheRiccatiEquation) {
  for (const double s_a : {5.0, 100.0, 3000.0}) {
    const AlphaBetaGains gains(s_a, 1e-4, kT);
    const Eigen::Vector2d K = kalman_gain(s_a, 1e-4);
    EXPECT_NEAR(gains.alpha, K[0], 1e-7 * K[0]);
    EXPECT_NEAR(gains.beta, kT * K[1], 1e-7 * kT * K[1]);
  }
}

TEST(AlphaBeta, FollowsConstantVelocityWithoutLag) {
  AlphaBeta filter(1, AlphaBetaGains(100.0, 1e-4, kT), kT);
  EXPECT_EQ(filter.update(one(0.7))[0], 0.0) << "the first sample is only a position";
  EXPECT_EQ(filter.position()[0], 0.7);
  for (int k = 1; k < 1000; ++k) filter.update(one(0.7 - 2.0 * k * kT));
  EXPECT_NEAR(filter.velocity()[0], -2.0, 1e-9);
  EXPECT_NEAR(filter.position()[0], 0.7 - 2.0 * 0.999, 1e-12);
  filter.update(one(kNan));
  EXPECT_NEAR(filter.position()[0], 0.7 - 2.0, 1e-9) << "goes on by itself";
}

TEST(Levant, TwoStepsByHand) {
  LevantDifferentiator levant(1, 4.0, 0.1);
  EXPECT_EQ(levant.update(one(1.0))[0], 0.0);
  // z0 - x = -0.25: z0 += 0.1 (1.5 * 2 * 0.5 + 0) = 0.15; z1 += 0.1 * 1.1 * 4 = 0.44.
  EXPECT_NEAR(levant.update(one(1.25))[0], 0.44, 1e-15);
  // z0 - x = 1.15 - 1.15 = 0: z0 follows z1 to 1.194, z1 stays.
  EXPECT_NEAR(levant.update(one(1.15))[0], 0.44, 1e-7);
  // z0 - x = 0.04: z1 -= 0.44.
  EXPECT_NEAR(levant.update(one(1.154))[0], 0.0, 1e-7);
}

double worst_levant_error(double T) {
  LevantDifferentiator levant(1, 5.0, T);
  double worst = 0.0;
  for (int k = 0; k * T < 6.0; ++k) {
    const double t = k * T;
    const double v = levant.update(one(std::sin(2.0 * t)))[0];  // |x''| <= 4
    if (t > 3.0) worst = std::max(worst, std::abs(v - 2.0 * std::cos(2.0 * t)));
  }
  return worst;
}

TEST(Levant, ErrorIsOfTheOrderOfTheSampleTime) {
  const double coarse = worst_levant_error(1e-3);
  EXPECT_LT(coarse, 5.0 * 5.0 * 1e-3);
  EXPECT_NEAR(coarse / worst_levant_error(1e-4), 10.0, 4.0);
}

TEST(VelocityEstimators, LeaveOutWhatIsNotFinite) {
  FilteredDifference<VectorJ> difference(1, 50.0, kT);
  LevantDifferentiator levant(1, 10.0, kT);
  EXPECT_EQ(difference.update(one(kNan))[0], 0.0);
  EXPECT_EQ(levant.update(one(kNan))[0], 0.0);
  for (int k = 0; k < 100; ++k) {
    difference.update(one(k * kT));
    levant.update(one(k * kT));
  }
  const double before[] = {difference.velocity()[0], levant.velocity()[0]};
  EXPECT_EQ(difference.update(one(kNan))[0], before[0]);
  EXPECT_EQ(levant.update(one(kNan))[0], before[1]);
}

TEST(VelocityEstimators, RefuseWhatCannotWork) {
  EXPECT_THROW(FilteredDifference<VectorJ>(1, 0.0, kT), ConfigError);
  EXPECT_THROW(FilteredDifference<VectorJ>(1, 50.0, kNan), ConfigError);
  EXPECT_THROW(AlphaBetaGains(1.0, 0.0, kT), ConfigError);
  EXPECT_THROW(LevantDifferentiator(1, -1.0, kT), ConfigError);
}

TEST(VelocityEstimators, StartAgainAfterReset) {
  FilteredDifference<VectorJ> difference(1, 50.0, kT);
  AlphaBeta tracker(1, AlphaBetaGains(100.0, 1e-4, kT), kT);
  LevantDifferentiator levant(1, 10.0, kT);
  for (int k = 0; k < 10; ++k) {
    difference.update(one(k));
    tracker.update(one(k));
    levant.update(one(k));
  }
  difference.reset();
  tracker.reset();
  levant.reset();
  EXPECT_EQ(difference.update(one(-5.0))[0], 0.0);
  EXPECT_EQ(tracker.update(one(-5.0))[0], 0.0);
  EXPECT_EQ(levant.update(one(-5.0))[0], 0.0);
}

TEST(VelocityEstimators, DoNotAllocate) {
  FilteredDifference<VectorJ> difference(16, 50.0, kT);
  TipAcceleration acceleration(6, 50.0, kT);
  AlphaBeta tracker(16, AlphaBetaGains(100.0, 1e-4, kT), kT);
  LevantDifferentiator levant(16, 10.0, kT);
  const VectorJ x = VectorJ::Ones(16);
  const auto before = limber::allocations();
  for (int k = 0; k < 3; ++k) {
    difference.update(k * x);
    acceleration.update(k * Vector6::Ones());
    tracker.update(k * x);
    levant.update(k * x);
  }
  EXPECT_EQ(limber::allocations(), before);
}

}  // namespace
}  // namespace limber::controller::test_velocity_estimators
