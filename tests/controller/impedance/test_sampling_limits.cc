// Each rule against the roots of the exactly sampled loop it is about: stable just below, unstable
// just above.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <utility>

#include "controller/impedance/sampling_limits.h"

namespace limber::controller::test_sampling_limits {
namespace {

constexpr double kT = 1e-3;

bool inside_unit_circle(const Eigen::MatrixXd& A) {
  return A.eigenvalues().cwiseAbs().maxCoeff() < 1.0;
}

/// The mass with friction over one held sample: x' = x + f v + (T - f) F / b, v' = p v + f F / m.
struct Mass {
  Mass(double m, double b, double T = kT) {
    p = std::exp(-b / m * T);
    f = b > 0.0 ? -std::expm1(-b / m * T) * m / b : T;
    x_F = b > 0.0 ? (T - f) / b : 0.5 * T * T / m;
    v_F = f / m;
  }
  double p;
  double f;
  double x_F;
  double v_F;
};

/// State [x, v, forces on their way, x before]; F = -K x - D v - B (x - x before) / T.
bool stable(const Mass& mass, double K, double D, double B, int delay, double T = kT) {
  const int n = 3 + delay;
  const int last = n - 1;
  Eigen::RowVectorXd force = Eigen::RowVectorXd::Zero(n);
  force[0] = -K - B / T;
  force[1] = -D;
  force[last] = B / T;
  Eigen::RowVectorXd acts = force;
  if (delay > 0) acts = Eigen::RowVectorXd::Unit(n, 2);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  A(0, 0) = 1.0;
  A(0, 1) = mass.f;
  A(1, 1) = mass.p;
  A.row(0) += mass.x_F * acts;
  A.row(1) += mass.v_F * acts;
  for (int i = 0; i < delay; ++i) {
    A.row(2 + i) = i + 1 < delay ? Eigen::RowVectorXd(Eigen::RowVectorXd::Unit(n, 3 + i)) : force;
  }
  A(last, 0) = 1.0;
  // A rule without a damper by difference has no memory of x.
  return inside_unit_circle(B == 0.0 ? Eigen::MatrixXd(A.topLeftCorner(last, last)) : A);
}

TEST(SamplingLimits, SpringAndDamperWithDelay) {
  for (const int delay : {0, 1, 3}) {
    const double limit = stiffness_limit(3.0 + 10.0, kT, delay * kT);
    EXPECT_TRUE(stable(Mass(20.0, 3.0), 0.97 * limit, 10.0, 0.0, delay)) << delay;
    EXPECT_FALSE(stable(Mass(20.0, 3.0), 1.03 * limit, 10.0, 0.0, delay)) << delay;
  }
  EXPECT_EQ(stiffness_limit(-1.0, kT, 0.0), 0.0);
}

// With negative damping the heaviest mass is the worst partner, with positive the lightest:
// b (x' - x) / T = F.
TEST(SamplingLimits, PassivityIsReachedByTheWorstPartner) {
  constexpr double b = 5.0;
  const double heavy = passive_stiffness_limit(b, -2.0, kT);
  EXPECT_TRUE(stable(Mass(500.0, b), 0.99 * heavy, 0.0, -2.0, 0));
  EXPECT_FALSE(stable(Mass(500.0, b), 1.01 * heavy, 0.0, -2.0, 0));
  const auto light = [](double K, double B) {
    Eigen::Matrix2d A;
    A << 1.0 - K * kT / b - B / b, B / b, 1.0, 0.0;
    return inside_unit_circle(A);
  };
  const double limit = passive_stiffness_limit(b, 2.0, kT);
  EXPECT_DOUBLE_EQ(limit, heavy);
  EXPECT_TRUE(light(0.999 * limit, 2.0));
  EXPECT_FALSE(light(1.001 * limit, 2.0));
  for (const double m : {0.001, 0.1, 10.0}) {
    EXPECT_TRUE(stable(Mass(m, b), 0.99 * limit, 0.0, 2.0, 0)) << m << " kg is no worse";
  }
  EXPECT_EQ(passive_stiffness_limit(b, 6.0, kT), 0.0);
}

TEST(SamplingLimits, FreeMass) {
  for (const double m : {0.003, 0.02, 1.0}) {
    const double limit = free_mass_stiffness_limit(m, 5.0, kT);
    EXPECT_TRUE(stable(Mass(m, 5.0), 0.9999 * limit, 0.0, 0.0, 0)) << m;
    EXPECT_FALSE(stable(Mass(m, 5.0), 1.0001 * limit, 0.0, 0.0, 0)) << m;
    EXPECT_GE(limit, passive_stiffness_limit(5.0, 0.0, kT));
  }
  EXPECT_NEAR(free_mass_stiffness_limit(1000.0, 5.0, kT), 2.0 * 5.0 / kT, 1e-2);
}

// Without a spring the position floats: what has to decay is the speed. T v = x - x before over a
// held force gives v' = v - c (v + v before), c = B T / (2 m), one sample later with delay.
TEST(SamplingLimits, DamperByDifference) {
  constexpr double m = 0.7;
  const auto prompt = [](double B) {
    const double c = 0.5 * B * kT / m;
    Eigen::Matrix2d A;
    A << 1.0 - c, -c, 1.0, 0.0;
    return inside_unit_circle(A);
  };
  const auto late = [](double B) {
    const double c = 0.5 * B * kT / m;
    Eigen::Matrix3d A;
    A << 1.0, -c, -c, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0;
    return inside_unit_circle(A);
  };
  EXPECT_TRUE(prompt(0.999 * damping_limit(m, kT)));
  EXPECT_FALSE(prompt(1.001 * damping_limit(m, kT)));
  EXPECT_TRUE(late(0.999 * delayed_damping_limit(m, kT)));
  EXPECT_FALSE(late(1.001 * delayed_damping_limit(m, kT)));
}

// A fine sample time makes a pure delay of many samples and a half.
TEST(SamplingLimits, DesignedDamperWithDelay) {
  constexpr double m = 2.0;
  constexpr double t_d = 5e-3;
  constexpr int kSamples = 40;
  constexpr double fine = t_d / (kSamples + 0.5);
  for (const double zeta : {0.2, 0.7, 1.0}) {
    const auto loop = [&](double K) {
      return stable(Mass(m, 0.0, fine), K, 2.0 * zeta * std::sqrt(K * m), 0.0, kSamples, fine);
    };
    const double limit = delay_stiffness_limit(m, zeta, t_d);
    EXPECT_TRUE(loop(0.99 * limit)) << zeta;
    EXPECT_FALSE(loop(1.01 * limit)) << zeta;
  }
  EXPECT_NEAR(delay_stiffness_limit(1.0, 1.0, 1.0), 0.419, 5e-4);
  EXPECT_EQ(delay_stiffness_limit(1.0, 0.0, 1.0), 0.0);
}

// The same rule for the loop as it is: one cycle late and half a sample.
TEST(SamplingLimits, DesignedDamperInTheChain) {
  for (const double zeta : {0.3, 0.7, 1.0}) {
    const auto loop = [&](double K) {
      return stable(Mass(1.0, 0.0), K, 2.0 * zeta * std::sqrt(K), 0.0, 1);
    };
    const double limit = delay_stiffness_limit(1.0, zeta, 1.5 * kT);
    EXPECT_TRUE(loop(0.9 * limit)) << zeta;
    EXPECT_FALSE(loop(1.1 * limit)) << zeta;
  }
}

// Times the mass crosses the encoder's edge within two seconds, started beside it.
int crossings(double K, double b, double F_c, double delta) {
  constexpr int kSteps = 20;
  constexpr double m = 0.1;
  constexpr double h = kT / kSteps;
  double x = 1e-7;
  double v = 0.0;
  int count = 0;
  for (int k = 0; k < 2000; ++k) {
    const double before = x;
    const double F = -K * delta * (std::floor(x / delta) + 0.5);
    for (int i = 0; i < kSteps; ++i) {
      const double free = v + h / m * (F - b * v);
      const double friction = h / m * F_c;
      v = std::abs(free) > friction ? free - std::copysign(friction, free) : 0.0;
      x += h * v;
    }
    if (x * before < 0.0) ++count;
  }
  return count;
}

TEST(SamplingLimits, QuantisedWall) {
  const double limit = quantised_wall_stiffness_limit(5.0, 0.05, 1e-4, kT);
  EXPECT_DOUBLE_EQ(limit, 1000.0) << "2 F_c / delta";
  EXPECT_EQ(crossings(0.95 * limit, 5.0, 0.05, 1e-4), 0);
  EXPECT_GT(crossings(1.05 * limit, 5.0, 0.05, 1e-4), 5);
  EXPECT_DOUBLE_EQ(quantised_wall_stiffness_limit(0.1, 0.05, 1e-4, kT), 200.0) << "2 b / T";
}

// m t s^3 + (m + b t) s^2 + (b + D) s + K
TEST(SamplingLimits, TorqueLag) {
  constexpr double m = 0.5;
  constexpr double b = 1.5;
  constexpr double D = 4.0;
  constexpr double t = 5e-3;
  const auto settles = [&](double K) {
    Eigen::Matrix3d A;
    A << 0, 1, 0, 0, 0, 1, -K / (m * t), -(b + D) / (m * t), -(m + b * t) / (m * t);
    return A.eigenvalues().real().maxCoeff() < 0.0;
  };
  const double limit = torque_lag_stiffness_limit(m, b, D, t);
  EXPECT_TRUE(settles(0.999 * limit));
  EXPECT_FALSE(settles(1.001 * limit));
}

}  // namespace
}  // namespace limber::controller::test_sampling_limits
