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
