// Joint limits where they begin, and of joints with two motors, springs or a short range.
#include <gtest/gtest.h>

#include <cmath>
#include <limber/controller_status_t.hpp>

#include "common/config_error.h"
#include "controller/output/joint_limits.h"
#include "tests/controller/one_joint.h"

namespace limber::controller::test_joint_limits_edges {
namespace {

using Status = controller_status_t;

VectorJ one(double x) { return VectorJ::Constant(1, x); }

/// A rigid joint: -1..2 rad, 10 rad/s, 20 N m, 500 N m/s; the weight takes 3 N m, M = 0.5 kg m^2.
class JointLimitsEdges : public ::testing::Test {
 protected:
  JointLimitsEdges() : state_(1), terms_(1) {
    robot_.joints.resize(1);
    robot_.name = "arm";
    JointConfig& joint = robot_.joints[0];
    joint.name = "elbow";
    joint.position_min = -1.0;
    joint.position_max = 2.0;
    joint.velocity_limit = 10.0;
    joint.torque_limit_Nm = 20.0;
    joint.torque_rate_limit_Nm_per_s = 500.0;
    terms_.g << 3.0;
    terms_.M_total << 0.5;
  }
  JointConfig& joint() { return robot_.joints[0]; }
  /// Two motors whose springs have k2 = 128 N m/rad^2, with 0.25 rad of preload: k2 c^2 = 8 N m.
  void give_it_two_motors(double first_Nm, double second_Nm) {
    joint().has_antagonist = true;
    joint().drive.peak_torque_Nm = first_Nm;
    joint().antagonist.peak_torque_Nm = second_Nm;
    joint().transmission.kind = TransmissionKind::kAntagonistic;
    joint().transmission.spring = {.law = SpringLaw::kQuadratic, .k2_Nm_per_rad2 = 128.0};
    joint().transmission.preload_rad = 0.25;
  }
  /// The torque that is left of `tau`; the bits that acted are in acted_.
  double shaped(double tau) {
    const JointLimits limits(robot_);
    const VectorJ walls = limits.walls(state_, terms_.M_total);
    VectorJ shaped = one(tau) + walls;
    acted_ = limits.shape(state_, terms_, walls, &shaped);
    return shaped[0];
  }

