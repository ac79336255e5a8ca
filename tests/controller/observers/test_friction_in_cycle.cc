// The friction model takes viscous friction off the arm, by the share asked for.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/controller/rig.h"

namespace limber::test_friction_in_cycle {
namespace {

using limber::testing::kSliderMass;
using limber::testing::Rig;
using Gains = compliance_gains_t;

constexpr double kViscous = 3.0;
constexpr double kCoulomb = 0.5;

LoadedRobot arm() {
  LoadedRobot robot = limber::testing::slider();
  robot.robot.joints[0].friction.viscous_Nms_per_rad = kViscous;
  robot.robot.joints[0].friction.coulomb_Nm = kCoulomb;
  return robot;
}

// Speed after a second of coasting, over the speed before.
double coast(std::int8_t friction, double share) {
  Rig rig(arm(), "gravity_compensation");
  rig.viscous.setConstant(kViscous);
  rig.to_active();
  Gains gains = rig.gains();
  gains.friction_compensation = friction;
  gains.friction_share = static_cast<float>(share);
  EXPECT_EQ(rig.controller.on_gains(gains), nullptr);
  rig.run(0.6);  // the torque has faded over
  rig.plant.v[0] = 0.3;
  rig.run(0.05);
  const double before = rig.plant.v[0];
  rig.run(1.0);
  return rig.plant.v[0] / before;
}

// m dv/dt = -(1 - share) d v
TEST(FrictionInCycle, CoastsWithTheFrictionThatIsLeft) {
  EXPECT_NEAR(coast(Gains::FRICTION_MODEL, 1.0), 1.0, 5e-3);
  EXPECT_NEAR(coast(Gains::FRICTION_MODEL, 0.5), std::exp(-0.5 * kViscous / kSliderMass), 5e-3);
  EXPECT_NEAR(coast(Gains::FRICTION_NONE, 1.0), std::exp(-kViscous / kSliderMass), 1e-6);
}

TEST(FrictionInCycle, CoulombPartFollowsTheGoal) {
  for (const std::int8_t friction : {Gains::FRICTION_NONE, Gains::FRICTION_MODEL}) {
    Rig rig(arm(), "joint_pd");
    rig.to_active();
    Gains gains = rig.gains();
    gains.friction_compensation = friction;
    gains.friction_share = 0.8F;
    ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
    compliance_goal_t goal = rig.goal();
    goal.kind = compliance_goal_t::GOAL_JOINT;
    goal.q[0] = 0.1;
    goal.duration_s = 1.0;
    ASSERT_EQ(rig.controller.on_goal(goal), nullptr);
    rig.run(0.5);  // in the middle it is fast
    const double share = friction == Gains::FRICTION_NONE ? 0.0 : 0.8;
    EXPECT_NEAR(rig.controller.status().tau_friction[0],
                share * (-kCoulomb + kViscous * rig.state.v[0]), 1e-6);
  }
}

}  // namespace
}  // namespace limber::test_friction_in_cycle
