// What goes wrong around the controller, and that it stays wrong until somebody says so.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "tests/controller/rig.h"

namespace limber::test_trouble {
namespace {

using limber::testing::Rig;
using Status = controller_status_t;

// +Status::X below: message constants have no address to bind a reference to.
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
// with_drives(): what the gate lets pass in a cycle.
constexpr double kGateStep = 1.0;

LoadedRobot arm() { return limber::testing::seven_joint_arm(); }

std::string bytes_of(const joint_command_t& message) {
  std::string bytes(static_cast<std::size_t>(message.getEncodedSize()), '\0');
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

TEST(Trouble, RepeatedStatesGetTheSameAnswerAndAdvanceNothing) {
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
    {"three states missed", [](joint_state_t* s) { s->seq += 3; }, Status::REASON_STATE_LOST},
    {"a silent joint", [](joint_state_t* s) { s->age_cycles[5] = 3; }, Status::REASON_STATE_LOST},
    {"another session", [](joint_state_t* s) { s->session = 12; }, Status::REASON_SESSION_CHANGED},
    {"drives hold", [](joint_state_t* s) { s->drive_state = joint_state_t::DRIVE_HOLD; },
     Status::REASON_DRIVER_FAULT},
    {"drives off", [](joint_state_t* s) { s->drive_state = joint_state_t::DRIVE_OFF; },
     Status::REASON_DRIVER_FAULT},
    {"a speed no torque answers to", [](joint_state_t* s) { s->v[0] = 1e200; },
     Status::REASON_TORQUE_INVALID},
};

TEST(Trouble, TroubleInMotionIsLatched) {
  for (const Trouble& trouble : kTroubles) {
    SCOPED_TRACE(trouble.name);
    Rig rig(arm());
    rig.to_active();
    const VectorJ before = rig.tau();
    joint_state_t state = rig.state;
    state.seq += 1;
    state.time_ns += 1'000'000;
    trouble.cause(&state);
    if (trouble.reason == Status::REASON_SESSION_CHANGED) {
      rig.controller.step(state);
      EXPECT_EQ(rig.mode(), +Status::MODE_ACTIVE) << "one alone is passed over";
      state.seq += 1;
    }
    const joint_command_t answer = rig.controller.step(state);
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
      EXPECT_EQ(answer.request, +joint_command_t::REQUEST_HOLD);
    }
    EXPECT_NE(rig.request(mode_request_t::REQUEST_HOLD), nullptr);
    EXPECT_NE(rig.request(mode_request_t::REQUEST_ACTIVE), nullptr);
    EXPECT_NE(rig.request(mode_request_t::REQUEST_ACKNOWLEDGE), nullptr) << "too early";
  }
}

TEST(Trouble, SmallTroubleIsBridged) {
  Rig rig(arm());
  rig.to_active();
  rig.state.seq += 2;
  rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_ACTIVE);
  EXPECT_EQ(rig.controller.status().states_lost, 2);
  rig.state.age_cycles[2] = 2;
  rig.state.joint_flags[2] = 0;
  rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_ACTIVE);
}

TEST(Trouble, FaultIsLeftByAcknowledgeOnlyAndTheDrivesKeepHolding) {
  Rig rig(arm());
  rig.to_active();
  rig.controller.on_silence();
  rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_FAULT);
  EXPECT_EQ(rig.controller.status().reason, +Status::REASON_STATE_LOST);
  EXPECT_EQ(rig.answer.request, +joint_command_t::REQUEST_HOLD);
  rig.run(0.2);
  EXPECT_EQ(rig.state.drive_state, +joint_state_t::DRIVE_HOLD);
  EXPECT_EQ(rig.request(mode_request_t::REQUEST_ACKNOWLEDGE), nullptr);
  rig.run(0.2);
  EXPECT_EQ(rig.mode(), +Status::MODE_IDLE);
  EXPECT_EQ(rig.controller.status().reason, +Status::REASON_NONE);
  EXPECT_EQ(rig.answer.request, +joint_command_t::REQUEST_KEEP);
  EXPECT_EQ(rig.state.drive_state, +joint_state_t::DRIVE_HOLD);
  EXPECT_EQ(rig.request(mode_request_t::REQUEST_HOLD), nullptr);
  rig.run(1.0);
  EXPECT_EQ(rig.mode(), +Status::MODE_HOLD);
  EXPECT_EQ(rig.state.drive_state, +joint_state_t::DRIVE_ON);
}

// Where long gaps are bridged (virtual buses), the goal does not leap over them.
TEST(Trouble, GoalGoesOnAfterAGapFromWhereItWas) {
  Rig rig(arm(), "cartesian_impedance", 60);
  rig.to_active();
  compliance_goal_t goal = rig.goal();
  goal.offset[0] = -0.2;
  ASSERT_EQ(rig.controller.on_goal(goal), nullptr);
  rig.run(0.7);
  const double before = rig.controller.status().p_BD[0];
  rig.state.seq += 59;
  rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_ACTIVE);
  EXPECT_EQ(rig.controller.status().states_lost, 59);
  const double step = before - rig.controller.status().p_BD[0];
  EXPECT_GT(step, 0.5e-3);
  EXPECT_LT(step, 0.8e-3) << "three periods at a quarter of a metre per second";
  rig.state.seq += 61;
  rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_FAULT);
}

