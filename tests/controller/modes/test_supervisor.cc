// The mode table pair by pair, the judgement of states, and what is asked of the driver.
#include <gtest/gtest.h>

#include <limber/joint_command_t.hpp>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include "controller/modes/mode_table.h"
#include "controller/modes/supervisor.h"

namespace limber::controller::test_supervisor {
namespace {

// The whole table once more, as pictures of rows: what each event leads to from
// Boot, Init, iDle, Hold, Active, Softstop, Fault, Estop; '.': refused or ignored.
const std::map<Event, std::string> kExpected = {
    {Event::kRequestIdle, "..DD...."},
    {Event::kRequestHold, "..HHSS.."},
    {Event::kRequestActive, "...AA..."},
    {Event::kRequestStop, "BIDHSSFE"},
    {Event::kRequestAcknowledge, "......DD"},
    {Event::kFirstState, "I......."},
    {Event::kSteadyStates, ".D......"},
    {Event::kAtRest, ".....H.."},
    {Event::kStateLost, ".IIFFF.."},
    {Event::kStateInvalid, ".IIFFF.."},
    {Event::kDriverFault, "...FFF.."},
    {Event::kNewSession, ".IIFFF.."},
    {Event::kTorqueInvalid, "...FFF.."},
    {Event::kDriveNotOn, "...F...."},
    {Event::kStrayed, "...FFF.."},
    {Event::kOverdriven, "...FFF.."},
    {Event::kEncoderStopped, "...FFF.."},
    {Event::kEnergy, "...FFF.."},
    {Event::kClientSilent, "....S..."},
    {Event::kEstopPressed, "EEEEEEE."},
};

constexpr char kLetters[] = "BIDHASFE";

TEST(ModeTable, EveryPairIsAsIntended) {
  ASSERT_EQ(std::ssize(kExpected), kEvents);
  int pairs = 0;
  for (const auto& [event, row] : kExpected) {
    for (int mode = 0; mode < kModes; ++mode) {
      const Transition* found = find_transition(static_cast<Mode>(mode), event);
      const char to = found == nullptr ? '.' : kLetters[static_cast<int>(found->to)];
      EXPECT_EQ(to, row[static_cast<std::size_t>(mode)])
          << "mode " << mode << ", event " << static_cast<int>(event);
      if (found != nullptr) ++pairs;
    }
  }
  EXPECT_EQ(std::ssize(transitions()), pairs) << "no row twice, none left over";
}

// What must hold whatever the table says.
TEST(ModeTable, NoWayIntoMotionButThroughIdleAndHold) {
  for (const Transition& t : transitions()) {
    if (t.to == Mode::kActive) {
      EXPECT_TRUE(t.from == Mode::kHold || t.from == Mode::kActive);
    }
    if (t.to == Mode::kHold) {
      EXPECT_TRUE(t.from == Mode::kIdle || t.from == Mode::kHold || t.from == Mode::kSoftStop);
    }
    if (t.from == Mode::kFault || t.from == Mode::kEstop) {
      EXPECT_TRUE(t.to == t.from || t.event == Event::kRequestAcknowledge ||
                  t.event == Event::kEstopPressed);
    }
    if (t.to == Mode::kFault && t.from != Mode::kFault) {
      EXPECT_NE(t.reason, +controller_status_t::REASON_NONE);
    }
  }
}

joint_state_t good_state(std::int64_t seq) {
  joint_state_t state{};
  state.seq = seq;
  state.session = 5;
  state.time_ns = seq * 1'000'000;
  state.period_ns = 1'000'000;
  state.num_joints = 2;
  state.drive_state = joint_state_t::DRIVE_OFF;
  state.joint_flags[0] = state.joint_flags[1] = joint_state_t::JOINT_FRESH;
  return state;
}

TEST(StateJudge, KnowsRepetitionsGapsAndSessions) {
  StateJudge judge(2, 2);
  EXPECT_TRUE(judge.judge(good_state(10)).first);
  EXPECT_EQ(judge.judge(good_state(11)).missed, 0);
  EXPECT_TRUE(judge.judge(good_state(11)).repeated);
  EXPECT_TRUE(judge.judge(good_state(3)).repeated);
  EXPECT_EQ(judge.judge(good_state(15)).missed, 3);
  EXPECT_EQ(judge.lost(), 3);
  EXPECT_EQ(judge.received(), 3);
  joint_state_t other = good_state(0);
  other.session = 6;
  EXPECT_TRUE(judge.judge(other).doubted);
  ++other.seq;
  const StateJudgement judgement = judge.judge(other);
  EXPECT_TRUE(judgement.new_session && judgement.usable && !judgement.repeated);
  EXPECT_EQ(judgement.missed, 0);
}

TEST(StateJudge, LooksAtThisArmsJointsOnly) {
  StateJudge judge(2, 2);
  joint_state_t state = good_state(0);
  state.q[2] = std::numeric_limits<double>::quiet_NaN();
  state.age_cycles[2] = 1000;
  const StateJudgement judgement = judge.judge(state);
  EXPECT_TRUE(judgement.usable && judgement.fresh && !judgement.silent);
}

class Supervision : public ::testing::Test {
 protected:
  Supervision() : supervisor(2, 2) {}

