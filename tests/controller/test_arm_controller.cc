// The whole controller at a perfect driver: start, switches, faults, and what is never allowed to
// happen to the torque.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "common/config_error.h"
#include "controller/laws/registry.h"
#include "tests/controller/rig.h"
#include "tests/support/allocation_counter.h"

namespace limber {
namespace {

using limber::testing::kClient;
using limber::testing::Rig;
using Status = controller_status_t;

// +Status::X below: message constants have no address to bind a reference to.
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
// with_drives(): what the gate lets pass in a cycle.
constexpr double kGateStep = 1.0;
// Limits that would hide a jump of the law.
constexpr int kClamped = int{Status::LIMIT_RATE} | int{Status::LIMIT_TORQUE};

LoadedRobot arm() { return limber::testing::seven_joint_arm(); }

std::string bytes_of(const joint_torque_t& message) {
  std::string bytes(static_cast<std::size_t>(message.getEncodedSize()), '\0');
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

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

TEST(ArmController, HoldStartsFromTheTorquePresentAndKeepsTheArm) {
  Rig rig(arm());
  rig.run(0.12);
  ASSERT_EQ(rig.ask(mode_request_t::REQUEST_HOLD), nullptr);
  rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_HOLD);
  EXPECT_EQ(rig.answer.request, +joint_torque_t::REQUEST_ON);
  EXPECT_EQ(rig.tau().norm(), 0.0) << "drives not on yet";
  const VectorJ q = rig.plant.q;
  rig.step();
  EXPECT_EQ(rig.answer.request, +joint_torque_t::REQUEST_KEEP);
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
  rig.ask(mode_request_t::REQUEST_HOLD);
  // The driver says what its drives apply until the take-over is complete.
  ++rig.state.seq;
  for (int i = 0; i < 7; ++i) rig.state.tau_applied[i] = 0.5 * i;
  rig.state.time_ns = rig.state.seq * rig.state.period_ns;
  rig.answer = rig.controller.step(rig.state);
  EXPECT_EQ(rig.answer.request, +joint_torque_t::REQUEST_ACKNOWLEDGE);
  for (int i = 0; i < 7; ++i) EXPECT_EQ(rig.answer.tau[i], 0.5 * i);
  rig.state.drive_state = joint_state_t::DRIVE_ON;
  ++rig.state.seq;
  rig.answer = rig.controller.step(rig.state);
  for (int i = 0; i < 7; ++i) EXPECT_NEAR(rig.answer.tau[i], 0.5 * i, 1e-9);
}

TEST(ArmController, DrivesThatDoNotComeAreAFault) {
  Rig rig(arm());
  rig.run(0.12);
  rig.ask(mode_request_t::REQUEST_HOLD);
  for (int i = 0; i < 1999; ++i) {
    rig.step();
    rig.state.drive_state = joint_state_t::DRIVE_ENABLING;
  }
  EXPECT_EQ(rig.mode(), +Status::MODE_HOLD);
  for (int i = 0; i < 3; ++i) {
    rig.step();
    rig.state.drive_state = joint_state_t::DRIVE_ENABLING;
  }
  EXPECT_EQ(rig.mode(), +Status::MODE_FAULT);
  EXPECT_EQ(rig.controller.status().reason, +Status::REASON_DRIVE_NOT_ON);
}

TEST(ArmController, ActiveStartsWhereTheArmIs) {
  Rig rig(arm());
  rig.to_hold();
  rig.plant.F_ext << 5.0, 3.0, -4.0, 0.1, 0.2, 0.0;  // leaning on something
  rig.run(1.0);
  rig.clear_jumps();
  const VectorJ before = rig.tau();
  ASSERT_EQ(rig.ask(mode_request_t::REQUEST_ACTIVE), nullptr);
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

TEST(ArmController, RequestsAreRefusedInTheWrongMode) {
  Rig rig(arm());
  rig.run(0.12);
  EXPECT_NE(rig.ask(mode_request_t::REQUEST_ACTIVE), nullptr);
  EXPECT_NE(rig.ask(mode_request_t::REQUEST_ACKNOWLEDGE), nullptr);
  EXPECT_NE(rig.ask(99), nullptr);
  EXPECT_NE(rig.controller.on_goal(rig.goal()), nullptr);
  rig.ask(mode_request_t::REQUEST_HOLD);
  EXPECT_NE(rig.ask(mode_request_t::REQUEST_ACTIVE), nullptr) << "drives are not on yet";
  rig.step();
  EXPECT_EQ(rig.controller.status().requests_refused, 5);
  EXPECT_EQ(rig.mode(), +Status::MODE_HOLD);
}

TEST(ArmController, IdleRequestTurnsTheDrivesOffInStepsTheGatePasses) {
  Rig rig(arm());
  rig.to_hold();
  rig.clear_jumps();
  ASSERT_EQ(rig.ask(mode_request_t::REQUEST_IDLE), nullptr);
  rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_IDLE);
  EXPECT_EQ(rig.answer.request, +joint_torque_t::REQUEST_OFF);
  EXPECT_LE(rig.jump(), 0.8 * kGateStep + 1e-12);
  rig.step();
  EXPECT_EQ(rig.answer.request, +joint_torque_t::REQUEST_KEEP);
  EXPECT_EQ(rig.tau().norm(), 0.0);
}

TEST(ArmController, SoftStopEndsInHold) {
  Rig rig(arm());
  rig.to_active();
  compliance_goal_t goal = rig.goal();
  goal.offset[0] = 0.2;
  ASSERT_EQ(rig.controller.on_goal(goal), nullptr);
  rig.run(0.6);
  const double moving = Eigen::Map<const Vector6>(rig.controller.status().V_BT).head<3>().norm();
  EXPECT_GT(moving, 0.1);
  ASSERT_EQ(rig.ask(mode_request_t::REQUEST_STOP, kClient + 1), nullptr) << "from anybody";
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

TEST(ArmController, LeaseKeepsOthersOut) {
  Rig rig(arm());
  rig.run(0.12);
  EXPECT_NE(rig.ask(mode_request_t::REQUEST_HOLD, 0), nullptr);
  EXPECT_NE(rig.ask(mode_request_t::REQUEST_ACTIVE, 5), nullptr);
  EXPECT_EQ(rig.ask(mode_request_t::REQUEST_HOLD, kClient), nullptr)
      << "a request that was refused took no lease";
  EXPECT_NE(rig.ask(mode_request_t::REQUEST_IDLE, 5), nullptr);
  compliance_gains_t gains = rig.gains();
  gains.client = 5;
  EXPECT_NE(rig.controller.on_gains(gains), nullptr);
  EXPECT_NE(rig.ask(mode_request_t::REQUEST_RELEASE, 5), nullptr);
  EXPECT_EQ(rig.ask(mode_request_t::REQUEST_RELEASE, kClient), nullptr);
  EXPECT_EQ(rig.controller.on_gains(gains), nullptr);
  EXPECT_NE(rig.ask(mode_request_t::REQUEST_IDLE, kClient), nullptr);
}

TEST(ArmController, RepeatedStatesGetTheSameAnswerAndAdvanceNothing) {
  Rig a(arm());
  Rig b(arm());
  for (Rig* rig : {&a, &b}) {
    rig->to_active();
    compliance_goal_t goal = rig->goal();
    goal.offset[1] = 0.1;
    rig->controller.on_goal(goal);
  }
  for (int i = 0; i < 300; ++i) {
    const std::string answer = bytes_of(a.step());
    for (int k = 0; k < 3; ++k) EXPECT_EQ(bytes_of(a.controller.step(a.state)), answer);
    joint_state_t old = a.state;
    old.seq -= 2;
    EXPECT_EQ(bytes_of(a.controller.step(old)), answer) << "an old state is no news either";
    ASSERT_EQ(bytes_of(b.step()), answer);
  }
}

struct Trouble {
  const char* name;
  void (*cause)(joint_state_t*);
  int reason;
};
const Trouble kTroubles[] = {
    {"NaN position", [](joint_state_t* s) { s->q[2] = kNaN; }, Status::REASON_STATE_INVALID},
    {"infinite velocity", [](joint_state_t* s) { s->v[0] = INFINITY; },
     Status::REASON_STATE_INVALID},
    {"NaN motor side", [](joint_state_t* s) { s->theta[6] = kNaN; }, Status::REASON_STATE_INVALID},
    {"NaN torque", [](joint_state_t* s) { s->tau_applied[1] = kNaN; },
     Status::REASON_STATE_INVALID},
    {"another arm's joint count", [](joint_state_t* s) { s->num_joints = 6; },
     Status::REASON_STATE_INVALID},
    {"no joints", [](joint_state_t* s) { s->num_joints = 0; }, Status::REASON_STATE_INVALID},
    {"negative joint count", [](joint_state_t* s) { s->num_joints = -7; },
     Status::REASON_STATE_INVALID},
    {"no period", [](joint_state_t* s) { s->period_ns = 0; }, Status::REASON_STATE_INVALID},
    {"session 0", [](joint_state_t* s) { s->session = 0; }, Status::REASON_STATE_INVALID},
    {"unknown drive state", [](joint_state_t* s) { s->drive_state = 42; },
     Status::REASON_STATE_INVALID},
    {"four states missed", [](joint_state_t* s) { s->seq += 4; }, Status::REASON_STATE_LOST},
    {"a silent joint", [](joint_state_t* s) { s->age_cycles[5] = 3; }, Status::REASON_STATE_LOST},
    {"another session", [](joint_state_t* s) { s->session = 12; }, Status::REASON_SESSION_CHANGED},
    {"drives hold", [](joint_state_t* s) { s->drive_state = joint_state_t::DRIVE_HOLD; },
     Status::REASON_DRIVER_FAULT},
    {"drives off", [](joint_state_t* s) { s->drive_state = joint_state_t::DRIVE_OFF; },
     Status::REASON_DRIVER_FAULT},
    {"a speed no torque answers to", [](joint_state_t* s) { s->v[0] = 1e200; },
     Status::REASON_TORQUE_INVALID},
};

TEST(ArmController, TroubleInMotionIsLatched) {
  for (const Trouble& trouble : kTroubles) {
    SCOPED_TRACE(trouble.name);
    Rig rig(arm());
    rig.to_active();
    const VectorJ before = rig.tau();
    joint_state_t state = rig.state;
    state.seq += 1;
    state.time_ns += 1'000'000;
    trouble.cause(&state);
    const joint_torque_t answer = rig.controller.step(state);
    EXPECT_EQ(rig.mode(), +Status::MODE_FAULT);
    EXPECT_EQ(rig.controller.status().reason, trouble.reason);
    EXPECT_EQ(answer.num_joints, 7);
    for (int i = 0; i < 7; ++i) {
      EXPECT_TRUE(std::isfinite(answer.tau[i]) && std::isfinite(answer.tau_gravity[i]));
      EXPECT_LE(std::abs(answer.tau[i]), 60.0);
      EXPECT_NEAR(answer.tau_gravity[i], rig.plant.terms.g[i], 0.5) << "the last good one";
      if (state.drive_state == joint_state_t::DRIVE_ON) {
        EXPECT_LE(std::abs(answer.tau[i] - before[i]), 0.8 * kGateStep + 1e-12);
      }
    }
    if (state.drive_state == joint_state_t::DRIVE_ON || state.drive_state == 42) {
      EXPECT_EQ(answer.request, +joint_torque_t::REQUEST_HOLD);
    }
    EXPECT_NE(rig.ask(mode_request_t::REQUEST_HOLD), nullptr);
    EXPECT_NE(rig.ask(mode_request_t::REQUEST_ACTIVE), nullptr);
    EXPECT_NE(rig.ask(mode_request_t::REQUEST_ACKNOWLEDGE), nullptr) << "too early";
  }
}

TEST(ArmController, SmallTroubleIsBridged) {
  Rig rig(arm());
  rig.to_active();
  rig.state.seq += 3;
  rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_ACTIVE);
  EXPECT_EQ(rig.controller.status().states_lost, 3);
  rig.state.age_cycles[2] = 2;
  rig.state.joint_flags[2] = 0;
  rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_ACTIVE);
}

TEST(ArmController, FaultIsLeftByAcknowledgeOnlyAndTheDrivesKeepHolding) {
  Rig rig(arm());
  rig.to_active();
  rig.controller.on_silence();
  rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_FAULT);
  EXPECT_EQ(rig.controller.status().reason, +Status::REASON_STATE_LOST);
  EXPECT_EQ(rig.answer.request, +joint_torque_t::REQUEST_HOLD);
  rig.run(0.2);
  EXPECT_EQ(rig.state.drive_state, +joint_state_t::DRIVE_HOLD);
  EXPECT_EQ(rig.ask(mode_request_t::REQUEST_ACKNOWLEDGE), nullptr);
  rig.run(0.2);
  EXPECT_EQ(rig.mode(), +Status::MODE_IDLE);
  EXPECT_EQ(rig.controller.status().reason, +Status::REASON_NONE);
  EXPECT_EQ(rig.answer.request, +joint_torque_t::REQUEST_KEEP);
  EXPECT_EQ(rig.state.drive_state, +joint_state_t::DRIVE_HOLD);
  EXPECT_EQ(rig.ask(mode_request_t::REQUEST_HOLD), nullptr);
  rig.run(1.0);
  EXPECT_EQ(rig.mode(), +Status::MODE_HOLD);
  EXPECT_EQ(rig.state.drive_state, +joint_state_t::DRIVE_ON);
}