// One message with a number far ahead must not make all true ones look old.
TEST(Trouble, AForgedNumberFarAheadEndsInAFaultThatCanBeAcknowledged) {
  Rig rig(arm());
  rig.to_active();
  joint_state_t forged = rig.state;
  forged.seq += 1'000'000;
  rig.controller.step(forged);
  EXPECT_EQ(rig.mode(), +Status::MODE_FAULT);
  EXPECT_EQ(rig.controller.status().reason, +Status::REASON_STATE_INVALID);
  rig.run(0.3);
  EXPECT_LT(rig.controller.status().states_lost, 10);
  EXPECT_EQ(rig.request(mode_request_t::REQUEST_ACKNOWLEDGE), nullptr);
}

TEST(Trouble, NumbersThatGoOnFarAheadAreFollowed) {
  Rig rig(arm());
  rig.to_active();
  rig.state.seq += 5000;  // this process stood still, and its queue was full
  rig.run(0.3);
  EXPECT_EQ(rig.mode(), +Status::MODE_FAULT);
  EXPECT_EQ(rig.request(mode_request_t::REQUEST_ACKNOWLEDGE), nullptr);
}

TEST(Trouble, AfterSilenceAnyNumberIsFollowed) {
  Rig rig(arm());
  rig.to_active();
  joint_state_t forged = rig.state;
  for (std::int64_t ahead : {2000, 2001, 2002}) {  // now the true ones look old
    forged.seq = rig.state.seq + ahead;
    rig.controller.step(forged);
  }
  rig.run(0.1);
  EXPECT_EQ(rig.mode(), +Status::MODE_FAULT);
  rig.controller.on_silence();
  rig.run(0.2);
  EXPECT_EQ(rig.request(mode_request_t::REQUEST_ACKNOWLEDGE), nullptr);
}

TEST(Trouble, TheLeaseOfASilentClientEnds) {
  Rig rig(arm());
  rig.to_active();
  constexpr std::int64_t kOther = testing::kClient + 1;
  rig.run(11.0);
  EXPECT_NE(rig.request(mode_request_t::REQUEST_HOLD, kOther), nullptr) << "ACTIVE";
  EXPECT_EQ(rig.request(mode_request_t::REQUEST_HOLD), nullptr);
  rig.run(9.9);
  EXPECT_NE(rig.request(mode_request_t::REQUEST_IDLE, kOther), nullptr);
  rig.run(0.2);
  EXPECT_EQ(rig.request(mode_request_t::REQUEST_IDLE, kOther), nullptr);
  EXPECT_NE(rig.request(mode_request_t::REQUEST_HOLD), nullptr) << "it is the other's now";
}

// What the drives were sent is what the gate counts from.
TEST(Trouble, StepsAreCountedFromWhatTheDrivesWereSent) {
  Rig rig(arm());
  rig.to_active();
  ++rig.state.seq;
  rig.state.time_ns += 1'000'000;
  VectorJ sent = rig.tau();
  sent[1] += 5.0;
  for (int i = 0; i < 7; ++i) rig.state.tau_applied[i] = sent[i];
  const joint_command_t& answer = rig.controller.step(rig.state);
  for (int i = 0; i < 7; ++i) {
    EXPECT_LE(std::abs(answer.tau[i] - sent[i]), 0.8 * kGateStep + 1e-12) << "joint " << i;
  }
}

TEST(Trouble, NewSessionAtRestStartsOver) {
  Rig rig(arm());
  rig.run(0.12);
  rig.state.session = 12;
  rig.state.seq = -1;
  for (int i = 0; i < 2; ++i) rig.step();
  EXPECT_EQ(rig.mode(), +Status::MODE_INIT);
  EXPECT_EQ(rig.answer.session, 12);
  EXPECT_EQ(rig.answer.state_seq, 1);
  rig.run(0.12);
  EXPECT_EQ(rig.mode(), +Status::MODE_IDLE);
}

TEST(Trouble, DrivesThatAreOnUnderARestartedControllerAreToldToHold) {
  Rig rig(arm());
  rig.state.drive_state = joint_state_t::DRIVE_ON;
  rig.step();
  EXPECT_EQ(rig.answer.request, +joint_command_t::REQUEST_HOLD);
}

TEST(Trouble, DrivesThatDoNotComeAreAFault) {
  Rig rig(arm());
  rig.run(0.12);
  rig.request(mode_request_t::REQUEST_HOLD);
  for (int i = 0; i < 2999; ++i) {
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

}  // namespace
}  // namespace limber::test_trouble
