// The friction estimate is the friction behind one pole, whether the motor moves or sticks.
#include <gtest/gtest.h>

#include <cmath>

#include "common/config_error.h"
#include "controller/observers/friction_observer.h"
#include "tools/allocations/allocations.h"

namespace limber::controller::test_friction_observer {
namespace {

constexpr double kT = 1e-3;
constexpr double kB = 0.2;
constexpr double kL = 60.0;

VectorJ one(double x) { return VectorJ::Constant(1, x); }
FrictionObserver observer() { return FrictionObserver(one(kB), one(kL), kT); }

TEST(FrictionObserver, RisesAsOnePoleWhileTheMotorSticks) {
  FrictionObserver friction = observer();
  for (int k = 0; k < 200; ++k) {
    // 5 N m from the motor, 3 N m arrive at the link: the rest is stiction.
    EXPECT_NEAR(friction.update(one(0.0), one(5.0), one(3.0))[0],
                2.0 * (1.0 - std::pow(1.0 - kL * kT, k)), 1e-12);
  }
}

TEST(FrictionObserver, DoesNotTakeAccelerationForFriction) {
  FrictionObserver friction = observer();
  double theta_dot = 0.3;
  for (int k = 0; k < 200; ++k) {
    const double tau_m = 4.0 * std::sin(0.1 * k);
    const double estimate = friction.update(one(theta_dot), one(tau_m), one(-1.0))[0];
    EXPECT_NEAR(estimate, 1.5 * (1.0 - std::pow(1.0 - kL * kT, k)), 1e-12);
    theta_dot += kT / kB * (tau_m + 1.0 - 1.5);
  }
}

TEST(FrictionObserver, LeavesOutWhatIsNotFiniteAndStartsAgain) {
  FrictionObserver friction = observer();
  friction.update(one(0.0), one(1.0), one(0.0));
  const double before = friction.update(one(0.0), one(1.0), one(0.0))[0];
  EXPECT_EQ(friction.update(one(std::nan("")), one(1.0), one(0.0))[0], before);
  EXPECT_NEAR(before, kL * kT, 1e-15);
  friction.reset();
  EXPECT_EQ(friction.update(one(9.0), one(1.0), one(0.0))[0], 0.0);
}

TEST(FrictionObserver, RefusesUnstableGains) {
  EXPECT_THROW(FrictionObserver(one(kB), one(2000.0), kT), ConfigError);
  EXPECT_THROW(FrictionObserver(one(0.0), one(kL), kT), ConfigError);
  EXPECT_THROW(FrictionObserver(one(kB), one(kL), 0.0), ConfigError);
}

TEST(FrictionObserver, DoesNotAllocate) {
  const VectorJ x = VectorJ::Ones(16);
  FrictionObserver friction(x, x, kT);
  const auto before = limber::allocations();
  for (int k = 0; k < 3; ++k) friction.update(k * x, x, x);
  EXPECT_EQ(limber::allocations(), before);
}

}  // namespace
}  // namespace limber::controller::test_friction_observer
