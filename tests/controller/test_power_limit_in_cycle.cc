// The arm's power limit, from robot.yaml to the motion it allows.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/controller/rig.h"

namespace limber::test_power_limit_in_cycle {
namespace {

using limber::testing::kSliderMass;
using limber::testing::Rig;
using Status = controller_status_t;

constexpr double kLimit_W = 2.0;

struct Sprint {
  explicit Sprint(double limit_W) {
    LoadedRobot robot = limber::testing::slider();
    robot.robot.power_limit_W = limit_W;
    Rig rig(robot);
    rig.to_active();
    compliance_gains_t gains = rig.gains();
    gains.damping_ratio = 0.1;
    EXPECT_EQ(rig.controller.on_gains(gains), nullptr);
    compliance_goal_t goal = rig.goal();
    goal.offset[0] = 0.6;
    goal.duration_s = 0.1;
    EXPECT_EQ(rig.controller.on_goal(goal), nullptr);
    // While the goal gathers speed: a spring that snaps back outruns the torque's rate limit.
    for (int i = 0; i < 500; ++i) {
      const double before = energy_J(rig);
      rig.step();
      const double power_W = (energy_J(rig) - before) / 1e-3;
      most_W = std::max(most_W, power_W);
      if ((rig.controller.status().limits & Status::LIMIT_POWER) == 0) continue;
      ++limited;
      mean_W += power_W;
    }
    if (limited > 0) mean_W /= limited;
  }
  static double energy_J(const Rig& rig) {
    return 0.5 * kSliderMass * rig.plant.v[0] * rig.plant.v[0];
  }

  double most_W = 0.0;
  double mean_W = 0.0;
  int limited = 0;
};

// Without weight and friction all the power becomes kinetic energy.
TEST(PowerLimitInCycle, KineticEnergyRisesNoFaster) {
  const Sprint limited(kLimit_W);
  EXPECT_GT(limited.limited, 100);
  EXPECT_NEAR(limited.mean_W, kLimit_W, 0.05 * kLimit_W);
  EXPECT_LT(limited.most_W, 1.15 * kLimit_W) << "one cycle of delay: the slider is faster by then";
}

TEST(PowerLimitInCycle, WithoutOneItDoes) {
  const Sprint free(std::numeric_limits<double>::infinity());
  EXPECT_EQ(free.limited, 0);
  EXPECT_GT(free.most_W, 2.0 * kLimit_W);
}

}  // namespace
}  // namespace limber::test_power_limit_in_cycle
