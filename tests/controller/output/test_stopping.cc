// A joint stays slow enough to be stopped, whatever is demanded.
#include <gtest/gtest.h>

#include <cmath>
#include <limber/controller_status_t.hpp>
#include <random>

#include "controller/output/joint_limits.h"
#include "controller/output/stopping.h"
#include "tests/controller/arms.h"

namespace limber::controller::test_stopping {
namespace {

using Status = controller_status_t;
using limber::testing::Plant;

constexpr double kT = 1e-3;

LoadedRobot desktop() {
  LoadedRobot robot = limber::testing::planar_arm(limber::testing::kDesktop);
  for (JointConfig& joint : robot.robot.joints) {
    joint.position_min = -2.6;
    joint.position_max = 2.6;
    joint.velocity_limit = 20.0;
    joint.torque_limit_Nm = 7.0;
    joint.torque_rate_limit_Nm_per_s = 350.0;
  }
  return robot;
}

/// One joint of M = 0.5 kg m^2 without weight: -1..2 rad, 10 rad/s, 20 N m.
class OneJoint : public ::testing::Test {
 protected:
  OneJoint() : state(1), terms(1) {
    robot.joints.resize(1);
    JointConfig& joint = robot.joints[0];
    joint.position_min = -1.0;
    joint.position_max = 2.0;
    joint.velocity_limit = 10.0;
    joint.torque_limit_Nm = 20.0;
    joint.torque_rate_limit_Nm_per_s = 20'000.0;
    terms.M_total << 0.5;
    state.period_s = kT;
  }
  /// The torque left of `demand` at position q and speed v; the bits that acted are in acted.
  double shaped(double q, double v, double demand) {
    state.q << q;
    state.v_reported << v;
    state.theta_dot_reported << v;
    const VectorJ most = VectorJ::Constant(1, 20.0);
    VectorJ tau = VectorJ::Constant(1, demand);
    acted = Stopping(robot, most).shape(state, terms, {-most, most}, &tau);
    return tau[0];
  }