TEST(ArmController, NewSessionAtRestStartsOver) {
  Rig rig(arm());
  rig.run(0.12);
  rig.state.session = 12;
  rig.state.seq = -1;
  rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_INIT);
  EXPECT_EQ(rig.answer.session, 12);
  EXPECT_EQ(rig.answer.state_seq, 0);
  rig.run(0.12);
  EXPECT_EQ(rig.mode(), +Status::MODE_IDLE);
}

TEST(ArmController, DrivesThatAreOnUnderARestartedControllerAreToldToHold) {
  Rig rig(arm());
  rig.state.drive_state = joint_state_t::DRIVE_ON;
  rig.step();
  EXPECT_EQ(rig.answer.request, +joint_torque_t::REQUEST_HOLD);
}

// Which limits act is on record, so a jump hidden by the rate limiter would be seen.
TEST(ArmController, SwitchingLawsNeverJumps) {
  const auto names = law_names();
  for (const std::string& from : names) {
    for (const std::string& to : names) {
      SCOPED_TRACE(from + " -> " + to);
      Rig rig(arm(), from);
      rig.to_active();
      rig.plant.F_ext << 6.0, -4.0, 3.0, 0.2, 0.0, 0.1;  // a short push: the arm moves
      rig.run(0.05);
      rig.plant.F_ext.setZero();
      rig.clear_jumps();
      compliance_gains_t gains = rig.gains();
      gains.law = to;
      ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
      const VectorJ before = rig.tau();
      rig.step();
      EXPECT_LT((rig.tau() - before).cwiseAbs().maxCoeff(), 0.1 * kGateStep);
      rig.run(0.7);
      EXPECT_EQ(rig.mode(), +Status::MODE_ACTIVE);
      EXPECT_EQ(rig.limits() & kClamped, 0);
      EXPECT_EQ(rig.controller.status().law, controller::find_law(to));
    }
  }
}

