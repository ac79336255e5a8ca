// A gains request changes what it names; the controller keeps the rest, until it is reset.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "controller/gains/read_gains.h"
#include "controller/laws/registry.h"
#include "lcmtypes/gains_merge.h"
#include "tests/controller/rig.h"

namespace limber::test_kept_gains {
namespace {

using limber::testing::Rig;
using Message = compliance_gains_t;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class KeptGains : public ::testing::Test {
 protected:
  KeptGains() : rig(limber::testing::seven_joint_arm()) { rig.to_active(); }

  // Everything that is not named would be refused.
  Message named(std::initializer_list<const char*> keys) const {
    Message message = rig.gains();
    message.scope = Message::SCOPE_NAMED;
    message.damping_ratio = message.joint_damping_ratio = message.K_x[0][0] = kNaN;
    message.orientation = 99;
    for (const char* key : keys) name_gain(key, &message);
    return message;
  }

  float K_x(int i) const { return rig.controller.status().K_x[i][i]; }

  void take(const Message& message) {
    ASSERT_EQ(rig.controller.on_gains(message), nullptr);
    rig.run(0.3);
  }

  void stiffen() {
    Message message = named({"K_x_translation_N_per_m"});
    for (int i = 0; i < 3; ++i) message.K_x[i][i] = 900.0 + i;
    take(message);
  }

  Rig rig;
};

TEST_F(KeptGains, OfEarlierRequests) {
  const float rotation = K_x(4);
  stiffen();
  EXPECT_EQ(K_x(0), 900.0F);
  EXPECT_EQ(K_x(2), 902.0F);
  EXPECT_EQ(K_x(4), rotation);
  Message ratio = named({"damping_ratio"});
  ratio.damping_ratio = 0.3;
  take(ratio);
  EXPECT_EQ(K_x(0), 900.0F) << "a request of a damping ratio alone leaves the stiffness";
}

// In contact a stiffness that falls back to robot.yaml's would be a kick.
TEST_F(KeptGains, ADampingRatioDoesNotMoveAPushedArm) {
  stiffen();
  rig.plant.F_ext[0] = 8.0;
  rig.run(3.0);
  const auto x_m = [this] { return rig.controller.status().p_BT[0]; };
  const double before_m = x_m();
  Message ratio = named({"damping_ratio"});
  ratio.damping_ratio = 0.9;
  take(ratio);
  EXPECT_LT(std::abs(x_m() - before_m), 2e-4);
  take(rig.gains());
  rig.run(1.0);
  EXPECT_GT(std::abs(x_m() - before_m), 5e-3) << "what a reset does to it";
}

TEST_F(KeptGains, AResetGoesBackToTheRobots) {
  const float before = K_x(0);
  stiffen();
  take(rig.gains());  // SCOPE_ALL
  EXPECT_EQ(K_x(0), before);
}

TEST_F(KeptGains, ARefusedRequestLeavesNothingBehind) {
  stiffen();
  Message bad = named({"K_q_Nm_per_rad", "damping_ratio"});
  bad.K_q[0] = 5.0;
  bad.damping_ratio = -1.0;
  EXPECT_NE(rig.controller.on_gains(bad), nullptr);
  const float K_q = rig.controller.status().K_q[0];
  EXPECT_NE(K_q, 5.0F);
  take(named({}));
  EXPECT_EQ(rig.controller.status().K_q[0], K_q);
  EXPECT_EQ(K_x(0), 900.0F);
}

TEST_F(KeptGains, ParametersOfSingleLaws) {
  const auto parameters = controller::law_catalog().parameters;
  const GainRow& M_q = *find_row(parameters, "M_q_kgm2");
  const GainRow& torque_gain = *find_row(parameters, "torque_gain");
  controller::LawParameters kept(7, parameters);
  Message request = named({});
  set_parameter("M_q_kgm2", std::vector<float>(7, 0.5F), &request);
  read_parameters(request, &kept, 7);
  request.parameters.clear();
  set_parameter("torque_gain", {0.25F}, &request);
  read_parameters(request, &kept, 7);
  EXPECT_EQ(kept.matrix(M_q)(6, 6), 0.5);
  EXPECT_EQ(kept.number(torque_gain), 0.25);
  request.scope = Message::SCOPE_ALL;
  read_parameters(request, &kept, 7);
  EXPECT_EQ(kept.matrix(M_q)(6, 6), controller::LawParameters(7, parameters).matrix(M_q)(6, 6));
  EXPECT_EQ(kept.number(torque_gain), 0.25) << "listed";
}

TEST_F(KeptGains, WrongNamesAndScopesAreRefused) {
  EXPECT_STREQ(rig.controller.on_gains(named({"K_z"})), "named: no field has a key of this name");
  Message scope = rig.gains();
  scope.scope = 2;
  EXPECT_STREQ(rig.controller.on_gains(scope), "scope is neither SCOPE_ALL nor SCOPE_NAMED");
}

TEST_F(KeptGains, TheStackNamesItsArm) {
  const robot_info_t& info = rig.controller.robot_info();
  EXPECT_EQ(info.robot, rig.robot.robot.name);
  EXPECT_EQ(info.joints, rig.robot.robot.joint_names());
  EXPECT_EQ(info.num_joints, 7);
  EXPECT_EQ(info.controller, rig.controller.status().controller);
  EXPECT_EQ(info.simulated, 1);
  EXPECT_GT(info.seq, 3);
}

}  // namespace
}  // namespace limber::test_kept_gains
