// What the gate does where nothing has been set yet, at the size of its arrays, and around a lease.
#include <gtest/gtest.h>

#include <limber/driver_status_t.hpp>

#include "drivers/gate/torque_gate.h"

namespace limber::test_gate_edges {
namespace {

using Status = driver_status_t;
constexpr int kAccepted = Status::VERDICT_ACCEPTED;

/// An arm of `n` joints, 10 N m and 1 N m a cycle each, and a command for it that is in order.
struct Arm {
  explicit Arm(int n) {
    limits.n = n;
    limits.session = 7;
    limits.torque_Nm.fill(10.0);
    limits.torque_step_Nm.fill(1.0);
    situation.state_seq = 1;
    situation.followed = true;
    command.num_joints = static_cast<std::int16_t>(n);
    command.session = 7;
    command.controller = 1;
    command.state_seq = 1;
  }
  /// The next cycle's state, and the command that answers it.
  int next(TorqueGate* gate) {
    gate->next_cycle();
    command.state_seq = ++situation.state_seq;
    return gate->judge(command, situation);
  }

  GateLimits limits;
  GateSituation situation;
  joint_command_t command{};
};

TEST(GateEdges, WhatNobodyHasSetPermitsNothing) {
  const GateLimits limits;
  EXPECT_EQ(limits.n, 0);
  EXPECT_EQ(limits.session, 0);
  const GateSituation situation;
  EXPECT_EQ(situation.state_seq, 0);
  EXPECT_FALSE(situation.powered);
  EXPECT_FALSE(situation.followed);
  const TorqueGate gate(limits);
  EXPECT_FALSE(gate.leased());
  EXPECT_FALSE(gate.refused_too_often());
}

TEST(GateEdges, AsManyJointsAsAMessageHolds) {
  Arm most(kMaxJoints);
  EXPECT_EQ(check_command(most.limits, {}, most.situation, most.command), kAccepted);
  Arm more(kMaxJoints + 1);
  EXPECT_EQ(check_command(more.limits, {}, more.situation, more.command), +Status::VERDICT_SIZE);
}

TEST(GateEdges, ASmallPreloadLimitIsALimit) {
  Arm arm(1);
  arm.limits.preload_Nm[0] = 0.5;
  arm.limits.preload_step_Nm[0] = 1.0;
  arm.command.tau_preload[0] = 0.5;
  EXPECT_EQ(check_command(arm.limits, {}, arm.situation, arm.command), kAccepted);
}

// Before the first cycle has passed since the last command, its three steps count, too.
TEST(GateEdges, TwoCommandsInACycleMayDifferByThreeStepsOfGravity) {
  Arm arm(1);
  GateMemory memory;
  memory.has_gravity = true;
  memory.silent_cycles = 0;
  arm.command.tau_gravity[0] = 3.0;
  EXPECT_EQ(check_command(arm.limits, memory, arm.situation, arm.command), kAccepted);
}

TEST(GateEdges, GravityIsComparedWithTheLastAcceptedOfEachJoint) {
  Arm arm(kMaxJoints);
  TorqueGate gate(arm.limits);
  arm.command.tau_gravity[0] = arm.command.tau_gravity[kMaxJoints - 1] = 6.0;
  ASSERT_EQ(gate.judge(arm.command, arm.situation), kAccepted);
  arm.command.tau_gravity[0] = arm.command.tau_gravity[kMaxJoints - 1] = 9.0;
  EXPECT_EQ(arm.next(&gate), kAccepted) << "3 N m from 6, 9 from nothing";
}

// The lease is two cycles long: 20 N m is more than three steps in each of them.
TEST(GateEdges, TheGravityOfAControllerIsForgottenWithItsLease) {
  Arm arm(1);
  arm.limits.lease_cycles = 2;
  TorqueGate gate(arm.limits);
  arm.command.tau_gravity[0] = 10.0;
  ASSERT_EQ(gate.judge(arm.command, arm.situation), kAccepted);
  EXPECT_TRUE(gate.leased());
  gate.next_cycle();
  EXPECT_TRUE(gate.leased());
  arm.command.tau_gravity[0] = -10.0;
  EXPECT_EQ(arm.next(&gate), kAccepted);
  gate.next_cycle();
  gate.next_cycle();
  EXPECT_FALSE(gate.leased());
}

// 0.25 s and 0.1 s at 1 kHz, which docs/safety.md promises.
TEST(GateEdges, LeaseAndRefusalsAsDocumented) {
  EXPECT_EQ(GateLimits{}.lease_cycles, 250);
  EXPECT_EQ(GateLimits{}.refusal_cycles, 100);
}

// The third refusal comes 99 cycles after the first; the holder's number is the smallest there is.
TEST(GateEdges, RefusedTooOftenUntilTheNextCommand) {
  Arm arm(1);
  TorqueGate gate(arm.limits);
  ASSERT_EQ(gate.judge(arm.command, arm.situation), kAccepted);
  arm.command.tau[0] = 11.0;
  EXPECT_EQ(arm.next(&gate), +Status::VERDICT_TORQUE);
  EXPECT_EQ(arm.next(&gate), +Status::VERDICT_TORQUE);
  for (int i = 0; i < 97; ++i) gate.next_cycle();
  EXPECT_FALSE(gate.refused_too_often());
  EXPECT_EQ(arm.next(&gate), +Status::VERDICT_TORQUE);
  EXPECT_TRUE(gate.refused_too_often());
  arm.command.tau[0] = 0.0;
  EXPECT_EQ(arm.next(&gate), kAccepted);
  EXPECT_FALSE(gate.refused_too_often());
}

// Only an answer that is too old is late; a wrong one to the state before is a wrong one.
TEST(GateEdges, WrongAnswersToTheStateBeforeAreRefusedTooOften) {
  Arm arm(1);
  TorqueGate gate(arm.limits);
  ASSERT_EQ(gate.judge(arm.command, arm.situation), kAccepted);
  arm.situation.state_seq = 3;
  arm.command.state_seq = 2;
  arm.command.tau[0] = 11.0;
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(gate.refused_too_often());
    EXPECT_EQ(gate.judge(arm.command, arm.situation), +Status::VERDICT_TORQUE);
  }
  EXPECT_TRUE(gate.refused_too_often());
}

TEST(GateEdges, NobodysCommandsAreNotTheHoldersWhenThereIsNone) {
  Arm arm(1);
  TorqueGate gate(arm.limits);
  arm.command.controller = 0;
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(arm.next(&gate), +Status::VERDICT_CONTROLLER);
    EXPECT_FALSE(gate.refused_too_often());
  }
}

}  // namespace
}  // namespace limber::test_gate_edges
