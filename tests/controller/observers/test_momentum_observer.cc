// The momentum residual is a first-order filter of the external torque, on numbers and on an arm.
#include <gtest/gtest.h>

#include <cmath>

#include "common/config_error.h"
#include "controller/observers/momentum_observer.h"
#include "tests/controller/arms.h"
#include "tools/allocations/allocations.h"

namespace limber::controller::test_momentum_observer {
namespace {

constexpr double kT = 1e-3;

VectorJ both(double a, double b) { return (VectorJ(2) << a, b).finished(); }

TEST(MomentumObserver, StepOfExternalTorqueArrivesThroughOnePole) {
  const VectorJ K_O = both(40.0, 10.0);
  MomentumObserver observer(K_O, kT);
  const VectorJ tau_ext = both(3.0, -2.0);
  const VectorJ tau = both(5.0, 1.0);
  const VectorJ beta = both(-4.0, 2.0);
  VectorJ p = both(0.7, -0.1);
  for (int k = 0; k < 300; ++k) {
    const VectorJ r = observer.update(p, tau, beta);
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(r[i], tau_ext[i] * (1.0 - std::pow(1.0 - K_O[i] * kT, k)), 1e-11) << k;
    }
    p += kT * (tau + beta + tau_ext);
  }
}

TEST(MomentumObserver, TorqueCountsFromTheSampleItIsGivenWith) {
  MomentumObserver observer(VectorJ::Constant(1, 100.0), kT);
  const VectorJ zero = VectorJ::Zero(1);
  const VectorJ tau = VectorJ::Constant(1, 2.0);
  observer.update(zero, zero, zero);
  EXPECT_EQ(observer.update(zero, tau, zero)[0], 0.0);
  EXPECT_NEAR(observer.update(zero, zero, zero)[0], -100.0 * kT * 2.0, 1e-15);
}

TEST(CoriolisTranspose, IsTheGradientOfTheKineticEnergy) {
  std::mt19937 generator(5);
  for (const int n : {1, 3, 7, 16}) {
    ArmModel model(limber::testing::random_arm(n, 11, true));
    ArmTerms terms(n);
    const VectorJ q = limber::testing::random_vector(n, 1.0, generator);
    const VectorJ v = limber::testing::random_vector(n, 2.0, generator);
    model.evaluate(q, v, &terms);
    const VectorJ CTv = terms.CTv;
    constexpr double h = 1e-5;
    for (int i = 0; i < n; ++i) {
      const MatrixJ ahead = model.mass(q + h * VectorJ::Unit(n, i));
      const MatrixJ behind = model.mass(q - h * VectorJ::Unit(n, i));
      const double gradient = 0.5 * v.dot((ahead - behind) * v) / (2.0 * h);
      EXPECT_NEAR(CTv[i], gradient, 1e-8 * (1.0 + terms.Cv.norm())) << n << " joints";
    }
    // The scalar v^T C v is its own transpose.
    EXPECT_NEAR(v.dot(CTv), v.dot(terms.Cv), 1e-12 * (1.0 + terms.Cv.norm() * v.norm()));
  }
}

// A wrench on a falling seven-joint arm, observed with a sample time so short that sampling errors
// do not count: r is the wrench's torque, filtered with K_O.
TEST(MomentumObserver, SeesAWrenchOnAMovingArm) {
  constexpr double T = 2e-4;
  constexpr double K_O = 50.0;
  limber::testing::Plant arm(limber::testing::seven_joint_arm());
  arm.q.setConstant(0.4);
  arm.F_ext << 5.0, -3.0, 8.0, 0.2, -0.4, 0.3;
  MomentumObserver observer(VectorJ::Constant(7, K_O), T);
  ArmTerms terms(7);
  VectorJ expected = VectorJ::Zero(7);
  VectorJ r;
  const auto torque = [&](const VectorJ& q, const VectorJ&) -> VectorJ {
    return 0.5 * arm.model.gravity(q);
  };
  for (int k = 0; k < 1000; ++k) {
    arm.model.evaluate(arm.q, arm.v, &terms);
    const VectorJ beta = terms.CTv - terms.g;
    r = observer.update(terms.M_total * arm.v, torque(arm.q, arm.v), beta);
    const VectorJ tau_ext = terms.J.transpose() * arm.F_ext;
    expected += (1.0 - std::exp(-K_O * T)) * (tau_ext - expected);
    arm.advance(T, torque);
  }
  EXPECT_GT(arm.v.norm(), 2.0) << "the arm moves";
  EXPECT_GT(expected.norm(), 1.0);
  EXPECT_LT((r - expected).norm(), 0.01 * expected.norm());
}

TEST(MomentumObserver, RefusesUnstableGainsAndLeavesOutWhatIsNotFinite) {
  EXPECT_THROW(MomentumObserver(both(10.0, 2000.0), kT), ConfigError);
  EXPECT_THROW(MomentumObserver(both(10.0, -1.0), kT), ConfigError);
  EXPECT_NO_THROW(MomentumObserver(both(10.0, 1999.0), kT));
  MomentumObserver observer(both(10.0, 10.0), kT);
  const VectorJ zero = both(0.0, 0.0);
  observer.update(zero, zero, zero);
  const VectorJ r = observer.update(both(0.1, 0.2), zero, zero);
  EXPECT_EQ(observer.update(zero, both(std::nan(""), 0.0), zero), r);
  EXPECT_EQ(observer.residual(), both(1.0, 2.0));
}

TEST(MomentumObserver, DoesNotAllocate) {
  ArmModel model(limber::testing::random_arm(16, 3, false));
  ArmTerms terms(16);
  const VectorJ x = VectorJ::Ones(16);
  model.evaluate(x, x, &terms);
  MomentumObserver observer(x, kT);
  const auto before = limber::allocations();
  for (int k = 0; k < 3; ++k) {
    observer.update(terms.M * x, x, terms.CTv - terms.g);
  }
  EXPECT_EQ(limber::allocations(), before);
}

}  // namespace
}  // namespace limber::controller::test_momentum_observer
