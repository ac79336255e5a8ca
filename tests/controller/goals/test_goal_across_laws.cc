// A goal that goes round a circle goes on while laws for the tip and for the joints take turns.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "tests/controller/rig.h"

namespace limber::test_goal_across_laws {
namespace {

using limber::testing::Rig;
using Gains = compliance_gains_t;

constexpr double kRadius = 0.04;
constexpr double kPeriod_s = 2.0;

Eigen::Vector3d goal_of(const Rig& rig) {
  return Eigen::Vector3d::Map(rig.controller.status().p_BD);
}

TEST(GoalAcrossLaws, TheCircleGoesOn) {
  Rig rig(limber::testing::seven_joint_arm());
  rig.plant.q << 0.4, -0.8, 0.5, 1.2, -0.6, 0.9, 0.7;
  rig.to_active();
  const Eigen::Vector3d centre = goal_of(rig) + Eigen::Vector3d(kRadius, 0.0, 0.0);
  compliance_goal_t circle = rig.goal();
  circle.kind = compliance_goal_t::GOAL_CIRCLE;
  circle.offset[0] = kRadius;
  circle.offset[5] = 1.0;
  circle.duration_s = kPeriod_s;
  ASSERT_EQ(rig.controller.on_goal(circle), nullptr);
  rig.run(kPeriod_s);  // up to speed

  const double speed = 2.0 * std::numbers::pi * kRadius / kPeriod_s;
  const double chord = 2.0 * kRadius * std::sin(0.5 * speed / kRadius * 1e-3);
  for (const std::string law : {"joint_pd", "cartesian_impedance", "pd_plus", "computed_torque",
                                "mapped_joint_impedance", "cartesian_impedance"}) {
    Gains gains = rig.gains();
    gains.law = law;
    ASSERT_EQ(rig.controller.on_gains(gains), nullptr) << law;
    for (int i = 0; i < 700; ++i) {
      const Eigen::Vector3d before = goal_of(rig);
      rig.step();
      ASSERT_NEAR((goal_of(rig) - before).norm(), chord, 1e-9) << law << ' ' << i;
      ASSERT_NEAR((goal_of(rig) - centre).norm(), kRadius, 1e-9) << law << ' ' << i;
    }
    const Eigen::Vector3d tip = Eigen::Vector3d::Map(rig.controller.status().p_BT);
    EXPECT_LT((tip - goal_of(rig)).norm(), 0.25 * kRadius) << law << " follows";
  }
}

// A goal at the joints that is under way when a law for the tip takes over ends there, for good.
TEST(GoalAcrossLaws, AMotionOfTheJointsDoesNotGoOnUnseen) {
  Rig rig(limber::testing::seven_joint_arm(), "joint_pd");
  rig.plant.q << 0.4, -0.8, 0.5, 1.2, -0.6, 0.9, 0.7;
  rig.to_active();
  compliance_goal_t away = rig.goal();
  away.kind = compliance_goal_t::GOAL_JOINT;
  away.num_joints = 7;
  for (int i = 0; i < 7; ++i) away.q[i] = rig.plant.q[i] + 0.2;
  away.duration_s = 2.0;
  ASSERT_EQ(rig.controller.on_goal(away), nullptr);
  rig.run(1.0);
  const Eigen::Vector3d half_way = goal_of(rig);
  for (const std::string law : {"cartesian_impedance", "joint_pd"}) {
    Gains gains = rig.gains();
    gains.law = law;
    ASSERT_EQ(rig.controller.on_gains(gains), nullptr) << law;
    rig.run(2.0);
    EXPECT_LT((goal_of(rig) - half_way).norm(), 2e-3) << law;
  }
}

}  // namespace
}  // namespace limber::test_goal_across_laws
