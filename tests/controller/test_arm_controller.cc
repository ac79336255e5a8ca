// The whole controller at a perfect driver: start, modes, goals, answers and status.
#include <gtest/gtest.h>

#include "common/config_error.h"
#include "tests/controller/rig.h"

namespace limber::test_arm_controller {
namespace {

using limber::testing::kClient;
using limber::testing::Rig;
using Status = controller_status_t;

// +Status::X below: message constants have no address to bind a reference to.
// with_drives(): what the gate lets pass in a cycle.
constexpr double kGateStep = 1.0;

LoadedRobot arm() { return limber::testing::seven_joint_arm(); }

TEST(ArmController, AnswersNameTheStateTheyAnswer) {
  Rig rig(arm());
  rig.step();
  EXPECT_EQ(rig.answer.state_seq, 0);
  EXPECT_EQ(rig.answer.session, 11);
  EXPECT_EQ(rig.answer.controller, 3);
  EXPECT_EQ(rig.answer.num_joints, 7);
  rig.step();
  EXPECT_EQ(rig.answer.state_seq, 1);
  EXPECT_EQ(rig.answer.time_ns, 1'000'000);
}

TEST(ArmController, NeedsAHundredGoodStatesBeforeIdle) {
  Rig rig(arm());
  for (int i = 0; i < 99; ++i) rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_INIT);
  rig.state.joint_flags[3] = 0;  // one joint late once: count again
  rig.step();
  rig.state.joint_flags[3] = joint_state_t::JOINT_FRESH;
  for (int i = 0; i < 99; ++i) rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_INIT);
  rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_IDLE);
}

TEST(ArmController, IdleGivesNoTorqueButSaysWhatGravityNeeds) {
  Rig rig(arm());
  rig.run(0.2);
  EXPECT_EQ(rig.tau().norm(), 0.0);
  controller::ArmTerms terms(7);
  rig.plant.model.evaluate(rig.plant.q, rig.plant.v, &terms);
  for (int i = 0; i < 7; ++i) EXPECT_DOUBLE_EQ(rig.answer.tau_gravity[i], terms.g[i]);
  EXPECT_GT(terms.g.norm(), 1.0);
}

// The gate lets three steps of the torque pass.
TEST(ArmController, WhatGravityNeedsChangesByTwoStepsACycle) {
  Rig rig(arm());
  rig.run(0.2);
  rig.plant.q[1] += 1.0;  // as where a law looks at the arm at another point all at once
  double most = 0.0;
  for (int k = 0; k < 200; ++k) {
    const joint_command_t before = rig.answer;
    rig.step();
    for (int i = 0; i < 7; ++i) {
      const JointConfig& joint = rig.robot.robot.joints[static_cast<std::size_t>(i)];
      const double steps = std::abs(rig.answer.tau_gravity[i] - before.tau_gravity[i]) /
                           (1e-3 * joint.torque_rate_limit_Nm_per_s);
      most = std::max(most, steps);
    }
  }
  EXPECT_NEAR(most, 2.0, 1e-9);
  const VectorJ g = rig.plant.model.gravity(rig.plant.q);
  for (int i = 0; i < 7; ++i) EXPECT_NEAR(rig.answer.tau_gravity[i], g[i], 1e-9);
}