  void states(int count, std::int8_t drive_state) {
    for (int i = 0; i < count; ++i) {
      joint_state_t state = good_state(++seq);
      state.drive_state = drive_state;
      supervisor.on_state(state);
    }
  }
  const char* ask(std::int8_t what) {
    mode_request_t request{};
    request.client = 1;
    request.request = what;
    return supervisor.on_mode(request);
  }
  int request() const { return supervisor.drive_request(); }

  Supervisor supervisor;
  std::int64_t seq = -1;
};

constexpr std::int8_t kOff = joint_state_t::DRIVE_OFF;
constexpr std::int8_t kOn = joint_state_t::DRIVE_ON;
constexpr std::int8_t kHolding = joint_state_t::DRIVE_HOLD;

TEST_F(Supervision, AsksTheDriverForWhatTheModeNeeds) {
  states(100, kOff);
  EXPECT_EQ(request(), +joint_command_t::REQUEST_KEEP);
  ask(mode_request_t::REQUEST_HOLD);
  EXPECT_EQ(request(), +joint_command_t::REQUEST_ON);
  states(1, joint_state_t::DRIVE_ENABLING);
  EXPECT_EQ(request(), +joint_command_t::REQUEST_KEEP);
  EXPECT_FALSE(supervisor.engaged());
  states(1, kHolding);
  EXPECT_EQ(request(), +joint_command_t::REQUEST_ACKNOWLEDGE);
  states(1, joint_state_t::DRIVE_FAULT);
  EXPECT_EQ(request(), +joint_command_t::REQUEST_ACKNOWLEDGE);
  states(1, kOn);
  EXPECT_EQ(request(), +joint_command_t::REQUEST_KEEP);
  EXPECT_TRUE(supervisor.engaged());
  states(1, kHolding);
  EXPECT_EQ(supervisor.mode(), Mode::kFault);
  EXPECT_EQ(request(), +joint_command_t::REQUEST_KEEP) << "it holds already";
}

TEST_F(Supervision, AsksForOffUntilItIs) {
  states(100, kOff);
  ask(mode_request_t::REQUEST_HOLD);
  states(2, kOn);
  ask(mode_request_t::REQUEST_IDLE);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(request(), +joint_command_t::REQUEST_OFF);
    EXPECT_FALSE(supervisor.drives_carry());
    states(1, kOn);
  }
  states(1, kOff);
  EXPECT_EQ(request(), +joint_command_t::REQUEST_KEEP);
}

TEST_F(Supervision, IdleAfterAFaultLeavesHoldingDrivesAloneUntilAsked) {
  states(100, kOff);
  ask(mode_request_t::REQUEST_HOLD);
  states(2, kOn);
  states(120, kHolding);
  ASSERT_EQ(supervisor.mode(), Mode::kFault);
  ASSERT_EQ(ask(mode_request_t::REQUEST_ACKNOWLEDGE), nullptr);
  states(50, kHolding);
  EXPECT_EQ(request(), +joint_command_t::REQUEST_KEEP);
  EXPECT_EQ(ask(mode_request_t::REQUEST_IDLE), nullptr);
  EXPECT_EQ(request(), +joint_command_t::REQUEST_OFF);
}

TEST_F(Supervision, SoftStopLastsThreeTenthsOfASecond) {
  states(100, kOff);
  ask(mode_request_t::REQUEST_HOLD);
  states(2, kOn);
  ASSERT_EQ(ask(mode_request_t::REQUEST_ACTIVE), nullptr);
  states(5, kOn);
  ASSERT_EQ(ask(mode_request_t::REQUEST_HOLD), nullptr);
  states(299, kOn);
  EXPECT_EQ(supervisor.mode(), Mode::kSoftStop);
  states(1, kOn);
  EXPECT_EQ(supervisor.mode(), Mode::kHold);
  EXPECT_TRUE(supervisor.engaged());
  EXPECT_EQ(supervisor.reason(), +controller_status_t::REASON_NONE) << "nothing went wrong";
}

TEST_F(Supervision, EstopIsLatched) {
  states(100, kOff);
  supervisor.raise(Event::kEstopPressed);
  states(100, kOff);
  EXPECT_EQ(supervisor.mode(), Mode::kEstop);
  EXPECT_NE(ask(mode_request_t::REQUEST_HOLD), nullptr);
  EXPECT_EQ(ask(mode_request_t::REQUEST_ACKNOWLEDGE), nullptr);
  EXPECT_EQ(supervisor.mode(), Mode::kIdle);
}

}  // namespace
}  // namespace limber::controller::test_supervisor
