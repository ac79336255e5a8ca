// Every verdict of the gate, its order, and the boundary of every limit.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limber/driver_status_t.hpp>
#include <limits>
#include <set>
#include <vector>

#include "drivers/gate/torque_gate.h"

namespace limber::test_torque_gate {
namespace {

using Status = driver_status_t;
constexpr int kAccepted = Status::VERDICT_ACCEPTED;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

constexpr std::int64_t kSession = 77;
constexpr std::int64_t kController = 5;

class TorqueGateTest : public ::testing::Test {
 protected:
  TorqueGateTest() {
    limits_.n = 3;
    limits_.session = kSession;
    limits_.torque_Nm = {10.0, 20.0, 5.0};
    limits_.torque_step_Nm = {1.0, 2.0, 0.5};
    situation_.state_seq = 100;
    situation_.powered = true;
    situation_.followed = true;
    situation_.torque_present = {0.5, -1.0, 0.25};
    memory_.controller = kController;
    memory_.state_seq = 99;
    good_.num_joints = 3;
    good_.session = kSession;
    good_.controller = kController;
    good_.state_seq = 100;
    for (int i = 0; i < 3; ++i) good_.tau[i] = situation_.torque_present[i];
  }

  int check(const joint_command_t& command) const {
    return check_command(limits_, memory_, situation_, command);
  }
  int check_with(const std::function<void(joint_command_t&)>& change) const {
    joint_command_t command = good_;
    change(command);
    return check(command);
  }

