// Where a law sees an arm whose motors alone are known.
#include <gtest/gtest.h>

#include "controller/elastic/arm_view.h"
#include "controller/laws/registry.h"
#include "robots/loader/load_robot.h"

namespace limber::controller::test_arm_view {
namespace {

// The elbow's springs have 200 N m/rad. For 0.9 of that at the link, motors that are x from the
// goal need a link that is 10 x from it, as long as they have the torque, 60 N m.
TEST(ArmView, TheLinkIsNoFartherThanTheTorqueLimitBendsTheSpring) {
  const LoadedRobot robot = load_robot("antagonist2r");
  ArmView view(robot);
  ArmState state(2);
  state.theta << 0.5, 1.0;
  state.q = state.theta;
  state.preload.setConstant(0.25);
  Gains gains(2, law_catalog().parameters);
  gains.K_q = 180.0 * MatrixJ::Identity(2, 2);
  Goal goal(2);
  const VectorJ none = VectorJ::Zero(2);
  const auto bend_at = [&](double x) {
    goal.q_d = state.theta;
    goal.q_d[1] -= x;
    view.evaluate(PositionFeedback::kStatic, state,
                  {Potential::kJointSpring, false, goal, gains, none}, {});
    EXPECT_TRUE(view.solved());
    return view.point().q[1] - state.theta[1];
  };
  EXPECT_NEAR(bend_at(0.01), 9.0 * 0.01, 1e-7);
  EXPECT_NEAR(bend_at(-0.02), -9.0 * 0.02, 1e-7);
  EXPECT_NEAR(bend_at(0.2), 60.0 / 200.0, 1e-12);
  EXPECT_NEAR(bend_at(-2.0), -60.0 / 200.0, 1e-12);
}

}  // namespace
}  // namespace limber::controller::test_arm_view