  Robot robot_;
  ArmState state_;
  ArmTerms terms_;
  int acted_ = 0;
};

TEST_F(JointLimitsEdges, PowerThatFitsIsLeftAlone) {
  robot_.power_limit_W = 32.0;
  state_.v_reported << 4.0;
  EXPECT_EQ(shaped(8.0), 8.0) << "32 W";
  EXPECT_EQ(acted_, 0);
  EXPECT_NEAR(shaped(8.1), 8.0, 1e-12);
  EXPECT_EQ(acted_, +Status::LIMIT_POWER);
}

TEST_F(JointLimitsEdges, WhatCarriesTheWeightIsNotScaled) {
  robot_.power_limit_W = 5.0;
  state_.v_reported << 4.0;  // the weight alone takes 12 W
  EXPECT_EQ(shaped(6.0), 3.0);
  EXPECT_EQ(shaped(3.1), 3.0);
  EXPECT_EQ(shaped(3.0), 3.0);
  EXPECT_EQ(acted_, 0) << "nothing moves it";
  EXPECT_EQ(shaped(2.9), 2.9) << "it brakes";
}

TEST_F(JointLimitsEdges, OfAShortRangeATenthIsWall) {
  joint().position_min = 0.0;
  joint().position_max = 0.5;  // wall of 0.05, 200 N m/rad
  state_.q << 0.45;
  EXPECT_EQ(shaped(1.0), 1.0);
  state_.q << 0.475;
  EXPECT_NEAR(shaped(1.0), 1.0 - 5.0, 1e-12);
  EXPECT_EQ(acted_, +Status::LIMIT_POSITION);
  state_.q << 0.025;
  EXPECT_NEAR(shaped(1.0), 1.0 + 5.0, 1e-12);
}

// K = 0.5 * 20 / 0.1 = 100 N m/rad, D = 1.4 sqrt(100 * 0.5) = 9.9 N m s/rad at the joint's end.
TEST_F(JointLimitsEdges, TheDamperComesInWithTheDepth) {
  const double D = 1.4 * std::sqrt(50.0);
  const auto wall = [&](double q, double v) {
    state_.q << q;
    state_.v_reported << v;
    return shaped(0.0);
  };
  EXPECT_NEAR(wall(1.925, 0.2), -2.5 - 0.25 * D * 0.2, 1e-9);
  EXPECT_NEAR(wall(2.3, 0.2), -40.0 - D * 0.2, 1e-9) << "beyond the end no more than D";
  EXPECT_NEAR(wall(-0.95, -0.2), 5.0 + 0.5 * D * 0.2, 1e-9);
  EXPECT_NEAR(wall(-0.95, 0.2), 5.0, 1e-9) << "on its way out";
}

TEST_F(JointLimitsEdges, BehindASpringTheMotorIsDamped) {
  const double D = 1.4 * std::sqrt(50.0);
  state_.q << 2.0;
  state_.v_reported << 0.5;
  state_.theta_dot_reported << 0.2;
  EXPECT_NEAR(shaped(0.0), -10.0 - D * 0.5, 1e-9);
  joint().transmission.kind = TransmissionKind::kElastic;
  EXPECT_NEAR(shaped(0.0), -10.0 - D * 0.2, 1e-9);
}

// 100 N m/rad from 0.1 rad inside the ends on; 0.1 rad/s.
TEST_F(JointLimitsEdges, AJointThatRestsInItsWallIsLedOut) {
  JointLimits limits(robot_);
  const auto wall_at = [&](double q) {
    state_.q << q;
    return limits.walls(state_, terms_.M_total)[0];
  };
  limits.rest(one(1.97));
  EXPECT_EQ(wall_at(1.97), 0.0);
  EXPECT_NEAR(wall_at(1.98), -1.0, 1e-12) << "outwards it begins there";
  limits.lead_out(one(1.97), 0.05);
  EXPECT_NEAR(wall_at(1.97), -0.5, 1e-12);
  for (int i = 0; i < 3; ++i) limits.lead_out(one(1.97), 0.2);
  EXPECT_NEAR(wall_at(1.97), -1.0, 1e-12) << "a tenth of its width before a joint that is held";
  limits.lead_out(one(1.99), 0.2);
  EXPECT_NEAR(wall_at(1.97), -1.0, 1e-12) << "and never back";
  limits.lead_out(one(1.94), 0.2);
  EXPECT_NEAR(wall_at(1.97), -3.0, 1e-12);
  for (int i = 0; i < 3; ++i) limits.lead_out(one(1.0), 1.0);
  EXPECT_NEAR(wall_at(1.97), -7.0, 1e-12) << "at its place";
  limits.rest(one(-0.96));
  EXPECT_NEAR(wall_at(1.97), -7.0, 1e-12) << "the other end's does not move";
  EXPECT_EQ(wall_at(-0.96), 0.0);
  limits.lead_out(one(-0.96), 0.05);
  EXPECT_NEAR(wall_at(-0.96), 0.5, 1e-12);
  for (int i = 0; i < 3; ++i) limits.lead_out(one(-0.96), 0.2);
  EXPECT_NEAR(wall_at(-0.96), 1.0, 1e-12);
  limits.lead_out(one(-0.99), 0.2);
  EXPECT_NEAR(wall_at(-0.96), 1.0, 1e-12);
  limits.rest(one(0.5));
  EXPECT_NEAR(wall_at(-0.96), 6.0, 1e-12);
}

TEST_F(JointLimitsEdges, FarIsMoreThanAStepOfTheGate) {
  JointLimits limits(robot_);
  limits.set_previous(one(4.0));
  for (const double sign : {1.0, -1.0}) {
    EXPECT_FALSE(limits.far_from_previous(one(4.0 + sign * 0.5), 1e-3));
    EXPECT_TRUE(limits.far_from_previous(one(4.0 + sign * 0.501), 1e-3));
  }
}

// Twice the weaker one's torque, less what the springs take.
TEST_F(JointLimitsEdges, TwoMotorsHoldTheirPreloadBesides) {
  give_it_two_motors(10.0, 12.0);
  EXPECT_NEAR(JointLimits(robot_).torque_limit()[0], 20.0 - 8.0, 1e-12);
  give_it_two_motors(12.0, 10.0);
  EXPECT_NEAR(JointLimits(robot_).torque_limit()[0], 20.0 - 8.0, 1e-12);
  give_it_two_motors(40.0, 40.0);
  EXPECT_EQ(JointLimits(robot_).torque_limit()[0], 20.0) << "the joint's own";
  joint().has_antagonist = false;
  joint().drive.peak_torque_Nm = 1.0;
  EXPECT_EQ(JointLimits(robot_).torque_limit()[0], 20.0);
}

TEST_F(JointLimitsEdges, MotorsThatCannotHoldTheirPreloadAreRefused) {
  const auto refusal = [this] {
    try {
      const JointLimits limits(robot_);
    } catch (const ConfigError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  give_it_two_motors(4.1, 5.0);
  EXPECT_EQ(refusal(), "");
  for (const double weaker_Nm : {4.0, 1.5}) {
    give_it_two_motors(5.0, weaker_Nm);
    const std::string together = std::to_string(2.0 * weaker_Nm);
    EXPECT_EQ(refusal(),
              "arm: joint elbow: its motors cannot hold preload_rad: together they have " +
                  together + " N m, the springs take " + std::to_string(8.0));
  }
}

}  // namespace
}  // namespace limber::controller::test_joint_limits_edges
