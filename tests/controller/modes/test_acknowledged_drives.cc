// A fault of the drives that was acknowledged, and the joint that caused a fault.
#include "tests/controller/modes/supervisor_bench.h"

namespace limber::controller::test_acknowledged_drives {
namespace {

using namespace supervisor_bench;

class AcknowledgedDrives : public SupervisorBench {
 protected:
  /// HOLD, then drives in FAULT for long enough.
  void to_fault() {
    to_hold();
    states(1 + Supervisor::kSteadyStates, State::DRIVE_FAULT);
    ASSERT_EQ(supervisor_.mode(), Mode::kFault);
  }
  /// The joint has no state.
  void silent(std::int8_t drive_state) {
    joint_state_t told = state(drive_state);
    told.joint_flags[0] = 0;
    told.age_cycles[0] = 50;
    supervisor_.on_state(told);
  }
  int asked_in(std::int8_t drive_state) {
    states(1, drive_state);
    return drive_request();
  }
};

TEST_F(AcknowledgedDrives, StartAfreshBeforeTheyAreWanted) {
  to_fault();
  EXPECT_EQ(drive_request(), +Command::REQUEST_KEEP) << "nobody has seen it yet";
  ASSERT_EQ(ask(Request::REQUEST_ACKNOWLEDGE), "");
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(drive_request(), +Command::REQUEST_ACKNOWLEDGE) << "until they do";
    states(1, State::DRIVE_FAULT);
  }
  EXPECT_EQ(asked_in(State::DRIVE_CONFIGURING), +Command::REQUEST_KEEP);
  EXPECT_EQ(asked_in(State::DRIVE_FAULT), +Command::REQUEST_KEEP) << "another fault";
}

// A drive that never enables: nobody has seen that fault yet, so nobody has acknowledged it.
TEST_F(AcknowledgedDrives, AFaultOfTheirEnablingStaysUntilThen) {
  states(Supervisor::kSteadyStates, State::DRIVE_OFF);
  ASSERT_EQ(ask(Request::REQUEST_HOLD), "");
  states(100, State::DRIVE_ENABLING);
  EXPECT_EQ(asked_in(State::DRIVE_FAULT), +Command::REQUEST_KEEP);
  EXPECT_EQ(supervisor_.mode(), Mode::kFault);
  EXPECT_EQ(supervisor_.reason(), +Reasons::REASON_DRIVER_FAULT);
  states(1000, State::DRIVE_FAULT);
  EXPECT_EQ(drive_request(), +Command::REQUEST_KEEP);
  ASSERT_EQ(ask(Request::REQUEST_ACKNOWLEDGE), "");
  EXPECT_EQ(drive_request(), +Command::REQUEST_ACKNOWLEDGE);
  states(1, State::DRIVE_CONFIGURING);
  states(Supervisor::kSteadyStates, State::DRIVE_OFF);
  ASSERT_EQ(ask(Request::REQUEST_HOLD), "");
  EXPECT_EQ(drive_request(), +Command::REQUEST_ON) << "another try";
}

// Whoever requests HOLD at once waits for a start-up in which no joint has a state.
TEST_F(AcknowledgedDrives, MayRepeatTheirStartUpInHold) {
  to_fault();
  ASSERT_EQ(ask(Request::REQUEST_ACKNOWLEDGE), "");
  ASSERT_EQ(ask(Request::REQUEST_HOLD), "");
  for (int i = 1; i <= 50; ++i) {  // the first state of OFF has nothing new either
    joint_state_t starting = state(i < 50 ? State::DRIVE_CONFIGURING : State::DRIVE_OFF);
    starting.joint_flags[0] = 0;
    starting.age_cycles[0] = i;
    supervisor_.on_state(starting);
    ASSERT_EQ(supervisor_.mode(), Mode::kHold) << i;
  }
  EXPECT_EQ(asked_in(State::DRIVE_OFF), +Command::REQUEST_ON);
  silent(State::DRIVE_OFF);
  EXPECT_EQ(supervisor_.mode(), Mode::kFault) << "no start-up, no excuse";
}

// What a start-up excuses is joints that have no state yet: not states that are missing, nor joints
// that are silent when the drives are to follow.
TEST_F(AcknowledgedDrives, AreExcusedForTheirStartUpOnly) {
  for (const std::int8_t after : {State::DRIVE_ENABLING, State::DRIVE_ON}) {
    supervisor_ = Supervisor(1, 2);
    seq_ = -1;
    to_fault();
    ASSERT_EQ(ask(Request::REQUEST_ACKNOWLEDGE), "");
    ASSERT_EQ(ask(Request::REQUEST_HOLD), "");
    silent(State::DRIVE_CONFIGURING);
    ASSERT_EQ(supervisor_.mode(), Mode::kHold);
    silent(after);
    EXPECT_EQ(supervisor_.mode(), Mode::kFault) << int{after};
    EXPECT_EQ(supervisor_.reason(), +Reasons::REASON_STATE_LOST);
  }
}

TEST_F(AcknowledgedDrives, StatesThatAreMissingInTheirStartUpAreNotExcused) {
  to_fault();
  ASSERT_EQ(ask(Request::REQUEST_ACKNOWLEDGE), "");
  ASSERT_EQ(ask(Request::REQUEST_HOLD), "");
  silent(State::DRIVE_CONFIGURING);
  seq_ += 3;
  silent(State::DRIVE_CONFIGURING);
  EXPECT_EQ(supervisor_.mode(), Mode::kFault);
  EXPECT_EQ(supervisor_.reason(), +Reasons::REASON_STATE_LOST);
}

TEST_F(AcknowledgedDrives, InIdleTheirStartUpIsWaitedForInInit) {
  to_fault();
  ASSERT_EQ(ask(Request::REQUEST_ACKNOWLEDGE), "");
  ASSERT_EQ(supervisor_.mode(), Mode::kIdle);
  silent(State::DRIVE_CONFIGURING);
  EXPECT_EQ(supervisor_.mode(), Mode::kInit);
}

TEST_F(AcknowledgedDrives, HoldingOnesAreLeftToHold) {
  to_hold();
  states(1 + Supervisor::kSteadyStates, State::DRIVE_HOLD);
  ASSERT_EQ(ask(Request::REQUEST_ACKNOWLEDGE), "");
  EXPECT_EQ(drive_request(), +Command::REQUEST_KEEP);
  EXPECT_EQ(asked_in(State::DRIVE_HOLD), +Command::REQUEST_KEEP);
  EXPECT_EQ(asked_in(State::DRIVE_FAULT), +Command::REQUEST_KEEP) << "this fault is another one";
}

TEST_F(AcknowledgedDrives, OnlyAnAcknowledgementAcknowledges) {
  states(100, State::DRIVE_FAULT);
  ASSERT_EQ(ask(Request::REQUEST_IDLE), "");
  EXPECT_EQ(asked_in(State::DRIVE_FAULT), +Command::REQUEST_KEEP);
}

TEST_F(AcknowledgedDrives, AnotherModeThanIdleDoesNotAskForIt) {
  to_fault();
  ASSERT_EQ(ask(Request::REQUEST_ACKNOWLEDGE), "");
  seq_ += 3;  // three states are missed: INIT
  states(1, State::DRIVE_FAULT);
  ASSERT_EQ(supervisor_.mode(), Mode::kInit);
  EXPECT_EQ(drive_request(), +Command::REQUEST_KEEP);
}

TEST_F(AcknowledgedDrives, TheJointAtFaultIsKnownUntilThen) {
  EXPECT_EQ(supervisor_.reason_joint(), -1);
  to_hold();
  EXPECT_FALSE(supervisor_.raise(Event::kAtRest, 2)) << "nothing rests in HOLD";
  EXPECT_EQ(supervisor_.reason_joint(), -1);
  EXPECT_TRUE(supervisor_.raise(Event::kStrayed, 3));
  EXPECT_EQ(supervisor_.reason(), +Reasons::REASON_STRAYED);
  EXPECT_EQ(supervisor_.reason_joint(), 3);
  states(Supervisor::kSteadyStates, State::DRIVE_HOLD);
  EXPECT_TRUE(supervisor_.raise(Event::kEstopPressed, 1));
  EXPECT_EQ(supervisor_.reason(), +Reasons::REASON_STRAYED) << "the mode tells of the stop itself";
  EXPECT_EQ(supervisor_.reason_joint(), 3);
  ASSERT_EQ(ask(Request::REQUEST_ACKNOWLEDGE), "");
  EXPECT_EQ(supervisor_.reason(), +Reasons::REASON_NONE);
  EXPECT_EQ(supervisor_.reason_joint(), -1);
}

}  // namespace
}  // namespace limber::controller::test_acknowledged_drives