  Robot robot;
  ArmState state;
  ArmTerms terms;
  std::int32_t acted = 0;
};

TEST_F(OneJoint, FarFromItsLimitsItIsLeftAlone) {
  EXPECT_EQ(shaped(0.0, 0.5, 3.0), 3.0);
  EXPECT_EQ(shaped(0.0, -0.5, -3.0), -3.0);
  EXPECT_EQ(acted, 0);
}

// 8 rad/s is 0.8 of the limit: gamma (8 - u) with gamma = 20 / s is all the acceleration there is.
TEST_F(OneJoint, NearItsVelocityLimitItsAccelerationFades) {
  EXPECT_NEAR(shaped(-0.9, 7.9, 15.0), 0.5 * 20.0 * 0.1, 1e-9);
  EXPECT_EQ(acted, +Status::LIMIT_VELOCITY);
  EXPECT_NEAR(shaped(-0.9, 8.4, 15.0), -0.5 * 20.0 * 0.4, 1e-9) << "beyond it, it brakes";
  EXPECT_NEAR(shaped(1.9, -8.4, -15.0), 0.5 * 20.0 * 0.4, 1e-9);
  EXPECT_EQ(shaped(-0.9, 8.4, -15.0), -15.0) << "what brakes harder is left alone";
}

/// Two motors with rotors of 0.1 kg m^2 behind springs of 2 k2 c = 100 N m/rad, that bend by `bend`
/// at a preload of 0.25 rad, on a link of 0.5 kg m^2.
class TwoMotors : public OneJoint {
 protected:
  TwoMotors() {
    robot.joints[0].position_max = -(robot.joints[0].position_min = -100.0);
    TransmissionConfig& transmission = robot.joints[0].transmission;
    transmission.kind = TransmissionKind::kAntagonistic;
    transmission.spring = {.law = SpringLaw::kQuadratic, .k2_Nm_per_rad2 = 200.0};
    transmission.preload_rad = 0.25;
    state.preload << 0.25;
    state.q << 0.0;
    terms.M << 0.5;
    terms.M_total << 0.6;
  }
  /// The torque left of `demand` when the motors have turned at theta_dot under `applied` for 0.2
  /// s.
  double shaped(double bend, double theta_dot, double demand, double applied) {
    Stopping stopping(robot, most);
    state.theta << bend;
    state.theta_dot_reported << theta_dot;
    state.v_reported << 0.0;
    state.tau_applied << applied;
    for (int i = 0; i < 200; ++i) {
      state.time_ns += 1'000'000;
      stopping.observe(state, terms);
    }
    VectorJ tau = VectorJ::Constant(1, demand);
    acted = stopping.shape(state, terms, {-most, most}, &tau);
    return tau[0];
  }
  const VectorJ most = VectorJ::Constant(1, 20.0);
};

// 50 mrad bent: tau_J = 5 N m. Motors that bend the springs further keep to w = 0.4 of 10 rad/s, by
// 20 / s (w - theta'), else to 0.8.
TEST_F(TwoMotors, ThatBendTheirSoftSpringsKeepToHalfOfTheSpeed) {
  EXPECT_EQ(shaped(0.05, 3.5, 5.9, 5.0), 5.9);
  EXPECT_EQ(acted, 0);
  EXPECT_NEAR(shaped(0.05, 3.5, 15.0, 5.0), 5.0 + 0.1 * 20.0 * 0.5, 1e-9);
  EXPECT_EQ(acted, +Status::LIMIT_VELOCITY);
  EXPECT_NEAR(shaped(0.05, 4.5, 15.0, 5.0), 5.0 - 0.1 * 20.0 * 0.5, 1e-9) << "beyond it, brake";
  EXPECT_NEAR(shaped(-0.05, -3.5, -15.0, -5.0), -5.0 - 0.1 * 20.0 * 0.5, 1e-9) << "the other way";
  EXPECT_NEAR(shaped(0.05, -3.5, -15.0, 5.0), 5.0 - 0.1 * 20.0 * 4.5, 1e-9) << "ease the springs";
  robot.joints[0].transmission.spring.k2_Nm_per_rad2 = 2000.0;
  EXPECT_EQ(shaped(0.005, 3.5, 15.0, 5.0), 15.0) << "motors and link move as one";
}

// Springs that are thought to pull with 5 N m, while what holds the motors at rest are 2 N m.
TEST_F(TwoMotors, AtRestAreHeldByWhatTheirSpringsReallyPullWith) {
  EXPECT_NEAR(shaped(0.05, 0.0, 19.5, 2.0), 2.0 + 0.1 * 20.0 * 8.0, 1e-3);
  EXPECT_NEAR(shaped(0.05, 0.8, 15.0, 2.0), 5.0 - 0.5 * 3.0 + 0.1 * 20.0 * 3.2, 1e-3)
      << "halfway between";
  EXPECT_NEAR(shaped(0.05, 3.5, 15.0, 2.0), 5.0 + 0.1 * 20.0 * 0.5, 1e-9) << "moving fast";
}

// Half of 20 N m on 0.5 kg m^2 brakes with a = 20 rad/s^2. With kappa = 8 / s that is linear up to
// 20 / 64 rad: 0.25 rad before the end 2 rad/s can be stopped.
TEST_F(OneJoint, TowardsItsEndItIsBraked) {
  EXPECT_NEAR(shaped(1.75, 2.0, 5.0), 0.5 * (-8.0 * 2.0), 1e-9);
  EXPECT_EQ(acted, +Status::LIMIT_POSITION);
  EXPECT_NEAR(shaped(1.75, 1.9, 5.0), 0.5 * (20.0 * 0.1 - 8.0 * 1.9), 1e-9);
  EXPECT_NEAR(shaped(-0.75, -2.0, -5.0), 0.5 * 8.0 * 2.0, 1e-9);
  EXPECT_EQ(shaped(1.75, -2.0, -5.0), -5.0) << "on its way back";
  const double fast = std::sqrt(2.0 * 20.0 * (0.5 - 10.0 / 64.0));
  EXPECT_NEAR(shaped(1.5, fast, 5.0), -10.0, 1e-9) << "further away with half of the torque";
}

TEST_F(OneJoint, WhatCarriesTheWeightStays) {
  terms.g << 6.0;
  EXPECT_NEAR(shaped(-0.9, 7.9, 15.0), 6.0 + 1.0, 1e-9);
}

// Turned by x its weight is 16 sin x: none at 0, but 10 (1 - cos d) / d in the mean over the way d
// to the end. Half of what is left brakes, so much sooner than without weight.
TEST_F(OneJoint, TheWeightOfTheWayToTheEndIsKnownBefore) {
  constexpr double kWay = 2.0;
  constexpr double kWeight_Nm = 16.0;
  const auto speed_that_stops = [](double torque_Nm) {
    const double a = 0.5 * torque_Nm / 0.5;
    return std::sqrt(2.0 * a * (kWay - a / (2.0 * 8.0 * 8.0)));
  };
  const double mean_Nm = kWeight_Nm * (1.0 - std::cos(kWay)) / kWay;
  const double light = speed_that_stops(20.0);
  const double heavy = speed_that_stops(20.0 - mean_Nm);
  ASSERT_LT(heavy + 1.0, light);
  EXPECT_EQ(shaped(0.0, heavy, -15.0), -15.0) << "it brakes as hard";
  EXPECT_GT(shaped(0.0, heavy, 1.0), 0.0) << "without weight there is time";
  terms.g_slope << -kWeight_Nm;  // it falls towards that end
  EXPECT_NEAR(shaped(0.0, heavy, 1.0), -0.5 * (20.0 - mean_Nm), 1e-9);
  EXPECT_EQ(acted, +Status::LIMIT_POSITION);
  terms.g_slope << kWeight_Nm;
  EXPECT_GT(shaped(0.0, heavy, 1.0), 0.0) << "a weight that brakes is not counted on";
  robot.joints[0].type = JointType::kPrismatic;
  terms.g_slope << -kWeight_Nm;
  EXPECT_GT(shaped(0.0, heavy, 1.0), 0.0) << "a rail's is the same everywhere";
}

// 20 N m bring 0.005 kg m^2 to half of 8 rad/s in 1 ms: judged at rest, too. 0.5 kg m^2 are not.
TEST_F(OneJoint, ALightJointIsJudgedBeforeItMoves) {
  EXPECT_EQ(shaped(0.0, 0.0, 15.0), 15.0);
  terms.M_total << 0.005;
  EXPECT_NEAR(shaped(0.0, 0.0, 15.0), 0.005 * 20.0 * 8.0, 1e-9);
  EXPECT_EQ(acted, +Status::LIMIT_VELOCITY);
}

TEST_F(OneJoint, TheReportedVelocityIsJudgedNotTheEstimate) {
  state.v << 0.0;
  EXPECT_LT(shaped(-0.9, 8.4, 15.0), 0.0);
  state.v << 50.0;
  EXPECT_EQ(shaped(0.0, 0.0, 3.0), 3.0);
}

// 1 rad/s away from that end while 40 rad/s^2 brake it: unwound with a jerk of 0.3 (0.8 100) / 0.5
// = 48 rad/s^3 that ends at -1 + 40^2 / 96 rad/s, far beyond the limit. To end at 8 rad/s it may
// have sqrt(2 48 (9 - 48 / (2 20^2))).
TEST_F(OneJoint, BrakedItIsNotThrownBackBeyondItsVelocityLimit) {
  robot.joints[0].torque_rate_limit_Nm_per_s = 100.0;
  const VectorJ most = VectorJ::Constant(1, 20.0);
  Stopping stopping(robot, most);
  terms.M << 0.5;
  state.q << 0.0;
  state.v_reported << -1.0;
  state.theta_dot_reported << -1.0;
  const auto left = [&](double demand) {
    VectorJ tau = VectorJ::Constant(1, demand);
    acted = stopping.shape(state, terms, {-most, most}, &tau);
    return tau[0];
  };
  EXPECT_EQ(left(20.0), 20.0) << "what acts besides is not known yet";
  for (int k = 0; k < 100; ++k) {
    state.time_ns = k * std::int64_t{1'000'000};
    stopping.observe(state, terms);
  }
  EXPECT_NEAR(left(20.0), 0.5 * std::sqrt(2.0 * 48.0 * (9.0 - 0.06)), 1e-9);
  EXPECT_EQ(acted, +Status::LIMIT_VELOCITY);
  EXPECT_EQ(left(10.0), 10.0) << "-1 + 20^2 / 96 is slow";
}

// Half of the limit is far from it, 0.8 is not: there the 5 N m that drive the joint take 10
// rad/s^2 of what its torque may.
TEST_F(OneJoint, WhatDrivesItCountsNearItsVelocityLimit) {
  const VectorJ most = VectorJ::Constant(1, 20.0);
  terms.M << 0.5;
  for (const auto& [share, counted] : {std::pair{0.5, 0.0}, {0.65, 0.5}, {0.79, 0.29 / 0.3}}) {
    Stopping stopping(robot, most);
    const double u0 = 8.0 * share - 1.0;  // 0.1 s of 10 rad/s^2
    for (int k = 0; k <= 1000; ++k) {
      state.time_ns = k * std::int64_t{100'000};
      state.period_s = 1e-4;
      state.v_reported << u0 + 1e-3 * k;
      stopping.observe(state, terms);
    }
    state.theta_dot_reported = state.v_reported;
    state.q << -0.9;
    VectorJ tau = VectorJ::Constant(1, 15.0);
    stopping.shape(state, terms, {-most, most}, &tau);
    const double r = 5.0 * (1.0 - std::exp(-0.1 / Stopping::kMemory_s));
    const double bound = 20.0 * (8.0 - 8.0 * share);
    EXPECT_NEAR(tau[0], std::min(15.0, 0.5 * bound - counted * r), 0.03) << share;
  }
}

/// Random torques of up to their limits, held for 20 to 200 ms, through limits and rate. No
/// friction, no delay but one cycle. Returns the greatest of speed over its limit, and of what is
/// beyond an end, rad.
struct Worst {
  double speed = 0.0;
  double beyond = -1.0;
};
Worst torture(const LoadedRobot& robot, unsigned seed, double gravity_share, int cycles) {
  const int n = robot.robot.size();
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Plant plant(robot);
  ArmModel model(robot);
  ArmState state(n);
  ArmTerms terms(n);
  state.period_s = kT;
  JointLimits limits(robot.robot);
  VectorJ demand = VectorJ::Zero(n);
  Worst worst;
  for (int k = 0, next = 0; k < cycles; ++k) {
    if (k == next) {
      for (Eigen::Index i = 0; i < n; ++i)
        demand[i] = uniform(random) * 1.5 * limits.torque_limit()[i];
      next += 20 + static_cast<int>(90.0 * (1.0 + uniform(random)));
    }
    state.time_ns = k * std::int64_t{1'000'000};
    state.q = plant.q;
    state.v_reported = state.theta_dot_reported = plant.v;
    model.evaluate(plant.q, plant.v, &terms);
    VectorJ tau = demand + gravity_share * terms.g;
    const VectorJ walls = limits.walls(state, terms.M_total);
    tau += walls;
    const VectorJ before = state.tau_applied;
    limits.shape(state, terms, walls, &tau);
    limits.clamp(state, terms, &tau);
    plant.advance(kT, [&](const VectorJ&, const VectorJ&) { return before; });
    state.tau_applied = tau;
    for (Eigen::Index i = 0; i < n; ++i) {
      const JointConfig& joint = robot.robot.joints[static_cast<std::size_t>(i)];
      worst.speed = std::max(worst.speed, std::abs(plant.v[i]) / joint.velocity_limit);
      worst.beyond = std::max(
          {worst.beyond, plant.q[i] - joint.position_max, joint.position_min - plant.q[i]});
    }
  }
  return worst;
}

TEST(Stopping, RandomTorquesCarryNoJointPastItsLimits) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const Worst worst = torture(desktop(), seed, 1.0, 30'000);
    EXPECT_LT(worst.speed, 1.0) << seed;
    EXPECT_GT(worst.speed, 0.5) << "the torques do drive it fast";
    EXPECT_LT(worst.beyond, 1e-3) << seed;
    EXPECT_GT(worst.beyond, -0.2) << "and towards its ends";
  }
}

TEST(Stopping, SlowRatesAndHeavyArmsToo) {
  LoadedRobot robot = desktop();
  for (JointConfig& joint : robot.robot.joints) {
    joint.torque_rate_limit_Nm_per_s = 200.0;
    joint.velocity_limit = 10.0;
  }
  const Worst worst = torture(robot, 5, 1.0, 30'000);
  EXPECT_LT(worst.speed, 1.1);
  EXPECT_LT(worst.beyond, 0.02);
}

}  // namespace
}  // namespace limber::controller::test_stopping
