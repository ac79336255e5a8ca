// A held spring makes exactly the energy its formula says, and the damping takes it back.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "controller/observers/passivity_observer.h"

namespace limber::controller::test_passivity_observer {
namespace {

constexpr double kT = 1e-3;
VectorJ one(double x) { return VectorJ::Constant(1, x); }

TEST(PassivityObserver, HeldSpringMakesEnergyEveryCycle) {
  constexpr double K = 500.0;
  constexpr double a = 0.02;
  const double w = 2.0 * std::numbers::pi;  // 1 Hz: a whole cycle is 1000 samples
  PassivityObserver<VectorJ> observer(1, 100.0);
  for (int k = 0; k <= 1000; ++k) {
    const double x = a * std::sin(w * k * kT);
    observer.observe(one(x));
    observer.hold(one(-K * x));
  }
  const double made = std::numbers::pi / 2.0 * K * kT * a * a * w;
  EXPECT_NEAR(observer.energy_J(), -made, 1e-4 * made);
}

TEST(PassivityObserver, DampingTakesTheEnergyBackInOneSample) {
  PassivityObserver<VectorJ> observer(1, 1e3);
  observer.observe(one(0.0));
  observer.hold(one(10.0));
  observer.observe(one(0.001));  // pushed 10 N along 1 mm
  EXPECT_NEAR(observer.energy_J(), -0.01, 1e-15);
  const double v = 0.5;
  const double D = observer.damping(one(v), kT);
  EXPECT_NEAR(D, 0.01 / (kT * v * v), 1e-9);
  observer.hold(one(-D * v));
  observer.observe(one(0.001 + kT * v));
  EXPECT_NEAR(observer.energy_J(), 0.0, 1e-12);
  EXPECT_EQ(observer.damping(one(v), kT), 0.0);
}

TEST(PassivityObserver, DampingIsLimitedAndZeroWhilePassive) {
  PassivityObserver<Vector6> observer(6, 30.0);
  EXPECT_EQ(observer.damping(Vector6::Ones(), kT), 0.0);
  observer.observe(Vector6::Zero());
  observer.hold(Vector6::Ones());
  observer.observe(Vector6::Constant(0.1));
  EXPECT_NEAR(observer.energy_J(), -0.6, 1e-15);
  EXPECT_EQ(observer.damping(Vector6::Zero(), kT), 30.0);
  EXPECT_EQ(observer.damping(Vector6::Constant(NAN), kT), 30.0);
  observer.observe(Vector6::Constant(NAN));
  observer.hold(Vector6::Constant(NAN));
  observer.observe(Vector6::Constant(0.0));
  EXPECT_NEAR(observer.energy_J(), 0.0, 1e-15) << "the force before goes on";
  observer.reset();
  observer.observe(Vector6::Constant(7.0));
  EXPECT_EQ(observer.energy_J(), 0.0);
}

// A stretched spring may give back what it holds.
TEST(PassivityObserver, StoredEnergyMayBeGivenAway) {
  PassivityObserver<VectorJ> observer(1, 1e3);
  observer.reset(0.5);
  EXPECT_FALSE(observer.started());
  observer.observe(one(0.0));
  observer.hold(one(10.0));
  observer.observe(one(0.05));
  EXPECT_NEAR(observer.energy_J(), 0.0, 1e-15);
  EXPECT_EQ(observer.damping(one(1.0), kT), 0.0);
  observer.observe(one(0.06));
  EXPECT_GT(observer.damping(one(1.0), kT), 0.0);
  observer.set_max_damping(3.0);
  EXPECT_EQ(observer.damping(one(1.0), kT), 3.0);
}

}  // namespace
}  // namespace limber::controller::test_passivity_observer