TEST(ArmController, HoldStartsFromTheTorquePresentAndKeepsTheArm) {
  Rig rig(arm());
  rig.run(0.12);
  ASSERT_EQ(rig.request(mode_request_t::REQUEST_HOLD), nullptr);
  rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_HOLD);
  EXPECT_EQ(rig.answer.request, +joint_command_t::REQUEST_ON);
  EXPECT_EQ(rig.tau().norm(), 0.0) << "drives not on yet";
  const VectorJ q = rig.plant.q;
  rig.step();
  EXPECT_EQ(rig.answer.request, +joint_command_t::REQUEST_KEEP);
  EXPECT_LT(rig.tau().norm(), 1e-9) << "first torque with drives on";
  rig.clear_jumps();
  double moved = 0.0;
  for (int i = 0; i < 500; ++i) {
    rig.step();
    moved = std::max(moved, (rig.plant.q - q).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(moved, 0.5 * EIGEN_PI / 180.0) << "the arm must not sag when the drives come on";
  EXPECT_LT(rig.jump(), 0.5 * kGateStep);
  rig.run(1.0);
  EXPECT_LT((rig.plant.q - q).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_NEAR((rig.tau() - rig.plant.terms.g).norm(), 0.0, 0.05);
}

TEST(ArmController, TakesOverFromDrivesThatHold) {
  Rig rig(arm());
  rig.run(0.12);
  rig.state.drive_state = joint_state_t::DRIVE_HOLD;
  rig.request(mode_request_t::REQUEST_HOLD);
  // The driver says what its drives apply until the take-over is complete.
  ++rig.state.seq;
  for (int i = 0; i < 7; ++i) rig.state.tau_applied[i] = 0.5 * i;
  rig.state.time_ns = rig.state.seq * rig.state.period_ns;
  rig.answer = rig.controller.step(rig.state);
  EXPECT_EQ(rig.answer.request, +joint_command_t::REQUEST_ACKNOWLEDGE);
  for (int i = 0; i < 7; ++i) EXPECT_EQ(rig.answer.tau[i], 0.5 * i);
  rig.state.drive_state = joint_state_t::DRIVE_ON;
  ++rig.state.seq;
  rig.answer = rig.controller.step(rig.state);
  for (int i = 0; i < 7; ++i) EXPECT_NEAR(rig.answer.tau[i], 0.5 * i, 1e-9);
}

TEST(ArmController, ActiveStartsWhereTheArmIs) {
  Rig rig(arm());
  rig.to_hold();
  rig.plant.F_ext << 5.0, 3.0, -4.0, 0.1, 0.2, 0.0;  // leaning on something
  rig.run(1.0);
  rig.clear_jumps();
  const VectorJ before = rig.tau();
  ASSERT_EQ(rig.request(mode_request_t::REQUEST_ACTIVE), nullptr);
  rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_ACTIVE);
  EXPECT_LT((rig.tau() - before).cwiseAbs().maxCoeff(), 1e-6);
  EXPECT_LT(Eigen::Map<const Vector6>(rig.controller.status().e).norm(), 1e-6);
  rig.run(2.0);
  EXPECT_EQ(rig.limits() & Status::LIMIT_RATE, 0);
  // In the end the spring carries the load: K e = F.
  const Vector6 e = Eigen::Map<const Vector6>(rig.controller.status().e);
  EXPECT_NEAR(e[0] * 500.0, 5.0, 0.05);
  EXPECT_NEAR(e[2] * 500.0, -4.0, 0.05);
}

TEST(ArmController, IdleRequestTurnsTheDrivesOffInStepsTheGatePasses) {
  Rig rig(arm());
  rig.to_hold();
  rig.clear_jumps();
  ASSERT_EQ(rig.request(mode_request_t::REQUEST_IDLE), nullptr);
  rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_IDLE);
  EXPECT_EQ(rig.answer.request, +joint_command_t::REQUEST_OFF);
  EXPECT_LE(rig.jump(), 0.8 * kGateStep + 1e-12);
  rig.step();
  EXPECT_EQ(rig.answer.request, +joint_command_t::REQUEST_KEEP);
  EXPECT_EQ(rig.tau().norm(), 0.0);
}

TEST(ArmController, SoftStopEndsInHold) {
  Rig rig(arm());
  rig.to_active();
  compliance_goal_t goal = rig.goal();
  goal.offset[0] = -0.2;
  ASSERT_EQ(rig.controller.on_goal(goal), nullptr);
  rig.run(0.6);
  const double moving = Eigen::Map<const Vector6>(rig.controller.status().V_BT).head<3>().norm();
  EXPECT_GT(moving, 0.1);
  ASSERT_EQ(rig.request(mode_request_t::REQUEST_STOP, kClient + 1), nullptr) << "from anybody";
  rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_SOFT_STOP);
  EXPECT_EQ(rig.controller.status().reason, +Status::REASON_STOP_REQUESTED);
  EXPECT_NE(rig.controller.on_goal(goal), nullptr) << "no goals while stopping";
  rig.run(0.298);
  EXPECT_EQ(rig.mode(), +Status::MODE_SOFT_STOP);
  EXPECT_LT(Eigen::Map<const Vector6>(rig.controller.status().V_BT).head<3>().norm(), 0.3 * moving);
  rig.run(0.002);
  EXPECT_EQ(rig.mode(), +Status::MODE_HOLD);
  rig.run(1.0);
  EXPECT_LT(Eigen::Map<const Vector6>(rig.controller.status().V_BT).norm(), 1e-3);
  EXPECT_EQ(rig.limits() & Status::LIMIT_RATE, 0);
}

TEST(ArmController, FollowsPoseAndJointGoals) {
  Rig rig(arm());
  rig.to_active();
  const auto& status = rig.controller.status();
  compliance_goal_t goal = rig.goal();
  goal.kind = compliance_goal_t::GOAL_POSE;
  for (int i = 0; i < 3; ++i) goal.p_BD[i] = status.p_BD[i] + (i == 0 ? 0.1 : -0.05);
  for (int i = 0; i < 4; ++i) goal.quat_BD[i] = -status.quat_BD[i];  // the same orientation
  ASSERT_EQ(rig.controller.on_goal(goal), nullptr);
  rig.run(3.0);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(status.p_BT[i], goal.p_BD[i], 1e-3);
  for (int i = 3; i < 6; ++i) EXPECT_NEAR(status.e[i], 0.0, 2e-3);

  compliance_gains_t gains = rig.gains();
  gains.law = "joint_pd";
  ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
  goal.kind = compliance_goal_t::GOAL_JOINT;
  for (int i = 0; i < 7; ++i) goal.q[i] = rig.plant.q[i] + 0.1;
  ASSERT_EQ(rig.controller.on_goal(goal), nullptr);
  rig.run(3.0);
  for (int i = 0; i < 7; ++i) EXPECT_NEAR(rig.plant.q[i], goal.q[i], 2e-3);
  EXPECT_LT(Eigen::Map<const Vector6>(status.e).norm(), 5e-3) << "the goal at the tip moves along";
}

