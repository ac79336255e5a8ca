// LuGre friction on a single mass: what stiction, sliding and passivity must look like.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "sim/joints/friction.h"

namespace limber::sim::test_friction {
namespace {

constexpr double kStep = 250e-6;

FrictionConfig config(double coulomb, double breakaway, double viscous, double bristle) {
  FrictionConfig out;
  out.coulomb_Nm = coulomb;
  out.static_Nm = breakaway;
  out.stribeck_rad_per_s = 0.05;
  out.viscous_Nms_per_rad = viscous;
  out.bristle_rad = bristle;
  return out;
}

/// A mass that slides under a force and friction, with the implicit step the simulator takes.
struct Mass {
  LugreFriction friction;
  double inertia;
  double x = 0.0;
  double v = 0.0;

  double step(double force) {
    double guess = v;
    double end = v;
    friction.begin_step(v, kStep);
    for (int i = 0; i < 3; ++i) {
      guess = end;
      const AffineForce f = friction.step_force(guess);
      end = (inertia * v + kStep * (force - f.offset)) / (inertia + kStep * f.slope);
    }
    const double resistance = friction.finish_step(guess, end);
    v += kStep / inertia * (force - resistance);
    x += kStep * v;
    return resistance;
  }
};

TEST(Lugre, SticksBelowBreakawayWithPresliding) {
  // A constant force F < G rests at z = F / sigma0. On the way there dz/dx = 1 - z sigma0 / G, so x
  // = -G/sigma0 ln(1 - F/G).
  for (const double share : {0.01, 0.3, 0.8}) {
    Mass mass{LugreFriction(config(0.5, 0.5, 0.05, 1e-4), 0.01), 0.01};
    const double ramp_steps = 4000;  // slow, so that nothing overshoots
    for (int k = 0; k < 40000; ++k) mass.step(0.5 * share * std::min(1.0, k / ramp_steps));
    EXPECT_NEAR(mass.x, -1e-4 * std::log(1.0 - share), 0.02 * 1e-4) << share;
    EXPECT_LT(std::abs(mass.v), 1e-9);
    const double rested = mass.x;
    for (int k = 0; k < 40000; ++k) mass.step(0.5 * share);
    EXPECT_LT(std::abs(mass.x - rested), 1e-9);
  }
}

TEST(Lugre, BreaksAwayAtStaticFriction) {
  Mass mass{LugreFriction(config(0.4, 0.6, 0.0, 1e-4), 0.01), 0.01};
  double force = 0.0;
  while (std::abs(mass.v) < 0.02 && force < 2.0) {
    force += 0.1 * kStep;  // 0.1 N m a second
    mass.step(force);
  }
  EXPECT_NEAR(force, 0.6, 0.012);
}

TEST(Lugre, SlidesWithCoulombStribeckAndViscousForce) {
  for (const double v : {-3.0, -0.04, 0.02, 0.05, 0.5, 10.0}) {
    LugreFriction friction(config(0.4, 0.6, 0.07, 1e-4), 0.01);
    double force = 0.0;
    for (int k = 0; k < 40000; ++k) {
      friction.begin_step(v, kStep);
      force = friction.finish_step(v, v);
    }
    const double stribeck = 0.4 + 0.2 * std::exp(-(v / 0.05) * (v / 0.05));
    EXPECT_NEAR(force, std::copysign(stribeck, v) + 0.07 * v, 1e-9) << v;
  }
}

TEST(Lugre, WithoutCoulombIsViscous) {
  LugreFriction friction(config(0.0, 0.0, 0.3, 1e-4), 0.01);
  friction.begin_step(0.0, kStep);
  EXPECT_DOUBLE_EQ(friction.finish_step(0.0, 2.0), 0.6);
  EXPECT_EQ(friction.bristle(), 0.0);
}

/// Parameters over many powers of ten, far beyond what a joint has.
struct Extreme {
  explicit Extreme(unsigned seed) : random(seed) {}
  double between(double low_power, double high_power) {
    return std::pow(10.0, std::uniform_real_distribution<double>(low_power, high_power)(random));
  }
  FrictionConfig config() {
    const double coulomb = between(-3, 2);
    FrictionConfig out;
    out.coulomb_Nm = coulomb;
    out.static_Nm = coulomb * (1.0 + between(-3, 1));
    out.stribeck_rad_per_s = between(-3, 1);
    out.viscous_Nms_per_rad = between(-4, 3);
    out.bristle_rad = between(-9, -1);
    return out;
  }
  std::mt19937 random;
};

TEST(Lugre, EveryStepIsPassiveForAnyParametersAndMotion) {
  Extreme extreme(1);
  std::uniform_real_distribution<double> sign(-1.0, 1.0);
  for (int trial = 0; trial < 2000; ++trial) {
    LugreFriction friction(extreme.config(), extreme.between(-6, 1));
    double v = 0.0;
    for (int k = 0; k < 50; ++k) {
      const double v_end = sign(extreme.random) * extreme.between(-5, 2);
      const double before = friction.bristle_energy();
      const double guess = sign(extreme.random) * extreme.between(-5, 2);
      friction.begin_step(v, kStep);
      const double force = friction.finish_step(guess, v_end);
      const double stored = friction.bristle_energy() - before;
      EXPECT_GE(force * v_end * kStep - stored, -1e-9 * (std::abs(stored) + before));
      v = v_end;
    }
  }
}

TEST(Lugre, NeverAcceleratesAMassForAnyParameters) {
  Extreme extreme(2);
  std::uniform_real_distribution<double> sign(-1.0, 1.0);
  for (int trial = 0; trial < 2000; ++trial) {
    const double rotor = extreme.between(-6, 0);
    Mass mass{LugreFriction(extreme.config(), rotor), rotor + extreme.between(-6, 1)};
    mass.v = sign(extreme.random) * extreme.between(-3, 2);
    const double start = 0.5 * mass.inertia * mass.v * mass.v;
    for (int k = 0; k < 2000; ++k) {
      mass.step(0.0);
      const double energy = 0.5 * mass.inertia * mass.v * mass.v + mass.friction.bristle_energy();
      ASSERT_LE(energy, start * (1.0 + 1e-9)) << trial << " " << k;
    }
  }
}

}  // namespace
}  // namespace limber::sim::test_friction
