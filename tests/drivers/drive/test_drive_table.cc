// The table of drive states against one written down independently, pair by pair.
#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "drivers/drive/drive_state_machine.h"

namespace limber::test_drive_table {
namespace {

using S = DriveState;
using E = DriveEvent;

const std::vector<S> kStates = {S::kConfiguring, S::kOff,  S::kEnabling, S::kOn,
                                S::kFallback,    S::kDamp, S::kFault};

/// What safety asks for, in words: the pairs that do something. All others are ignored.
const std::map<E, std::map<S, S>> kExpected = {
    {E::kConfigured, {{S::kConfiguring, S::kOff}}},
    {E::kEnabled, {{S::kEnabling, S::kOn}}},
    {E::kTakenOver, {{S::kFallback, S::kOn}, {S::kDamp, S::kOn}}},
    {E::kRequestOn, {{S::kOff, S::kEnabling}}},
    {E::kRequestOff,
     {{S::kEnabling, S::kOff},
      {S::kOn, S::kOff},
      {S::kFallback, S::kConfiguring},
      {S::kDamp, S::kConfiguring}}},
    {E::kRequestHold,
     {{S::kEnabling, S::kOff},
      {S::kOn, S::kFallback},
      {S::kFallback, S::kFallback},
      {S::kDamp, S::kDamp}}},
    {E::kAcknowledge,
     {{S::kFallback, S::kFallback}, {S::kDamp, S::kDamp}, {S::kFault, S::kConfiguring}}},
    {E::kShutDown,
     {{S::kEnabling, S::kOff}, {S::kOn, S::kDamp}, {S::kFallback, S::kDamp}, {S::kDamp, S::kDamp}}},
    {E::kConfigurationWrong, {{S::kConfiguring, S::kFault}}},
    {E::kEnableTimedOut, {{S::kEnabling, S::kFault}}},
    {E::kControllerLost,
     {{S::kEnabling, S::kFault},
      {S::kOn, S::kFallback},
      {S::kFallback, S::kFallback},
      {S::kDamp, S::kDamp}}},
    {E::kCommandRefused, {{S::kEnabling, S::kFault}, {S::kOn, S::kFallback}}},
    {E::kOverrun,
     {{S::kEnabling, S::kFault},
      {S::kOn, S::kFallback},
      {S::kFallback, S::kFallback},
      {S::kDamp, S::kDamp}}},
    {E::kReplyLost,
     {{S::kOff, S::kFault},
      {S::kEnabling, S::kFault},
      {S::kOn, S::kFallback},
      {S::kFallback, S::kFallback},
      {S::kDamp, S::kDamp}}},
    {E::kAllSilent,
     {{S::kOff, S::kFault},
      {S::kEnabling, S::kFault},
      {S::kOn, S::kFault},
      {S::kFallback, S::kFault},
      {S::kDamp, S::kFault}}},
    {E::kReplyInvalid,
     {{S::kOff, S::kFault},
      {S::kEnabling, S::kFault},
      {S::kOn, S::kFallback},
      {S::kFallback, S::kFallback},
      {S::kDamp, S::kDamp}}},
    {E::kFeedbackWrong,
     {{S::kEnabling, S::kFault},
      {S::kOn, S::kFallback},
      {S::kFallback, S::kFallback},
      {S::kDamp, S::kDamp}}},
    {E::kForeignCommand,
     {{S::kConfiguring, S::kFault},
      {S::kOff, S::kFault},
      {S::kEnabling, S::kFault},
      {S::kOn, S::kFallback},
      {S::kFallback, S::kFallback},
      {S::kDamp, S::kDamp}}},
    {E::kBusLost,
     {{S::kConfiguring, S::kFault},
      {S::kOff, S::kFault},
      {S::kEnabling, S::kFault},
      {S::kOn, S::kFallback},
      {S::kFallback, S::kFallback},
      {S::kDamp, S::kDamp}}},
    {E::kDriveError,
     {{S::kEnabling, S::kFault},
      {S::kOn, S::kFallback},
      {S::kFallback, S::kFallback},
      {S::kDamp, S::kDamp}}},
    {E::kTooHot,
     {{S::kEnabling, S::kFault},
      {S::kOn, S::kFallback},
      {S::kFallback, S::kFallback},
      {S::kDamp, S::kDamp}}},
    {E::kPositionTrip,
     {{S::kEnabling, S::kFault},
      {S::kOn, S::kFallback},
      {S::kFallback, S::kFallback},
      {S::kDamp, S::kDamp}}},
    {E::kVelocityTrip,
     {{S::kEnabling, S::kFault},
      {S::kOn, S::kDamp},
      {S::kFallback, S::kDamp},
      {S::kDamp, S::kDamp}}},
    {E::kEmergencyStop,
     {{S::kOff, S::kFault},
      {S::kEnabling, S::kFault},
      {S::kOn, S::kFallback},
      {S::kFallback, S::kFallback},
      {S::kDamp, S::kDamp}}},
    {E::kEmergencyOff, {{S::kFallback, S::kFault}, {S::kDamp, S::kFault}}},
};

const std::map<E, int> kFaults = {
    {E::kRequestHold, joint_state_t::FAULT_REQUESTED},
    {E::kShutDown, joint_state_t::FAULT_REQUESTED},
    {E::kConfigurationWrong, joint_state_t::FAULT_CONFIGURATION},
    {E::kEnableTimedOut, joint_state_t::FAULT_DRIVE_ERROR},
    {E::kControllerLost, joint_state_t::FAULT_CONTROLLER_LOST},
    {E::kCommandRefused, joint_state_t::FAULT_COMMAND_REFUSED},
    {E::kOverrun, joint_state_t::FAULT_OVERRUN},
    {E::kReplyLost, joint_state_t::FAULT_REPLY_LOST},
    {E::kAllSilent, joint_state_t::FAULT_REPLY_LOST},
    {E::kReplyInvalid, joint_state_t::FAULT_REPLY_INVALID},
    {E::kForeignCommand, joint_state_t::FAULT_FOREIGN_COMMAND},
    {E::kBusLost, joint_state_t::FAULT_BUS},
    {E::kDriveError, joint_state_t::FAULT_DRIVE_ERROR},
    {E::kFeedbackWrong, joint_state_t::FAULT_FEEDBACK},
    {E::kTooHot, joint_state_t::FAULT_TEMPERATURE},
    {E::kPositionTrip, joint_state_t::FAULT_POSITION},
    {E::kVelocityTrip, joint_state_t::FAULT_VELOCITY},
    {E::kEmergencyStop, joint_state_t::FAULT_EMERGENCY_STOP},
    {E::kEmergencyOff, joint_state_t::FAULT_EMERGENCY_STOP},
};

/// Events that lead from CONFIGURING to a state.
std::vector<E> way_to(S state) {
  switch (state) {
    case S::kConfiguring:
      return {};
    case S::kOff:
      return {E::kConfigured};
    case S::kEnabling:
      return {E::kConfigured, E::kRequestOn};
    case S::kOn:
      return {E::kConfigured, E::kRequestOn, E::kEnabled};
    case S::kFallback:
      return {E::kConfigured, E::kRequestOn, E::kEnabled, E::kOverrun};
    case S::kDamp:
      return {E::kConfigured, E::kRequestOn, E::kEnabled, E::kVelocityTrip};
    case S::kFault:
      return {E::kConfigurationWrong};
  }
  return {};
}

DriveStateMachine machine_in(S state) {
  DriveStateMachine machine;
  for (E event : way_to(state)) machine.apply(event);
  EXPECT_EQ(machine.state(), state);
  return machine;
}

TEST(DriveStatesTest, EveryPairOfStateAndEvent) {
  ASSERT_EQ(kExpected.size(), static_cast<std::size_t>(kDriveEvents));
  ASSERT_EQ(kStates.size(), static_cast<std::size_t>(kDriveStates));
  for (const auto& [event, moves] : kExpected) {
    for (S state : kStates) {
      const std::string where = "state " + std::to_string(static_cast<int>(state)) + " event " +
                                std::to_string(static_cast<int>(event));
      const auto move = moves.find(state);
      const DriveTransition* row = find_drive_transition(state, event);
      EXPECT_EQ(row == nullptr, move == moves.end()) << where;
      DriveStateMachine machine = machine_in(state);
      const bool changed = machine.apply(event);
      const S expected = move == moves.end() ? state : move->second;
      EXPECT_EQ(machine.state(), expected) << where;
      EXPECT_EQ(changed, expected != state) << where;
    }
  }
}

TEST(DriveStatesTest, EachEventHasItsFault) {
  for (const DriveTransition& row : drive_transitions()) {
    const auto fault = kFaults.find(row.event);
    EXPECT_EQ(row.fault, fault == kFaults.end() ? 0 : fault->second)
        << static_cast<int>(row.from) << " " << static_cast<int>(row.event);
  }
}

TEST(DriveStatesTest, NoPairIsListedTwice) {
  std::set<std::pair<S, E>> pairs;
  for (const DriveTransition& row : drive_transitions())
    EXPECT_TRUE(pairs.insert({row.from, row.event}).second);
}

TEST(DriveStatesTest, FaultsOnlyEscalate) {
  // From following, over holding and braking, to being off.
  const std::map<S, int> severity = {{S::kOn, 0},          {S::kFallback, 1}, {S::kDamp, 2},
                                     {S::kConfiguring, 3}, {S::kEnabling, 3}, {S::kOff, 3},
                                     {S::kFault, 4}};
  for (const auto& [event, fault] : kFaults) {
    for (S state : kStates) {
      const DriveTransition* row = find_drive_transition(state, event);
      if (row == nullptr) continue;
      EXPECT_GE(severity.at(row->to), severity.at(state))
          << static_cast<int>(state) << " " << static_cast<int>(event);
    }
  }
}

TEST(DriveStatesTest, AFaultIsLatchedInTheStatesThatNeedAnAcknowledgementOnly) {
  for (const auto& [event, moves] : kExpected) {
    for (S state : kStates) {
      DriveStateMachine machine = machine_in(state);
      machine.apply(event, 2);
      const bool latching = machine.state() == S::kFallback || machine.state() == S::kDamp ||
                            machine.state() == S::kFault;
      EXPECT_EQ(machine.fault() != joint_state_t::FAULT_NONE, latching && !machine.acknowledged())
          << static_cast<int>(state) << " " << static_cast<int>(event);
    }
  }
}

TEST(DriveStatesTest, NothingButAnAcknowledgementLeavesFault) {
  for (const auto& [event, moves] : kExpected) {
    DriveStateMachine machine = machine_in(S::kFault);
    machine.apply(event);
    EXPECT_EQ(machine.state() == S::kFault, event != E::kAcknowledge);
  }
}

TEST(DriveStatesTest, FirstFaultIsKeptUntilAcknowledged) {
  DriveStateMachine machine = machine_in(S::kOn);
  machine.apply(E::kReplyLost, 3);
  machine.apply(E::kVelocityTrip, 1);
  EXPECT_EQ(machine.state(), S::kDamp);
  EXPECT_EQ(machine.fault(), joint_state_t::FAULT_REPLY_LOST + 0);
  EXPECT_EQ(machine.fault_joint(), 3);
  EXPECT_FALSE(machine.acknowledged());
  machine.apply(E::kAcknowledge);
  EXPECT_TRUE(machine.acknowledged());
  EXPECT_EQ(machine.fault(), joint_state_t::FAULT_NONE + 0);
  EXPECT_EQ(machine.fault_joint(), -1);
  machine.apply(E::kPositionTrip, 2);  // in DAMP: stays, but it is a fault again
  EXPECT_EQ(machine.state(), S::kDamp);
  EXPECT_FALSE(machine.acknowledged());
  EXPECT_EQ(machine.fault(), joint_state_t::FAULT_POSITION + 0);
}

TEST(DriveStatesTest, NothingIsAcknowledgedBeforeItHappened) {
  const DriveStateMachine machine;
  EXPECT_FALSE(machine.acknowledged());
  EXPECT_EQ(machine.fault_joint(), -1);
}

TEST(DriveStatesTest, IgnoredEventsLeaveNoFault) {
  DriveStateMachine machine = machine_in(S::kOff);
  machine.apply(E::kControllerLost);
  machine.apply(E::kPositionTrip, 1);
  EXPECT_EQ(machine.fault(), joint_state_t::FAULT_NONE + 0);
}

TEST(DriveStatesTest, PoweredMeansThatADriveMayBeEnabled) {
  for (S state : kStates) {
    const bool powered =
        state == S::kEnabling || state == S::kOn || state == S::kFallback || state == S::kDamp;
    EXPECT_EQ(machine_in(state).powered(), powered);
  }
}

}  // namespace
}  // namespace limber::test_drive_table