  GateLimits limits_;
  GateMemory memory_;
  GateSituation situation_;
  joint_command_t good_{};
};

TEST_F(TorqueGateTest, AcceptsWhatIsInOrder) { EXPECT_EQ(check(good_), kAccepted); }

// The hand is the last entry: num_joints leaves it out, its torque is limited, its power is not.
TEST_F(TorqueGateTest, AHandIsLimitedButNotCounted) {
  limits_.hand = 1;
  EXPECT_EQ(check(good_), +Status::VERDICT_SIZE);
  good_.num_joints = 2;
  EXPECT_EQ(check(good_), kAccepted);
  limits_.power_W = 1.0;
  situation_.velocity = {0.0, 0.0, 100.0};  // of the hand: 0.25 N m * 100 rad/s
  EXPECT_EQ(check(good_), kAccepted);
  situation_.velocity = {0.0, -2.0, 0.0};  // of the joint before it: -1 N m * -2 rad/s
  EXPECT_EQ(check(good_), +Status::VERDICT_POWER);
}

// Two motors of 6 N m each at joint 1, whose limit is 20 N m; one at the others.
TEST_F(TorqueGateTest, PreloadUpToWhatEachOfTwoMotorsMayDo) {
  limits_.preload_Nm[1] = 12.0;
  limits_.preload_step_Nm[1] = kInf;
  limits_.torque_step_Nm[1] = kInf;
  struct Case {
    double tau, preload;
    int verdict;
  };
  for (const Case& c :
       {Case{0.0, 12.0, kAccepted}, Case{0.0, -12.0, kAccepted},
        Case{0.0, std::nextafter(12.0, 13.0), Status::VERDICT_TORQUE},
        Case{0.0, -std::nextafter(12.0, 13.0), Status::VERDICT_TORQUE}, Case{5.0, 7.0, kAccepted},
        Case{-5.0, 7.0, kAccepted},
        Case{5.0, std::nextafter(12.0, 13.0) - 5.0, Status::VERDICT_TORQUE},
        Case{-5.0, 5.0 - std::nextafter(12.0, 13.0), Status::VERDICT_TORQUE},
        Case{0.0, kNan, Status::VERDICT_NOT_FINITE}, Case{0.0, kInf, Status::VERDICT_NOT_FINITE}}) {
    EXPECT_EQ(check_with([&](auto& command) {
                command.tau[1] = c.tau;
                command.tau_preload[1] = c.preload;
              }),
              c.verdict)
        << c.tau << " " << c.preload;
  }
}

TEST_F(TorqueGateTest, OneMotorHasNoPreload) {
  for (double preload : {1e-300, -1.0, 5.0}) {
    EXPECT_EQ(check_with([&](auto& command) { command.tau_preload[2] = preload; }),
              Status::VERDICT_TORQUE + 0);
  }
  EXPECT_EQ(check_with([&](auto& command) { command.tau_preload[2] = kNan; }),
            Status::VERDICT_NOT_FINITE + 0);
}

TEST_F(TorqueGateTest, PreloadRateFromWhatIsPresent) {
  limits_.preload_Nm[1] = 12.0;
  limits_.preload_step_Nm[1] = 4.0;
  situation_.preload_present[1] = 2.0;
  for (const auto& [preload, verdict] : std::vector<std::pair<double, int>>{
           {6.0, kAccepted},
           {-2.0, kAccepted},
           {2.0 + std::nextafter(4.0, 5.0), Status::VERDICT_RATE},
           {2.0 - std::nextafter(4.0, 5.0), Status::VERDICT_RATE}}) {
    const auto change = [&, preload = preload](auto& command) { command.tau_preload[1] = preload; };
    situation_.followed = true;
    EXPECT_EQ(check_with(change), verdict) << preload;
    situation_.followed = false;
    EXPECT_EQ(check_with(change), kAccepted) << preload;
  }
}

TEST_F(TorqueGateTest, PowerUpToTheLimit) {
  situation_.velocity = {2.0, -1.0, 4.0};  // 0.5 * 2 + 1 * 1 + 0.25 * 4 = 3 W
  for (const auto& [power_W, verdict] :
       std::vector<std::pair<double, int>>{{3.0, kAccepted},
                                           {std::nextafter(3.0, 0.0), Status::VERDICT_POWER},
                                           {kInf, kAccepted}}) {
    limits_.power_W = power_W;
    EXPECT_EQ(check(good_), verdict) << power_W;
  }
  limits_.power_W = 1.0;
  situation_.followed = false;
  EXPECT_EQ(check(good_), kAccepted) << "it goes nowhere";
  situation_.followed = true;
  situation_.velocity[1] = kNan;
  EXPECT_EQ(check(good_), Status::VERDICT_POWER + 0);
}

TEST_F(TorqueGateTest, SizeMustBeThisArms) {
  for (int n : {-32768, -1, 0, 1, 2, 4, 16, 17, 32767}) {
    EXPECT_EQ(check_with([n](auto& c) { c.num_joints = static_cast<std::int16_t>(n); }),
              Status::VERDICT_SIZE + 0)
        << n;
  }
}

TEST_F(TorqueGateTest, SessionMustBeThisRun) {
  for (std::int64_t session : {std::int64_t{0}, kSession - 1, kSession + 1, INT64_MIN, INT64_MAX}) {
    EXPECT_EQ(check_with([=](auto& c) { c.session = session; }), Status::VERDICT_SESSION + 0);
  }
}

TEST_F(TorqueGateTest, OnlyTheHolderOfTheLeaseIsHeard) {
  const auto from = [this](std::int64_t who) {
    return check_with([who](auto& c) { c.controller = who; });
  };
  EXPECT_EQ(from(kController + 1), Status::VERDICT_CONTROLLER + 0);
  EXPECT_EQ(from(0), Status::VERDICT_CONTROLLER + 0);
  memory_.controller = 0;
  EXPECT_EQ(from(kController + 1), kAccepted);
  EXPECT_EQ(from(0), Status::VERDICT_CONTROLLER + 0);
}

TEST_F(TorqueGateTest, TheStateAnsweredIsNewAndRecent) {
  const auto answering = [this](std::int64_t seq) {
    return check_with([seq](auto& c) { c.state_seq = seq; });
  };
  memory_.state_seq = 90;
  EXPECT_EQ(answering(100), kAccepted);
  EXPECT_EQ(answering(95), kAccepted);
  EXPECT_EQ(answering(94), Status::VERDICT_STALE + 0);
  EXPECT_EQ(answering(91), Status::VERDICT_STALE + 0);
  EXPECT_EQ(answering(90), Status::VERDICT_REPLAYED + 0);
  EXPECT_EQ(answering(INT64_MIN), Status::VERDICT_REPLAYED + 0);
  EXPECT_EQ(answering(101), Status::VERDICT_STALE + 0);  // never published
  EXPECT_EQ(answering(INT64_MAX), Status::VERDICT_STALE + 0);
}

TEST_F(TorqueGateTest, NothingIsAnsweredBeforeTheFirstState) {
  memory_ = {};
  situation_.state_seq = -1;
  EXPECT_EQ(check_with([](auto& c) { c.state_seq = -1; }), Status::VERDICT_REPLAYED + 0);
  EXPECT_EQ(check_with([](auto& c) { c.state_seq = 0; }), Status::VERDICT_STALE + 0);
}

TEST_F(TorqueGateTest, EveryNumberIsFinite) {
  for (int joint = 0; joint < 3; ++joint) {
    for (double bad : {kNan, -kNan, kInf, -kInf}) {
      EXPECT_EQ(check_with([=](auto& c) { c.tau[joint] = bad; }), Status::VERDICT_NOT_FINITE + 0);
      EXPECT_EQ(check_with([=](auto& c) { c.tau_gravity[joint] = bad; }),
                Status::VERDICT_NOT_FINITE + 0);
    }
  }
}

TEST_F(TorqueGateTest, WhatLiesBehindTheLastJointIsNotLookedAt) {
  EXPECT_EQ(check_with([](auto& c) { c.tau[3] = c.tau_gravity[15] = kNan; }), kAccepted);
}

TEST_F(TorqueGateTest, RequestIsOneOfTheKnownOnes) {
  for (int request = -128; request < 128; ++request) {
    const bool known = request >= 0 && request <= 4;
    EXPECT_EQ(check_with([=](auto& c) { c.request = static_cast<std::int8_t>(request); }),
              known ? kAccepted : Status::VERDICT_REQUEST + 0)
        << request;
  }
}

TEST_F(TorqueGateTest, WhatIsOffCannotBeHeld) {
  situation_.powered = false;
  situation_.followed = false;
  for (int request = 0; request <= 4; ++request) {
    const bool hold = request == joint_command_t::REQUEST_HOLD;
    EXPECT_EQ(check_with([=](auto& c) { c.request = static_cast<std::int8_t>(request); }),
              hold ? Status::VERDICT_NOT_ON + 0 : kAccepted);
  }
}

// Each joint at its limit, one bit above it, and beyond; both signs; torque and gravity alike.
TEST_F(TorqueGateTest, AbsoluteTorqueLimitToTheLastBit) {
  situation_.followed = false;  // so that the step does not interfere
  for (int joint = 0; joint < 3; ++joint) {
    const double limit = limits_.torque_Nm[joint];
    const double above = std::nextafter(limit, kInf);
    for (double sign : {1.0, -1.0}) {
      for (double size : {0.0, 0.5 * limit, limit, above, 1.001 * limit, 1e12, 1.7e308}) {
        const int expected = size <= limit ? kAccepted : Status::VERDICT_TORQUE + 0;
        EXPECT_EQ(check_with([=](auto& c) { c.tau[joint] = sign * size; }), expected)
            << joint << " " << sign * size;
        EXPECT_EQ(check_with([=](auto& c) { c.tau_gravity[joint] = sign * size; }), expected);
      }
    }
  }
}

TEST_F(TorqueGateTest, StepLimit) {
  for (int joint = 0; joint < 3; ++joint) {
    const double present = situation_.torque_present[joint];
    const double step = limits_.torque_step_Nm[joint];
    for (double sign : {1.0, -1.0}) {
      const double edge = present + sign * step;  // exact: all numbers here are short in binary
      const double beyond = edge + sign * std::ldexp(1.0, -40);
      EXPECT_EQ(check_with([=](auto& c) { c.tau[joint] = edge; }), kAccepted);
      EXPECT_EQ(check_with([=](auto& c) { c.tau[joint] = beyond; }), Status::VERDICT_RATE + 0);
    }
  }
}

TEST_F(TorqueGateTest, StepCountsOnlyWhereTheTorqueIsFollowed) {
  situation_.followed = false;
  EXPECT_EQ(check_with([](auto& c) { c.tau[1] = 20.0; }), kAccepted);
  situation_.followed = true;
  EXPECT_EQ(check_with([](auto& c) { c.tau[1] = 20.0; }), Status::VERDICT_RATE + 0);
}

// Steps of 1, 2 and 0.5 N m a cycle: gravity may change by three of them, after a silence by more.
TEST_F(TorqueGateTest, GravityStepFromTheLastAccepted) {
  memory_.has_gravity = true;
  memory_.gravity = {2.0, 0.0, -1.0};
  for (int i = 0; i < 3; ++i) good_.tau_gravity[i] = memory_.gravity[static_cast<std::size_t>(i)];
  struct Case {
    double gravity;
    std::int64_t silent_cycles;
    int verdict;
  };
  for (const Case& c : {Case{5.0, 1, kAccepted}, Case{-1.0, 1, kAccepted},
                        Case{std::nextafter(5.0, 6.0), 1, Status::VERDICT_RATE},
                        Case{-1.001, 0, Status::VERDICT_RATE}, Case{8.0, 2, kAccepted},
                        Case{8.1, 2, Status::VERDICT_RATE}}) {
    memory_.silent_cycles = c.silent_cycles;
    EXPECT_EQ(check_with([&](auto& command) { command.tau_gravity[0] = c.gravity; }), c.verdict)
        << c.gravity << " after " << c.silent_cycles;
  }
  memory_.silent_cycles = 1;
  EXPECT_EQ(check_with([](auto& command) { command.tau_gravity[2] = -2.6; }),
            +Status::VERDICT_RATE);
  situation_.followed = false;
  EXPECT_EQ(check_with([](auto& command) { command.tau_gravity[2] = -2.6; }), kAccepted);
}

TEST_F(TorqueGateTest, AnotherControllerBringsAGravityOfItsOwn) {
  TorqueGate gate(limits_);
  good_.tau_gravity[1] = 15.0;
  EXPECT_EQ(gate.judge(good_, situation_), kAccepted);
  gate.next_cycle();
  ++good_.state_seq;
  ++situation_.state_seq;
  good_.tau_gravity[1] = -15.0;
  EXPECT_EQ(gate.judge(good_, situation_), +Status::VERDICT_RATE);
  for (int i = 0; i < limits_.lease_cycles; ++i) gate.next_cycle();
  ++good_.controller;
  EXPECT_EQ(gate.judge(good_, situation_), kAccepted);
}

TEST_F(TorqueGateTest, ALimitThatIsNoNumberLetsNothingPass) {
  limits_.torque_Nm[1] = kNan;
  EXPECT_EQ(check(good_), Status::VERDICT_TORQUE + 0);
  limits_.torque_Nm[1] = 20.0;
  limits_.torque_step_Nm[2] = kNan;
  EXPECT_EQ(check(good_), Status::VERDICT_RATE + 0);
  limits_.torque_step_Nm[2] = 0.5;
  situation_.torque_present[0] = kNan;
  EXPECT_EQ(check(good_), Status::VERDICT_RATE + 0);
}

// Each flaw alone gives its own verdict; of any two, the one that is checked first is named.
TEST_F(TorqueGateTest, FirstFailureNamesTheVerdict) {
  using Change = std::function<void(joint_command_t&)>;
  const std::vector<std::pair<int, Change>> flaws = {
      {+Status::VERDICT_SIZE, [](auto& c) { c.num_joints = 4; }},
      {+Status::VERDICT_SESSION, [](auto& c) { c.session = 1; }},
      {+Status::VERDICT_CONTROLLER, [](auto& c) { c.controller = 6; }},
      {+Status::VERDICT_REPLAYED, [](auto& c) { c.state_seq = 99; }},
      {+Status::VERDICT_STALE, [](auto& c) { c.state_seq = 101; }},
      {+Status::VERDICT_NOT_FINITE, [](auto& c) { c.tau_gravity[0] = kNan; }},
      {+Status::VERDICT_REQUEST, [](auto& c) { c.request = 9; }},
      {+Status::VERDICT_NOT_ON, [](auto& c) { c.request = joint_command_t::REQUEST_HOLD; }},
      {+Status::VERDICT_TORQUE, [](auto& c) { c.tau_gravity[1] = 21.0; }},
      {+Status::VERDICT_RATE, [](auto& c) { c.tau[2] = 1.0; }},
  };
  situation_.powered = false;  // makes NOT_ON possible; RATE looks at `followed` alone
  std::set<int> seen;
  for (const auto& [verdict, change] : flaws) {
    EXPECT_EQ(check_with(change), verdict);
    seen.insert(verdict);
  }
  EXPECT_EQ(seen.size(), 10U);
  for (std::size_t i = 0; i < flaws.size(); ++i) {
    for (std::size_t j = i + 1; j < flaws.size(); ++j) {
      joint_command_t command = good_;
      flaws[i].second(command);
      flaws[j].second(command);
      // Two flaws in the same field are one flaw.
      if (flaws[i].first == Status::VERDICT_REPLAYED && flaws[j].first == Status::VERDICT_STALE)
        continue;
      if (flaws[i].first == Status::VERDICT_REQUEST && flaws[j].first == Status::VERDICT_NOT_ON)
        continue;
      EXPECT_EQ(check(command), flaws[i].first) << i << " " << j;
    }
  }
}

TEST_F(TorqueGateTest, FirstControllerIsBoundAndFreedByItsSilence) {
  TorqueGate gate(limits_);
  joint_command_t other = good_;
  other.controller = kController + 1;
  EXPECT_EQ(gate.judge(good_, situation_), kAccepted);
  EXPECT_EQ(gate.memory().controller, kController);
  for (int i = 0; i < limits_.lease_cycles - 1; ++i) {
    gate.next_cycle();
    other.state_seq = ++situation_.state_seq;
    EXPECT_EQ(gate.judge(other, situation_), Status::VERDICT_CONTROLLER + 0);
  }
  gate.next_cycle();
  other.state_seq = ++situation_.state_seq;
  EXPECT_EQ(gate.judge(other, situation_), kAccepted);
  good_.state_seq = ++situation_.state_seq;
  EXPECT_EQ(gate.judge(good_, situation_), Status::VERDICT_CONTROLLER + 0);
}

TEST_F(TorqueGateTest, AcceptedCommandsKeepTheLease) {
  TorqueGate gate(limits_);
  for (int i = 0; i < 3 * limits_.lease_cycles; ++i) {
    ASSERT_EQ(gate.judge(good_, situation_), kAccepted);
    gate.next_cycle();
    good_.state_seq = ++situation_.state_seq;
  }
}

TEST_F(TorqueGateTest, ARefusedCommandChangesNothing) {
  TorqueGate gate(limits_);
  ASSERT_EQ(gate.judge(good_, situation_), kAccepted);
  gate.next_cycle();
  situation_.state_seq = 101;
  const GateMemory before = gate.memory();
  joint_command_t bad = good_;
  bad.state_seq = 101;
  bad.tau[0] = kNan;
  EXPECT_EQ(gate.judge(bad, situation_), Status::VERDICT_NOT_FINITE + 0);
  EXPECT_EQ(gate.memory().controller, before.controller);
  EXPECT_EQ(gate.memory().state_seq, before.state_seq);
  EXPECT_EQ(gate.memory().silent_cycles, before.silent_cycles);
  bad.tau[0] = 0.5;
  EXPECT_EQ(gate.judge(bad, situation_), kAccepted);  // the same state, answered properly
}

TEST_F(TorqueGateTest, ThreeRefusalsOfTheHolderWithinTheWindowAreTooMany) {
  joint_command_t bad = good_;
  for (int gap : {1, 49, 50}) {  // the third lies 2 gaps after the first; the window is 100 cycles
    TorqueGate gate(limits_);
    ASSERT_EQ(gate.judge(good_, situation_), kAccepted);
    bad.state_seq = 101;
    bad.tau[0] = 100.0;
    GateSituation later = situation_;
    later.state_seq = 101;
    for (int refusal = 1; refusal <= 3; ++refusal) {
      for (int i = 0; i < gap; ++i) gate.next_cycle();
      EXPECT_EQ(gate.judge(bad, later), Status::VERDICT_TORQUE + 0);
      EXPECT_EQ(gate.refused_too_often(), refusal == 3 && 2 * gap < 100) << gap;
    }
  }
}

TEST_F(TorqueGateTest, StrangersAndDuplicatesDoNotTripTheHolder) {
  TorqueGate gate(limits_);
  ASSERT_EQ(gate.judge(good_, situation_), kAccepted);
  joint_command_t stranger = good_;
  stranger.controller = 99;
  joint_command_t old_session = good_;
  old_session.session = 1;
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(gate.judge(stranger, situation_), Status::VERDICT_CONTROLLER + 0);
    EXPECT_FALSE(gate.refused_too_often());
    EXPECT_EQ(gate.judge(old_session, situation_), Status::VERDICT_SESSION + 0);
    EXPECT_FALSE(gate.refused_too_often());
    EXPECT_EQ(gate.judge(good_, situation_), Status::VERDICT_REPLAYED + 0);
    EXPECT_FALSE(gate.refused_too_often());
  }
}

// They are missing answers, which ControllerWatch bridges and counts.
TEST_F(TorqueGateTest, LateAnswersDoNotTripTheHolder) {
  TorqueGate gate(limits_);
  ASSERT_EQ(gate.judge(good_, situation_), kAccepted);
  joint_command_t late = good_;
  situation_.state_seq += 20;
  for (int i = 0; i < 9; ++i) {
    ++late.state_seq;
    EXPECT_EQ(gate.judge(late, situation_), Status::VERDICT_STALE + 0);
    EXPECT_FALSE(gate.refused_too_often());
  }
  late.state_seq = situation_.state_seq + 1;  // never published: that is no late answer
  for (int i = 1; i <= 3; ++i) {
    EXPECT_EQ(gate.judge(late, situation_), Status::VERDICT_STALE + 0);
    EXPECT_EQ(gate.refused_too_often(), i == 3);
  }
}

TEST(EventWindowTest, CountsTheNthWithinTheSpan) {
  EventWindow<3> window;
  EXPECT_FALSE(window.add(0, 10));
  EXPECT_FALSE(window.add(5, 10));
  EXPECT_TRUE(window.add(9, 10));
  EXPECT_FALSE(window.add(15, 10));  // 5, 9, 15: eleven cycles with both ends
  EXPECT_TRUE(window.add(15, 10));   // 9, 15, 15
  window.clear();
  EXPECT_FALSE(window.add(16, 10));
  EXPECT_FALSE(window.add(16, 10));
  EXPECT_TRUE(window.add(16, 10));
}

}  // namespace
}  // namespace limber::test_torque_gate