TEST(ArmController, GainsAndGoalsNeverJump) {
  Rig rig(arm());
  rig.to_active();
  rig.plant.F_ext << 10.0, 5.0, -5.0, 0.3, 0.2, 0.1;
  rig.run(0.5);
  rig.clear_jumps();
  const auto changed = [&](const char* what) {
    const VectorJ before = rig.tau();
    rig.step();
    EXPECT_LT((rig.tau() - before).cwiseAbs().maxCoeff(), 0.05 * kGateStep) << what;
    rig.run(0.4);
  };
  compliance_gains_t gains = rig.gains();
  gains.ramp_s = 0.3;
  for (int i = 0; i < 3; ++i) gains.K_x[i][i] = 3000.0;
  ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
  changed("stiffer");
  for (int i = 3; i < 6; ++i) gains.K_x[i][i] = 0.0;
  ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
  changed("rotation free");
  rig.run(0.2);
  gains.orientation = compliance_gains_t::ORIENTATION_QUAT;
  for (int i = 3; i < 6; ++i) gains.K_x[i][i] = 20.0;
  ASSERT_EQ(rig.controller.on_gains(gains), nullptr);
  changed("other orientation error");
  compliance_goal_t goal = rig.goal();
  goal.offset[2] = -0.05;
  goal.F_ff[0] = 20.0;
  ASSERT_EQ(rig.controller.on_goal(goal), nullptr);
  changed("goal");
  goal.offset[4] = 0.3;
  ASSERT_EQ(rig.controller.on_goal(goal), nullptr);
  changed("goal while moving");
  goal.kind = compliance_goal_t::GOAL_WRENCH;
  goal.F_ff[0] = 0.0;
  ASSERT_EQ(rig.controller.on_goal(goal), nullptr);
  changed("wrench");
  rig.run(3.0);
  EXPECT_EQ(rig.limits() & kClamped, 0);
  EXPECT_EQ(rig.mode(), +Status::MODE_ACTIVE);
}