TEST(ArmController, TermsOfTheStatusAddUpToTheTorque) {
  Rig rig(arm());
  rig.to_active();
  compliance_goal_t goal = rig.goal();
  goal.offset[0] = 0.1;
  goal.F_ff[1] = 5.0;
  rig.controller.on_goal(goal);
  rig.run(0.3);
  const auto& s = rig.controller.status();
  for (int i = 0; i < 7; ++i) {
    const double sum = s.tau_stiffness[i] + s.tau_damping[i] + s.tau_null[i] + s.tau_gravity[i] +
                       s.tau_coriolis[i];
    EXPECT_NEAR(s.tau_sent[i], sum, 1e-4) << "joint " << i;
    EXPECT_FLOAT_EQ(s.tau_sent[i], static_cast<float>(rig.answer.tau[i]));
  }
  EXPECT_GT(s.kinetic_energy_J, 0.0);
  EXPECT_GT(s.spring_energy_J, 0.0);
  EXPECT_EQ(s.state_seq, rig.state.seq);
  EXPECT_EQ(s.states_received, rig.state.seq + 1);
}

TEST(ArmController, TimelineActsByArmTime) {
  std::vector<TimedMessage> timeline;
  const auto add = [&](std::int64_t ms, ScenarioMessage message) {
    timeline.push_back({ms * 1'000'000, std::move(message)});
  };
  mode_request_t request{};
  request.client = kScenarioClient;
  request.request = mode_request_t::REQUEST_HOLD;
  add(200, request);
  request.request = mode_request_t::REQUEST_ACTIVE;
  add(900, request);
  compliance_goal_t goal{};
  goal.client = kScenarioClient;
  goal.num_joints = 7;
  goal.kind = compliance_goal_t::GOAL_OFFSET;
  goal.offset[0] = 0.02;
  add(900, goal);  // in the very cycle that becomes active
  add(901, push_t{});
  Rig rig(arm());
  rig.controller.set_timeline(&timeline);
  for (int i = 0; i < 200; ++i) rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_IDLE);
  rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_HOLD) << "the state of 200 ms";
  for (int i = 0; i < 700; ++i) rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_ACTIVE);
  const double x = rig.controller.status().p_BT[0];
  rig.run(2.0);
  EXPECT_NEAR(rig.controller.status().p_BD[0] - x, 0.02, 1e-4);
  EXPECT_EQ(rig.controller.status().requests_refused, 0);

  rig.request(mode_request_t::REQUEST_STOP);
  rig.run(0.4);
  rig.request(mode_request_t::REQUEST_IDLE, kScenarioClient);
  rig.run(0.1);
  ++rig.state.session;  // the driver starts again, and so does the timeline
  rig.state.seq = -1;
  rig.run(0.3);
  EXPECT_EQ(rig.mode(), +Status::MODE_HOLD);
}

// The drives of a busy machine may take longer than the scenario allows for.
TEST(ArmController, ModesOfATimelineWaitForTheDrives) {
  std::vector<TimedMessage> timeline;
  mode_request_t request{};
  request.client = kScenarioClient;
  request.request = mode_request_t::REQUEST_HOLD;
  timeline.push_back({0, request});  // the controller is in INIT for 100 ms
  request.request = mode_request_t::REQUEST_ACTIVE;
  timeline.push_back({0, request});  // and the drives are not on
  compliance_goal_t goal{};
  goal.client = kScenarioClient;
  goal.num_joints = 7;
  goal.kind = compliance_goal_t::GOAL_OFFSET;
  timeline.push_back({1'000'000, goal});
  Rig rig(arm());
  rig.controller.set_timeline(&timeline);
  rig.run(0.2);
  EXPECT_EQ(rig.mode(), +Status::MODE_ACTIVE);
  EXPECT_EQ(rig.controller.status().requests_refused, 0);
}

TEST(ArmController, WhatCannotBeControlledIsRefusedAtTheStart) {
  ArmControllerOptions options;
  options.law = "no_such_law";
  EXPECT_THROW(ArmController(arm(), options), ConfigError);
  LoadedRobot bare = arm();
  bare.robot.has_drives = false;
  EXPECT_THROW(ArmController(bare, ArmControllerOptions()), ConfigError);
  LoadedRobot gains = arm();
  gains.robot.gains.K_null.pop_back();
  EXPECT_THROW(ArmController(gains, ArmControllerOptions()), ConfigError);
}

}  // namespace
}  // namespace limber::test_arm_controller
