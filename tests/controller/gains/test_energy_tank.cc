// Stiffness grows by what the tank can pay, and not by more.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "common/config_error.h"
#include "controller/gains/energy_tank.h"
#include "tests/controller/arms.h"
#include "tools/allocations/allocations.h"

namespace limber::controller::test_energy_tank {
namespace {

MatrixJ one(double x) { return MatrixJ::Constant(1, 1, x); }
VectorJ vec(double x) { return VectorJ::Constant(1, x); }

// Raising 100 N/m to 300 N/m at 0.1 m costs 1 J.
TEST(EnergyTank, PaysInFullThenInPart) {
  EnergyTank tank({.E_0 = 1.6, .E_min = 0.1, .E_max = 5.0, .share = 0.5}, one(100.0));
  const MatrixJ D = one(40.0);
  EXPECT_NEAR(tank.update(one(300.0), D, vec(0.1), vec(0.0), 1e-3)(0, 0), 300.0, 1e-12);
  EXPECT_NEAR(tank.energy_J(), 0.6, 1e-12);
  // 0.5 J are left above the floor, 1 J is asked: half of it.
  EXPECT_NEAR(tank.update(one(500.0), D, vec(0.1), vec(0.0), 1e-3)(0, 0), 400.0, 1e-12);
  EXPECT_NEAR(tank.energy_J(), 0.1, 1e-12);
  EXPECT_NEAR(tank.update(one(500.0), D, vec(0.1), vec(0.0), 1e-3)(0, 0), 400.0, 1e-12);
  // The damper takes 40 * 2^2 * 1e-3 = 0.16 J, half of it is stored and spent on 16 N/m.
  EXPECT_NEAR(tank.update(one(500.0), D, vec(0.1), vec(2.0), 1e-3)(0, 0), 416.0, 1e-9);
  EXPECT_NEAR(tank.energy_J(), 0.1, 1e-12);
}

TEST(EnergyTank, SofterIsFreeAndStoresNothing) {
  EnergyTank tank({.E_0 = 1.0, .E_min = 0.0, .E_max = 1.0, .share = 1.0}, one(300.0));
  EXPECT_EQ(tank.update(one(100.0), one(0.0), vec(0.2), vec(3.0), 1e-3)(0, 0), 100.0);
  EXPECT_EQ(tank.energy_J(), 1.0);
  tank.update(one(100.0), one(1e6), vec(0.0), vec(3.0), 1e-3);
  EXPECT_EQ(tank.energy_J(), 1.0) << "full is full";
}

// Random demands on a mass with spring and damper in the plane, energies by exact integration of
// the held stiffness' work: arm plus spring never has more than at the start plus the tank.
TEST(EnergyTank, BoundsTheEnergyOfArmAndSpring) {
  std::mt19937 generator(8);
  const double T = 1e-4;
  const MatrixJ D = MatrixJ::Identity(2, 2) * 0.3;
  MatrixJ K_0 = MatrixJ::Identity(2, 2) * 100.0;
  EnergyTank tank({.E_0 = 0.2, .E_min = 0.0, .E_max = 0.5, .share = 1.0}, K_0);
  MatrixJ K_req = K_0;
  VectorJ e = VectorJ::Constant(2, 0.1);
  VectorJ V = VectorJ::Zero(2);
  const double start = 0.5 * e.dot(K_0 * e);
  double unlimited = 0.0;
  for (int k = 0; k < 60000; ++k) {
    if (k % 200 == 0) {
      const MatrixJ A = MatrixJ::Identity(2, 2) +
                        0.5 * limber::testing::random_vector(2, 1.0, generator) *
                            limber::testing::random_vector(2, 1.0, generator).transpose();
      K_req = 150.0 * A * A.transpose();
    }
    const MatrixJ before = tank.stiffness();
    const MatrixJ K = tank.update(K_req, D, e, V, T);
    unlimited += std::max(0.5 * e.dot((K_req - before) * e), 0.0);
    V += T * (-K * e - D * V);
    e += T * V;
    ASSERT_LE(0.5 * V.squaredNorm() + 0.5 * e.dot(K * e), start + 0.2 + 0.01) << k;
    ASSERT_GE(tank.energy_J(), -1e-15);
    ASSERT_LE(tank.energy_J(), 0.5);
  }
  EXPECT_GT(unlimited, 1.0) << "without a tank the demands would have put this in";
}

TEST(EnergyTank, RefusesNonsense) {
  EXPECT_THROW(EnergyTank({.E_0 = 2.0, .E_min = 0.0, .E_max = 1.0, .share = 0.5}, one(1.0)),
               ConfigError);
  EXPECT_THROW(EnergyTank({.E_0 = 0.5, .E_min = 0.0, .E_max = 1.0, .share = 1.5}, one(1.0)),
               ConfigError);
  EXPECT_THROW(EnergyTank({.E_0 = NAN, .E_min = 0.0, .E_max = 1.0, .share = 0.5}, one(1.0)),
               ConfigError);
  EnergyTank tank({.E_0 = 0.5, .E_min = 0.0, .E_max = 1.0, .share = 0.5}, one(1.0));
  EXPECT_EQ(tank.update(one(NAN), one(1.0), vec(0.1), vec(0.1), 1e-3)(0, 0), 1.0);
  EXPECT_EQ(tank.update(one(0.5), one(1.0), vec(0.1), vec(NAN), 1e-3)(0, 0), 1.0);
  EXPECT_EQ(tank.energy_J(), 0.5);
}

TEST(EnergyTank, DoesNotAllocate) {
  const MatrixJ K = MatrixJ::Identity(16, 16);
  const VectorJ x = VectorJ::Ones(16);
  EnergyTank tank({.E_0 = 0.5, .E_min = 0.0, .E_max = 1.0, .share = 0.5}, K);
  const auto before = limber::allocations();
  tank.update(2.0 * K, K, x, x, 1e-3);
  EXPECT_EQ(limber::allocations(), before);
}

}  // namespace
}  // namespace limber::controller::test_energy_tank