TEST(ArmController, WrongGainsAreRefusedWhole) {
  Rig rig(arm());
  rig.to_active();
  struct Case {
    const char* name;
    void (*spoil)(compliance_gains_t*);
  };
  const Case cases[] = {
      {"unknown law", [](compliance_gains_t* g) { g->law = "wishful_thinking"; }},
      {"joint count", [](compliance_gains_t* g) { g->num_joints = 6; }},
      {"orientation", [](compliance_gains_t* g) { g->orientation = 2; }},
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

TEST(ArmController, WrongGoalsAreRefusedWhole) {
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
  gains.law = "joint_impedance";
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
}

// Whatever comes in, what goes out is finite, within the limits and no step larger than the gate
// allows.
TEST(ArmController, TorqueIsBoundedUnderRandomInput) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> chance(0.0, 1.0);
    Rig rig(limber::testing::random_arm(1 + static_cast<int>(seed) % 7, seed, true));
    rig.to_active();
    const int n = rig.state.num_joints;
    VectorJ before = rig.tau();
    for (int i = 0; i < 400; ++i) {
      ++rig.state.seq;
      rig.state.time_ns += 1'000'000;
      const double size = std::pow(10.0, 8.0 * chance(generator) - 6.0);
      for (int k = 0; k < n; ++k) {
        rig.state.q[k] += size * (chance(generator) - 0.5);
        rig.state.v[k] = size * (chance(generator) - 0.5);
        rig.state.tau_applied[k] = before[k];
        if (chance(generator) < 1e-3) rig.state.v[k] = kNaN;
      }
      if (chance(generator) < 0.05) {
        compliance_goal_t goal = rig.goal();
        for (double& x : goal.offset) x = chance(generator) - 0.5;
        rig.controller.on_goal(goal);
      }
      if (chance(generator) < 0.05) {
        compliance_gains_t gains = rig.gains();
        for (int k = 0; k < 6; ++k) gains.K_x[k][k] = 1e4 * chance(generator);
        rig.controller.on_gains(gains);
      }
      const joint_torque_t& answer = rig.controller.step(rig.state);
      for (int k = 0; k < n; ++k) {
        ASSERT_LE(std::abs(answer.tau[k]), 60.0);
        ASSERT_LE(std::abs(answer.tau_gravity[k]), 60.0);
        ASSERT_LE(std::abs(answer.tau[k] - before[k]), 0.8 * kGateStep + 1e-12);
        before[k] = answer.tau[k];
      }
    }
  }
}

TEST(ArmController, NothingInTheCycleAllocates) {
  for (const std::string& law : law_names()) {
    for (const int n : {1, 2, 7, 16}) {
      SCOPED_TRACE(law + ", joints: " + std::to_string(n));
      Rig rig(limber::testing::random_arm(n, 5, true), law);
      const std::vector<TimedMessage> timeline{{1'400'000'000, push_t{}}};
      rig.controller.set_timeline(&timeline);
      compliance_gains_t gains = rig.gains();
      compliance_goal_t goal = rig.goal();
      goal.offset[0] = 0.01;
      const auto before = limber::testing::allocations();
      rig.run(0.12);
      rig.ask(mode_request_t::REQUEST_HOLD);
      rig.run(0.6);
      rig.ask(mode_request_t::REQUEST_ACTIVE);
      rig.run(0.6);
      gains.orientation = compliance_gains_t::ORIENTATION_QUAT;
      rig.controller.on_gains(gains);
      rig.controller.on_goal(goal);
      rig.run(0.2);
      rig.ask(mode_request_t::REQUEST_STOP);
      rig.run(0.4);
      rig.controller.on_silence();
      rig.run(0.1);
      EXPECT_EQ(limber::testing::allocations(), before);
    }
  }
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
}  // namespace limber
