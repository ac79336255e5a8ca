// Who may ask for what, and when.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "tests/controller/rig.h"

namespace limber::test_requests {
namespace {

using limber::testing::kClient;
using limber::testing::Rig;
using Status = controller_status_t;

// +Status::X below: message constants have no address to bind a reference to.
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

LoadedRobot arm() { return limber::testing::seven_joint_arm(); }

std::string bytes_of(const joint_command_t& message) {
  std::string bytes(static_cast<std::size_t>(message.getEncodedSize()), '\0');
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

TEST(Requests, RequestsAreRefusedInTheWrongMode) {
  Rig rig(arm());
  rig.run(0.12);
  EXPECT_NE(rig.request(mode_request_t::REQUEST_ACTIVE), nullptr);
  EXPECT_NE(rig.request(mode_request_t::REQUEST_ACKNOWLEDGE), nullptr);
  EXPECT_NE(rig.request(99), nullptr);
  EXPECT_NE(rig.controller.on_goal(rig.goal()), nullptr);
  rig.request(mode_request_t::REQUEST_HOLD);
  EXPECT_NE(rig.request(mode_request_t::REQUEST_ACTIVE), nullptr) << "drives are not on yet";
  rig.step();
  EXPECT_EQ(rig.controller.status().requests_refused, 5);
  EXPECT_EQ(rig.mode(), +Status::MODE_HOLD);
}

TEST(Requests, LeaseKeepsOthersOut) {
  Rig rig(arm());
  rig.run(0.12);
  EXPECT_NE(rig.request(mode_request_t::REQUEST_HOLD, 0), nullptr);
  EXPECT_NE(rig.request(mode_request_t::REQUEST_ACTIVE, 5), nullptr);
  EXPECT_EQ(rig.request(mode_request_t::REQUEST_HOLD, kClient), nullptr)
      << "a request that was refused took no lease";
  EXPECT_NE(rig.request(mode_request_t::REQUEST_IDLE, 5), nullptr);
  compliance_gains_t gains = rig.gains();
  gains.client = 5;
  EXPECT_NE(rig.controller.on_gains(gains), nullptr);
  EXPECT_NE(rig.request(mode_request_t::REQUEST_RELEASE, 5), nullptr);
  EXPECT_EQ(rig.request(mode_request_t::REQUEST_RELEASE, kClient), nullptr);
  EXPECT_EQ(rig.controller.on_gains(gains), nullptr);
  EXPECT_NE(rig.request(mode_request_t::REQUEST_IDLE, kClient), nullptr);
}

TEST(Requests, WrongGainsAreRefusedWhole) {
  Rig rig(arm());
  rig.to_active();
  struct Case {
    const char* name;
    void (*spoil)(compliance_gains_t*);
  };
  const Case cases[] = {
      {"unknown law", [](compliance_gains_t* g) { g->law = "wishful_thinking"; }},
      {"joint count", [](compliance_gains_t* g) { g->num_joints = 6; }},
      {"orientation", [](compliance_gains_t* g) { g->orientation = 5; }},
      {"NaN", [](compliance_gains_t* g) { g->K_x[1][2] = g->K_x[2][1] = kNaN; }},
      {"too stiff", [](compliance_gains_t* g) { g->K_x[0][0] = 1.1e5; }},
      {"too stiff in rotation", [](compliance_gains_t* g) { g->K_x[4][4] = 1.1e4; }},
      {"negative", [](compliance_gains_t* g) { g->K_x[0][0] = -1.0; }},
      {"not symmetric", [](compliance_gains_t* g) { g->K_x[0][1] = 10.0; }},
      {"indefinite", [](compliance_gains_t* g) { g->K_x[0][1] = g->K_x[1][0] = 1000.0; }},
      {"damping ratio", [](compliance_gains_t* g) { g->damping_ratio = -0.1; }},
      {"joint damping ratio", [](compliance_gains_t* g) { g->joint_damping_ratio = kNaN; }},
      {"K_q", [](compliance_gains_t* g) { g->K_q[6] = -1.0; }},
      {"K_null", [](compliance_gains_t* g) { g->K_null[0] = INFINITY; }},
      {"D_null", [](compliance_gains_t* g) { g->D_null[0] = 2e3; }},
      {"ramp", [](compliance_gains_t* g) { g->ramp_s = -1.0; }},
      {"client", [](compliance_gains_t* g) { g->client = 0; }},
  };
  Rig untouched(arm());
  untouched.to_active();
  for (const Case& c : cases) {
    compliance_gains_t gains = rig.gains();
    for (int i = 0; i < 3; ++i) gains.K_x[i][i] = 900.0;  // would show if taken
    gains.law = "gravity_compensation";
    c.spoil(&gains);
    EXPECT_NE(rig.controller.on_gains(gains), nullptr) << c.name;
    rig.plant.F_ext[0] = untouched.plant.F_ext[0] = 3.0;
    ASSERT_EQ(bytes_of(rig.step()), bytes_of(untouched.step())) << c.name;
  }
  EXPECT_EQ(rig.controller.status().requests_refused, std::ssize(cases));
}

TEST(Requests, WrongGoalsAreRefusedWhole) {
  Rig rig(arm());
  rig.to_active();
  Rig untouched(arm());
  untouched.to_active();
  struct Case {
    const char* name;
    void (*spoil)(compliance_goal_t*);
  };
  const Case cases[] = {
      {"kind", [](compliance_goal_t* g) { g->kind = 9; }},
      {"joint count", [](compliance_goal_t* g) { g->num_joints = 2; }},
      {"duration", [](compliance_goal_t* g) { g->duration_s = kNaN; }},
      {"validity", [](compliance_goal_t* g) { g->valid_for_s = kNaN; }},
      {"endless validity", [](compliance_goal_t* g) { g->valid_for_s = 601.0; }},
      {"negative validity", [](compliance_goal_t* g) { g->valid_for_s = -1.0; }},
      {"validity shorter than any stream's", [](compliance_goal_t* g) { g->valid_for_s = 1e-3; }},
      {"offset", [](compliance_goal_t* g) { g->offset[0] = INFINITY; }},
      {"far away", [](compliance_goal_t* g) { g->offset[0] = 20.0; }},
      {"more than half a turn", [](compliance_goal_t* g) { g->offset[3] = 3.2; }},
      {"wrench", [](compliance_goal_t* g) { g->F_ff[2] = kNaN; }},
      {"strong wrench", [](compliance_goal_t* g) { g->F_ff[2] = 201.0; }},
      {"joint goal", [](compliance_goal_t* g) { g->kind = compliance_goal_t::GOAL_JOINT; }},
      {"quaternion",
       [](compliance_goal_t* g) {
         g->kind = compliance_goal_t::GOAL_POSE;
         g->quat_BD[0] = 0.5;
       }},
      {"pose",
       [](compliance_goal_t* g) {
         g->kind = compliance_goal_t::GOAL_POSE;
         g->p_BD[1] = kNaN;
       }},
      {"posture",
       [](compliance_goal_t* g) {
         g->use_posture = 1;
         g->q[4] = 3.1;
       }},
      {"client", [](compliance_goal_t* g) { g->client = 1; }},
  };
  for (const Case& c : cases) {
    compliance_goal_t goal = rig.goal();
    goal.offset[1] = 0.05;
    c.spoil(&goal);
    EXPECT_NE(rig.controller.on_goal(goal), nullptr) << c.name;
    ASSERT_EQ(bytes_of(rig.step()), bytes_of(untouched.step())) << c.name;
  }
}

}  // namespace
}  // namespace limber::test_requests
