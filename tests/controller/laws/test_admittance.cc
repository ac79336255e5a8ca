// The admittance moves as its mass, spring and damper would, and stays stable when they would not.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/config_error.h"
#include "controller/model/pose_error.h"
#include "controller/model/rotation.h"
#include "controller/observers/admittance_filter.h"
#include "tests/controller/arms.h"
#include "tools/allocations/allocations.h"

namespace limber::controller::test_admittance {
namespace {

MatrixJ one(double x) { return MatrixJ::Constant(1, 1, x); }
VectorJ vec(double x) { return VectorJ::Constant(1, x); }

TEST(AdmittanceFilter, FirstStepsByHand) {
  AdmittanceFilter filter(one(2.0), one(10.0), one(100.0), 0.1);  // M + T D + T^2 K = 4
  filter.update(vec(8.0));
  EXPECT_NEAR(filter.v()[0], 0.2, 1e-15);
  EXPECT_NEAR(filter.x()[0], 0.02, 1e-15);
  filter.update(vec(0.0));  // (2 * 0.2 - 0.1 * 100 * 0.02) / 4
  EXPECT_NEAR(filter.v()[0], 0.05, 1e-15);
  EXPECT_NEAR(filter.x()[0], 0.025, 1e-15);
}

// Error of the step response of M x'' + D x' + K x = F at half a second.
double step_error(double T) {
  constexpr double m = 2.0;
  constexpr double d = 8.0;
  constexpr double k = 200.0;
  AdmittanceFilter filter(one(m), one(d), one(k), T);
  const int steps = static_cast<int>(std::lround(0.5 / T));
  for (int i = 0; i < steps; ++i) filter.update(vec(6.0));
  const double decay = d / (2.0 * m);
  const double w = std::sqrt(k / m - decay * decay);
  const double t = 0.5;
  const double exact =
      6.0 / k * (1.0 - std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t)));
  return std::abs(filter.x()[0] - exact);
}

TEST(AdmittanceFilter, TendsToTheContinuousMotion) {
  EXPECT_LT(step_error(1e-4), 1e-3 * 6.0 / 200.0);
  EXPECT_NEAR(step_error(1e-3) / step_error(1e-4), 10.0, 0.5) << "first order";
}

TEST(AdmittanceFilter, IsPassiveForEverySampleTime) {
  std::mt19937 generator(2);
  const MatrixJ K = limber::testing::random_stiffness(4000.0, 100.0, generator);
  const MatrixJ M = limber::testing::random_stiffness(3.0, 0.1, generator);
  for (const double T : {1e-3, 0.1, 10.0}) {
    AdmittanceFilter filter(M, MatrixJ::Zero(6, 6), K, T);
    double before = 0.0;
    for (int i = 0; i < 100; ++i) {
      const VectorJ F = limber::testing::random_vector(6, 50.0, generator);
      filter.update(F);
      const double energy =
          0.5 * filter.v().dot(M * filter.v()) + 0.5 * filter.x().dot(K * filter.x());
      EXPECT_LE(energy, before + T * F.dot(filter.v()) + 1e-9 * (1.0 + energy));
      before = energy;
    }
    for (int i = 0; i < 5; ++i) filter.update(VectorJ::Constant(6, NAN));
    EXPECT_TRUE(filter.x().allFinite());
  }
}

TEST(AdmittanceFilter, RefusesWhatHasNoStep) {
  EXPECT_THROW(AdmittanceFilter(one(0.0), one(0.0), one(0.0), 1e-3), ConfigError);
  EXPECT_THROW(AdmittanceFilter(one(1.0), one(0.0), one(0.0), 0.0), ConfigError);
  AdmittanceFilter filter(one(1.0), one(0.0), one(0.0), 1e-3);
  EXPECT_FALSE(filter.set(one(-1.0), one(0.0), one(0.0)));
  EXPECT_FALSE(filter.set(one(1.0), one(NAN), one(0.0)));
  filter.update(vec(1.0));
  EXPECT_NEAR(filter.v()[0], 1e-3, 1e-15) << "a mass of 1 kg still";
  EXPECT_TRUE(filter.set(one(2.0), one(0.0), one(0.0)));
  filter.reset();
  filter.update(vec(1.0));
  EXPECT_NEAR(filter.v()[0], 0.5e-3, 1e-15);
}

TEST(Compose, DeviationIsThePoseErrorAndTheTwistItsRate) {
  std::mt19937 generator(3);
  const Pose X_BD{{0.3, -0.1, 0.5}, exp_rotation({0.4, 1.0, -0.7})};
  const Vector6 V_BD = limber::testing::random_six(1.0, generator);
  const Vector6 x = limber::testing::random_six(0.8, generator);
  const Vector6 v = limber::testing::random_six(1.0, generator);
  EXPECT_LT((pose_error(compose(X_BD, V_BD, x, v).X_BC, X_BD, Orientation::kLog).e - x).norm(),
            1e-14);
  const auto at = [&](double t) {
    const Pose target{X_BD.p + t * V_BD.head<3>(), exp_rotation(t * V_BD.tail<3>()) * X_BD.Q};
    return compose(target, V_BD, x + t * v, v).X_BC;
  };
  constexpr double h = 1e-6;
  Vector6 rate;
  rate << at(h).p - at(-h).p, log_rotation(at(h).Q * at(-h).Q.conjugate());
  EXPECT_LT((compose(X_BD, V_BD, x, v).V_BC - rate / (2.0 * h)).norm(), 1e-8);
}

TEST(AdmittanceFilter, DoesNotAllocate) {
  const MatrixJ I = MatrixJ::Identity(16, 16);
  AdmittanceFilter filter(I, I, I, 1e-3);
  const auto before = limber::allocations();
  filter.set(2.0 * I, I, I);
  filter.update(VectorJ::Ones(16));
  EXPECT_EQ(limber::allocations(), before);
}

}  // namespace
}  // namespace limber::controller::test_admittance
