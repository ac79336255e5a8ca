// What the controller says after a break comes from after the break.
#include <gtest/gtest.h>

#include "tests/controller/rig.h"

namespace limber::test_fresh_start {
namespace {

using limber::testing::Rig;
using Gains = compliance_gains_t;
using Status = controller_status_t;

struct Estimating {
  Estimating() : rig(limber::testing::slider()) {
    Gains gains = rig.gains();
    gains.velocity = Gains::VELOCITY_FILTERED_DIFFERENCE;
    gains.contact = Gains::CONTACT_JOINT_TORQUE;
    EXPECT_EQ(rig.controller.on_gains(gains), nullptr);
    rig.run(0.2);
  }
  // The arm was moved meanwhile.
  void expect_nothing_of_the_past() {
    rig.plant.q[0] += 0.5;
    rig.step();
    EXPECT_EQ(rig.controller.status().V_BT[0], 0.0);
    EXPECT_EQ(rig.controller.status().tau_ext[0], 0.0F);
  }
  Rig rig;
};

TEST(FreshStart, ANewSessionIsNoMotion) {
  Estimating arm;
  arm.rig.state.session += 1;
  arm.rig.state.seq = -1;
  arm.expect_nothing_of_the_past();
}

TEST(FreshStart, NeitherIsALongSilence) {
  Estimating arm;
  arm.rig.state.seq += 50;
  arm.expect_nothing_of_the_past();
}

// Choices made for a law do not take the weight off the arm while it is held.
TEST(FreshStart, HoldingKnowsNoChoices) {
  Rig rig(limber::testing::seven_joint_arm());
  rig.to_hold();
  const VectorJ q = rig.plant.q;
  Gains gains = rig.gains();
  gains.model_compensation = Gains::COMPENSATION_NONE;
  gains.joint_damping = Gains::DAMPING_GIVEN;  // and none is given
  ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
  rig.run(1.0);
  EXPECT_LT((rig.plant.q - q).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_EQ(rig.mode(), +Status::MODE_HOLD);
}

TEST(FreshStart, AtRestTheGoalIsWhereTheArmIs) {
  Rig rig(limber::testing::slider());
  rig.to_active();
  rig.request(mode_request_t::REQUEST_HOLD);
  rig.run(0.5);
  rig.plant.F_ext[0] = 10.0;
  rig.run(0.5);
  ASSERT_GT(rig.controller.status().p_BT[0] - rig.controller.status().p_BD[0], 0.05);
  rig.request(mode_request_t::REQUEST_IDLE);
  rig.run(0.1);
  const Status& status = rig.controller.status();
  ASSERT_EQ(rig.mode(), +Status::MODE_IDLE);
  EXPECT_EQ(status.p_BD[0], status.p_BT[0]);
  EXPECT_EQ(status.e[0], 0.0);
  EXPECT_EQ(status.F_law[0], 0.0);
}

// In HOLD the law for the joints runs, and counts no energy at the tip.
TEST(FreshStart, HoldLeavesNothingOfTheLawBefore) {
  Rig rig(limber::testing::slider());
  rig.to_active();
  rig.plant.F_ext[0] = 10.0;
  rig.run(0.3);
  rig.plant.F_ext[0] = 0.0;
  ASSERT_GT(rig.controller.status().passivity_energy_J, 0.01);
  rig.request(mode_request_t::REQUEST_HOLD);
  rig.run(3.0);
  ASSERT_EQ(rig.mode(), +Status::MODE_HOLD);
  EXPECT_EQ(rig.controller.status().passivity_energy_J, 0.0);
  rig.request(mode_request_t::REQUEST_ACTIVE);
  rig.run(0.01);
  ASSERT_EQ(rig.mode(), +Status::MODE_ACTIVE);
  EXPECT_NEAR(rig.controller.status().passivity_energy_J, 0.0, 1e-6);
}

}  // namespace
}  // namespace limber::test_fresh_start
