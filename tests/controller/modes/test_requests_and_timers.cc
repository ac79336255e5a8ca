// Who may ask the supervisor for what, and when: the lease, the timers, steadiness.
#include <gtest/gtest.h>

#include "tests/controller/modes/supervisor_bench.h"

namespace limber::controller::test_requests_and_timers {
namespace {

using namespace supervisor_bench;

class RequestsAndTimers : public SupervisorBench {};

TEST_F(RequestsAndTimers, BeforeTheFirstState) {
  EXPECT_EQ(supervisor_.mode(), Mode::kBoot);
  EXPECT_EQ(supervisor_.reason(), +Reasons::REASON_NONE);
  EXPECT_FALSE(supervisor_.engaged() || supervisor_.drives_on() || supervisor_.drives_carry());
  EXPECT_FALSE(supervisor_.drives_hold());
  EXPECT_EQ(drive_request(), +Command::REQUEST_KEEP);
  EXPECT_EQ(supervisor_.check_client(kMine), nullptr);
}

TEST_F(RequestsAndTimers, AHundredGoodStatesInARow) {
  states(99, State::DRIVE_OFF);
  EXPECT_EQ(supervisor_.mode(), Mode::kInit);
  joint_state_t tired = state(State::DRIVE_OFF);
  tired.joint_flags[0] = 0;
  supervisor_.on_state(tired);
  states(99, State::DRIVE_OFF);
  EXPECT_EQ(supervisor_.mode(), Mode::kInit) << "counted afresh after a joint that was not fresh";
  ++seq_;
  states(100, State::DRIVE_OFF);
  EXPECT_EQ(supervisor_.mode(), Mode::kInit) << "the one after the gap is not one of them";
  joint_state_t bad = state(State::DRIVE_OFF);
  bad.num_joints = 2;
  supervisor_.on_state(bad);
  states(99, State::DRIVE_OFF);
  EXPECT_EQ(supervisor_.mode(), Mode::kInit) << "counted afresh after an unusable one";
  states(1, State::DRIVE_OFF);
  EXPECT_EQ(supervisor_.mode(), Mode::kIdle);
  states(100, State::DRIVE_OFF);
  ++session_;
  states(1, State::DRIVE_OFF);
  EXPECT_EQ(supervisor_.mode(), Mode::kIdle) << "one alone is passed over";
  states(99, State::DRIVE_OFF);
  EXPECT_EQ(supervisor_.mode(), Mode::kInit) << "counted afresh in a new session";
  states(1, State::DRIVE_OFF);
  EXPECT_EQ(supervisor_.mode(), Mode::kIdle);
}

TEST_F(RequestsAndTimers, AfterALongSilenceTheNumbersMayBeginAgain) {
  states(50, State::DRIVE_OFF);
  seq_ = -1;
  states(1, State::DRIVE_ON);
  EXPECT_FALSE(supervisor_.drives_on()) << "an old number";
  seq_ = -1;
  supervisor_.forget_sequence();
  states(1, State::DRIVE_ON);
  EXPECT_TRUE(supervisor_.drives_on());
}

TEST_F(RequestsAndTimers, ARepeatedStateChangesNothing) {
  states(1, State::DRIVE_OFF);
  joint_state_t again = state(State::DRIVE_OFF);
  supervisor_.on_state(again);
  again.drive_state = State::DRIVE_ON;
  EXPECT_TRUE(supervisor_.on_state(again).repeated);
  EXPECT_FALSE(supervisor_.drives_on());
}

TEST_F(RequestsAndTimers, WhoAskedFirstHoldsTheLeaseUntilItGivesItBack) {
  states(100, State::DRIVE_OFF);
  EXPECT_EQ(ask(Request::REQUEST_IDLE, 0), "client must not be 0");
  EXPECT_EQ(ask(Request::REQUEST_ACTIVE), "ACTIVE is entered from HOLD, drives on");
  EXPECT_EQ(supervisor_.check_client(kOther), nullptr) << "a refused request takes no lease";
  EXPECT_EQ(ask(Request::REQUEST_IDLE), "");
  EXPECT_EQ(supervisor_.check_client(kMine), nullptr);
  EXPECT_NE(supervisor_.check_client(kOther), nullptr);
  EXPECT_TRUE(ask(Request::REQUEST_HOLD, kOther).starts_with("another client holds the lease"));
  EXPECT_EQ(supervisor_.mode(), Mode::kIdle);
  EXPECT_EQ(ask(Request::REQUEST_RELEASE, kOther), "the lease is not this client's");
  EXPECT_EQ(ask(Request::REQUEST_RELEASE), "");
  EXPECT_EQ(supervisor_.check_client(kOther), nullptr);
  EXPECT_EQ(ask(Request::REQUEST_RELEASE, 0), "the lease is not this client's");
  EXPECT_EQ(ask(Request::REQUEST_RELEASE), "the lease is not this client's") << "given back";
}

TEST_F(RequestsAndTimers, EverybodyMayStop) {
  to_hold();
  ASSERT_EQ(ask(Request::REQUEST_ACTIVE), "");
  EXPECT_TRUE(supervisor_.powered_mode());
  EXPECT_EQ(drive_request(), +Command::REQUEST_KEEP);
  EXPECT_EQ(ask(Request::REQUEST_STOP, kOther), "");
  EXPECT_EQ(supervisor_.mode(), Mode::kSoftStop);
  EXPECT_EQ(supervisor_.reason(), +Reasons::REASON_STOP_REQUESTED);
  EXPECT_NE(supervisor_.check_client(kOther), nullptr) << "and gets no lease by it";
  const std::int64_t rest_seq = seq_ + kSoftStop_ns / kPeriod_ns;
  states(rest_seq - 1 - seq_, State::DRIVE_ON);
  late_ns_ = -1;
  states(1, State::DRIVE_ON);
  EXPECT_EQ(supervisor_.mode(), Mode::kSoftStop) << "1 ns before its end";
  late_ns_ = 0;
  states(1, State::DRIVE_ON);
  EXPECT_EQ(supervisor_.mode(), Mode::kHold);
  EXPECT_EQ(supervisor_.reason(), +Reasons::REASON_STOP_REQUESTED) << "why it came to rest";
}

// What may have been wrong matters for an acknowledgement alone.
TEST_F(RequestsAndTimers, OneMissingAnswerDelaysNoRequest) {
  states(100, State::DRIVE_OFF);
  joint_state_t tired = state(State::DRIVE_OFF);
  tired.joint_flags[0] = 0;
  supervisor_.on_state(tired);
  EXPECT_EQ(ask(Request::REQUEST_HOLD), "");
}

TEST_F(RequestsAndTimers, WhoAskedForIdleAndThenForHoldWantsTheDrives) {
  states(100, State::DRIVE_OFF);
  ASSERT_EQ(ask(Request::REQUEST_IDLE), "");
  ASSERT_EQ(ask(Request::REQUEST_HOLD), "");
  states(1, State::DRIVE_ON);
  EXPECT_TRUE(supervisor_.drives_carry());
}

TEST_F(RequestsAndTimers, AnUnknownRequestIsToldSo) {
  states(100, State::DRIVE_OFF);
  for (int what : {-1, 6, 127}) {
    EXPECT_EQ(ask(static_cast<std::int8_t>(what)),
              "the request is none of idle, hold, active, stop, acknowledge, release");
  }
  EXPECT_EQ(supervisor_.check_client(kOther), nullptr);
}

TEST_F(RequestsAndTimers, TooEarlyIsAnotherThingThanRefused) {
  const auto not_yet = [this](std::int8_t what) { return supervisor_.not_yet(made(what)); };
  EXPECT_TRUE(not_yet(Request::REQUEST_HOLD)) << "BOOT";
  EXPECT_FALSE(not_yet(Request::REQUEST_ACTIVE)) << "BOOT";
  states(1, State::DRIVE_OFF);
  EXPECT_TRUE(not_yet(Request::REQUEST_HOLD)) << "INIT";
  states(100, State::DRIVE_OFF);
  EXPECT_FALSE(not_yet(Request::REQUEST_HOLD)) << "IDLE";
  EXPECT_FALSE(not_yet(Request::REQUEST_ACTIVE)) << "IDLE";
  ask(Request::REQUEST_HOLD);
  EXPECT_TRUE(not_yet(Request::REQUEST_ACTIVE)) << "HOLD, drives off";
  EXPECT_FALSE(not_yet(Request::REQUEST_IDLE));
  EXPECT_FALSE(not_yet(Request::REQUEST_HOLD));
  states(1, State::DRIVE_ON);
  EXPECT_FALSE(not_yet(Request::REQUEST_ACTIVE)) << "HOLD, drives on";
}

// Asked for at time t: 3 s later the drives may still come, a cycle after that it is a fault.
TEST_F(RequestsAndTimers, DrivesHaveThreeSeconds) {
  states(100, State::DRIVE_OFF);
  ASSERT_EQ(ask(Request::REQUEST_HOLD), "");
  states(3000, State::DRIVE_ENABLING);
  EXPECT_EQ(supervisor_.mode(), Mode::kHold);
  EXPECT_FALSE(supervisor_.engaged());
  late_ns_ = 1 - kPeriod_ns;
  states(1, State::DRIVE_ENABLING);
  EXPECT_EQ(supervisor_.mode(), Mode::kFault);
  EXPECT_EQ(supervisor_.reason(), +Reasons::REASON_DRIVE_NOT_ON);
}

TEST_F(RequestsAndTimers, DrivesThatComeLateAreWelcomeWhileNobodyHasGivenUp) {
  states(100, State::DRIVE_OFF);
  ASSERT_EQ(ask(Request::REQUEST_HOLD), "");
  states(3000, State::DRIVE_ENABLING);
  states(2, State::DRIVE_ON);
  EXPECT_TRUE(supervisor_.engaged());
  EXPECT_EQ(supervisor_.mode(), Mode::kHold);
}

TEST_F(RequestsAndTimers, DrivesThatStopFollowingAreAFault) {
  to_hold();
  EXPECT_TRUE(supervisor_.drives_on() && supervisor_.drives_carry());
  EXPECT_FALSE(supervisor_.drives_hold());
  states(1, State::DRIVE_OFF);
  EXPECT_EQ(supervisor_.mode(), Mode::kFault);
  EXPECT_EQ(supervisor_.reason(), +Reasons::REASON_DRIVER_FAULT);
  EXPECT_FALSE(supervisor_.engaged());
}

TEST_F(RequestsAndTimers, AFaultIsAcknowledgedAfterAHundredGoodStates) {
  to_hold();
  states(1, State::DRIVE_HOLD);
  ASSERT_EQ(supervisor_.mode(), Mode::kFault);
  EXPECT_TRUE(supervisor_.drives_hold());
  states(99, State::DRIVE_HOLD);
  EXPECT_EQ(ask(Request::REQUEST_ACKNOWLEDGE),
            "the cause is not gone: the states are not steady yet");
  joint_state_t bad = state(State::DRIVE_HOLD);
  bad.num_joints = 2;
  supervisor_.on_state(bad);
  states(99, State::DRIVE_HOLD);
  EXPECT_EQ(ask(Request::REQUEST_ACKNOWLEDGE),
            "the cause is not gone: the states are not steady yet");
  states(1, State::DRIVE_HOLD);
  EXPECT_EQ(supervisor_.reason(), +Reasons::REASON_DRIVER_FAULT);
  EXPECT_EQ(ask(Request::REQUEST_ACKNOWLEDGE), "");
  EXPECT_EQ(supervisor_.mode(), Mode::kIdle);
  EXPECT_EQ(supervisor_.reason(), +Reasons::REASON_NONE);
}

TEST_F(RequestsAndTimers, WhatEndsHold) {
  const auto mode_after = [](auto act) {
    RequestsAndTimers_WhatEndsHold_Test bench;
    bench.to_hold();
    act(bench);
    return std::pair(bench.supervisor_.mode(), int{bench.supervisor_.reason()});
  };
  using Bench = RequestsAndTimers_WhatEndsHold_Test;
  const std::pair lost(Mode::kFault, int{Reasons::REASON_STATE_LOST});
  const std::pair invalid(Mode::kFault, int{Reasons::REASON_STATE_INVALID});
  const std::pair changed(Mode::kFault, int{Reasons::REASON_SESSION_CHANGED});
  EXPECT_EQ(mode_after([](Bench& b) {
              b.seq_ += 3;
              b.states(1, State::DRIVE_ON);
            }),
            lost);
  EXPECT_EQ(mode_after([](Bench& b) {
              joint_state_t bad = b.state(State::DRIVE_ON);
              bad.period_ns = 0;
              b.supervisor_.on_state(bad);
            }),
            invalid);
  EXPECT_EQ(mode_after([](Bench& b) {
              ++b.session_;
              b.states(2, State::DRIVE_ON);
            }),
            changed);
}

// Nobody controls the arm: drives that are on, or about to be, shall hold it themselves.
TEST_F(RequestsAndTimers, WhatTheDriverIsAskedForWithoutAPoweredMode) {
  states(100, State::DRIVE_OFF);
  const auto asked_in = [this](std::int8_t drive_state) {
    states(1, drive_state);
    return drive_request();
  };
  EXPECT_EQ(asked_in(State::DRIVE_ON), +Command::REQUEST_HOLD);
  EXPECT_FALSE(supervisor_.engaged());
  EXPECT_EQ(asked_in(State::DRIVE_ENABLING), +Command::REQUEST_HOLD);
  for (std::int8_t other : {State::DRIVE_CONFIGURING, State::DRIVE_OFF, State::DRIVE_HOLD,
                            State::DRIVE_DAMP, State::DRIVE_FAULT}) {
    EXPECT_EQ(asked_in(other), +Command::REQUEST_KEEP) << int{other};
  }
  ASSERT_EQ(ask(Request::REQUEST_IDLE), "");
  for (std::int8_t powered :
       {State::DRIVE_ON, State::DRIVE_ENABLING, State::DRIVE_HOLD, State::DRIVE_DAMP}) {
    EXPECT_EQ(asked_in(powered), +Command::REQUEST_OFF) << int{powered};
    EXPECT_FALSE(supervisor_.drives_carry());
  }
  for (std::int8_t without : {State::DRIVE_CONFIGURING, State::DRIVE_OFF, State::DRIVE_FAULT})
    EXPECT_EQ(asked_in(without), +Command::REQUEST_KEEP) << int{without};
}

TEST_F(RequestsAndTimers, DampingDrivesAreAcknowledged) {
  states(100, State::DRIVE_OFF);
  ASSERT_EQ(ask(Request::REQUEST_HOLD), "");
  states(1, State::DRIVE_DAMP);
  EXPECT_TRUE(supervisor_.drives_hold());
  EXPECT_EQ(drive_request(), +Command::REQUEST_ACKNOWLEDGE);
  states(1, State::DRIVE_CONFIGURING);
  EXPECT_FALSE(supervisor_.drives_hold());
  EXPECT_EQ(drive_request(), +Command::REQUEST_KEEP);
}

}  // namespace
}  // namespace limber::controller::test_requests_and_timers
