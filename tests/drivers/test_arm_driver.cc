// Enabling, following, and who is obeyed.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/drivers/fake_arm.h"

namespace limber::test_arm_driver {
namespace {

using testing::FakeArm;
using testing::is_special;
using testing::raw_command;
using testing::test_robot;

constexpr int kKeep = joint_command_t::REQUEST_KEEP;
constexpr int kRequestOff = joint_command_t::REQUEST_OFF;
constexpr int kRequestOn = joint_command_t::REQUEST_ON;
constexpr int kRequestHold = joint_command_t::REQUEST_HOLD;
constexpr int kOff = joint_state_t::DRIVE_OFF;
constexpr int kEnabling = joint_state_t::DRIVE_ENABLING;
constexpr int kOn = joint_state_t::DRIVE_ON;
constexpr int kFallback = joint_state_t::DRIVE_HOLD;
constexpr int kFault = joint_state_t::DRIVE_FAULT;
constexpr int kAccepted = driver_status_t::VERDICT_ACCEPTED;

TEST(EnablingTest, ZeroTorqueThenEnableThenProof) {
  FakeArm arm(test_robot(1));
  ASSERT_TRUE(arm.run_until(kOff, kKeep));
  arm.cycle_with(kRequestOn);
  const std::size_t first = arm.motors[0].frames.size();
  for (int i = 0; i < 3; ++i) arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kOn);
  const std::vector<CanFrame>& f = arm.motors[0].frames;
  // The cycle that carried the request was still OFF; then: zero torque, FC, and the command whose
  // reply proves it. The first zero is half a count up, the next one gives it back.
  const int zero_up[8] = {0x80, 0x00, 0x80, 0x00, 0x00, 0x00, 0x08, 0x00};
  const int enable[8] = {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFC};
  ASSERT_EQ(f.size(), first + 3);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(f[first].data[i], zero_up[i]);
    EXPECT_EQ(f[first + 1].data[i], enable[i]);
    EXPECT_EQ(f[first + 2].data[i], zero_up[i]);
  }
}

TEST(EnablingTest, ALatchedErrorIsClearedFirst) {
  FakeArm arm(test_robot(2));
  ASSERT_TRUE(arm.run_until(kOff, kKeep));
  arm.motors[1].error = 0xD;
  arm.cycle_with(kKeep);
  EXPECT_NE(arm.state->joint_flags[1] & joint_state_t::JOINT_DRIVE_ERROR, 0);
  arm.cycle_with(kRequestOn);
  arm.cycle_with(kRequestOn);
  EXPECT_TRUE(is_special(arm.motors[1].last(), 0xFB));
  EXPECT_FALSE(is_special(arm.motors[0].last()));
  ASSERT_TRUE(arm.run_until(kOn, kRequestOn, 10));
  EXPECT_EQ(arm.motors[1].error, 1);
}

TEST(EnablingTest, ADriveThatDoesNotComeUpMakesAllOfThemOff) {
  FakeArm arm(test_robot(3));
  ASSERT_TRUE(arm.run_until(kOff, kKeep));
  arm.motors[2].obedient = false;
  int cycles = 0;
  while (arm.state->drive_state != kFault && cycles < 300) {
    arm.cycle_with(kRequestOn);
    ++cycles;
  }
  EXPECT_NEAR(cycles, 101, 2);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_DRIVE_ERROR + 0);
  EXPECT_EQ(arm.state->fault_joint, 2);
  arm.cycle_with(kRequestOn);
  for (const testing::FakeMotor& motor : arm.motors) {
    EXPECT_EQ(motor.error, 0);
    EXPECT_TRUE(is_special(motor.last(), 0xFD));
  }
}

TEST(EnablingTest, NothingIsEnabledOutsideItsLimitsOrInMotionOrUnheard) {
  FakeArm outside(test_robot(2));
  outside.set_angle(0, 2.1);
  ASSERT_TRUE(outside.run_until(kOff, kKeep));
  EXPECT_FALSE(outside.run_until(kEnabling, kRequestOn, 20));
  EXPECT_NE(outside.state->joint_flags[0] & joint_state_t::JOINT_OUT_OF_RANGE, 0);

  FakeArm moving(test_robot(2));
  moving.set_speed(1, 6.0);
  ASSERT_TRUE(moving.run_until(kOff, kKeep));
  EXPECT_FALSE(moving.run_until(kEnabling, kRequestOn, 20));
  moving.set_speed(1, 5.0);
  EXPECT_TRUE(moving.run_until(kEnabling, kRequestOn, 2));

  FakeArm unheard(test_robot(2));
  ASSERT_TRUE(unheard.run_until(kOff, kKeep));
  unheard.motors[1].silent = true;
  unheard.cycle_with(kRequestOn);
  unheard.motors[1].silent = false;
  unheard.cycle_with(kKeep);
  EXPECT_EQ(unheard.state->drive_state, kOff);
}

TEST(EnablingTest, LostFramesDelayButDoNotSkipSteps) {
  FakeArm arm(test_robot(1));
  ASSERT_TRUE(arm.run_until(kOff, kKeep));
  arm.cycle_with(kRequestOn);
  for (int step = 0; step < 3; ++step) {
    arm.motors[0].silent = true;
    arm.cycle_with(kRequestOn);
    arm.motors[0].silent = false;
    const CanFrame before = arm.motors[0].last();
    arm.cycle_with(kRequestOn);
    EXPECT_EQ(is_special(arm.motors[0].last()), is_special(before));
  }
  EXPECT_EQ(arm.state->drive_state, kOn);
}

TEST(FollowingTest, AcceptedTorqueLeavesInTheNextCycleAndNoGainsWithIt) {
  FakeArm arm(test_robot(2));
  ASSERT_TRUE(arm.switch_on());
  arm.command.tau[0] = 0.4;
  arm.command.tau[1] = -0.3;
  ASSERT_EQ(arm.cycle_with(kRequestOn), kAccepted);
  arm.half_cycle();
  for (std::size_t j = 0; j < 2; ++j) {
    const auto raw = raw_command(arm.motors[j].last());
    EXPECT_EQ(raw.kp, 0);
    EXPECT_EQ(raw.kd, 0);
    const double sign = j == 0 ? 1.0 : -1.0;
    EXPECT_NEAR(sign * arm.motors[j].torque_of(raw.t), arm.command.tau[j], 5e-3);
    EXPECT_NEAR(arm.state->tau_applied[j], arm.command.tau[j], 5e-3);
    EXPECT_NEAR(arm.state->tau_applied[j], sign * arm.motors[j].torque_of(raw.t), 1e-12);
  }
}

TEST(FollowingTest, StateDescribesTheArm) {
  FakeArm arm(test_robot(2));
  arm.set_angle(0, 0.25);
  arm.set_angle(1, -0.75);
  arm.set_speed(1, 0.5);
  ASSERT_TRUE(arm.switch_on());
  const joint_state_t& s = *arm.state;
  EXPECT_EQ(s.session, FakeArm::kSession);
  EXPECT_EQ(s.seq, arm.cycle);
  EXPECT_EQ(s.time_ns, arm.cycle * 1'000'000);
  EXPECT_EQ(s.period_ns, 1'000'000);
  EXPECT_EQ(s.num_joints, 2);
  EXPECT_NEAR(s.q[0], 0.25, 4e-4);
  EXPECT_NEAR(s.q[1], -0.75, 4e-4);
  EXPECT_NEAR(s.v[1], 0.5, 0.015);
  EXPECT_EQ(s.theta[1], s.q[1]);
  EXPECT_EQ(s.theta_dot[1], s.v[1]);
  EXPECT_EQ(s.fault_joint, -1);
  EXPECT_EQ(s.joint_flags[0], 3);  // fresh, enabled
  EXPECT_EQ(s.q[2], 0.0);
}

TEST(FollowingTest, OffDisablesAndIsConfirmed) {
  FakeArm arm(test_robot(2));
  ASSERT_TRUE(arm.switch_on());
  arm.cycle_with(kRequestOff);
  arm.cycle_with(kRequestOff);
  EXPECT_TRUE(is_special(arm.motors[0].last(), 0xFD));
  EXPECT_EQ(arm.state->drive_state, kOff);
  arm.cycle_with(kKeep);
  arm.cycle_with(kKeep);
  EXPECT_EQ(arm.motors[0].last().id, 0x7FFU);  // confirmed: polls again
  EXPECT_EQ(arm.motors[0].error, 0);
}

TEST(FollowingTest, ADriveFoundEnabledWhileOffIsDisabled) {
  FakeArm arm(test_robot(2));
  ASSERT_TRUE(arm.run_until(kOff, kKeep));
  arm.motors[1].error = 1;  // some other process did that
  for (int i = 0; i < 3; ++i) arm.cycle_with(kKeep);
  EXPECT_EQ(arm.motors[1].error, 0);
}

TEST(FollowingTest, TorqueWhileOffIsJudgedButNotSent) {
  FakeArm arm(test_robot(2));
  ASSERT_TRUE(arm.run_until(kOff, kKeep));
  arm.command.tau[0] = 7.9;  // far beyond any step
  EXPECT_EQ(arm.cycle_with(kKeep), kAccepted);
  arm.command.tau[0] = 8.1;
  EXPECT_EQ(arm.cycle_with(kKeep), driver_status_t::VERDICT_TORQUE + 0);
  arm.half_cycle();
  EXPECT_EQ(arm.motors[0].last().id, 0x7FFU);
}

TEST(FollowingTest, FirstTorqueAfterEnablingStartsAtZero) {
  FakeArm arm(test_robot(2));
  ASSERT_TRUE(arm.run_until(kOff, kKeep));
  arm.command.tau[0] = 3.0;  // asked for long before the drive is on
  int verdict = kAccepted;
  for (int i = 0; i < 20 && arm.state->drive_state != kOn; ++i) {
    EXPECT_EQ(verdict, kAccepted);  // heard, not followed
    verdict = arm.cycle_with(kRequestOn);
  }
  EXPECT_EQ(verdict, driver_status_t::VERDICT_RATE + 0);
  arm.half_cycle();
  EXPECT_NEAR(arm.motors[0].torque_of(raw_command(arm.motors[0].last()).t), 0.0, 5e-3);
  arm.command.tau[0] = -0.5;
  arm.command.tau[1] = 0.5;
  EXPECT_EQ(arm.answer_state(), kAccepted);
}

TEST(FollowingTest, AWholeStepIsFreeInTheCycleThatTurnsOn) {
  FakeArm arm(test_robot(2));
  ASSERT_TRUE(arm.run_until(kOff, kKeep));
  arm.command.tau[0] = -0.5;
  arm.command.tau[1] = 0.5;
  for (int i = 0; i < 6; ++i) EXPECT_EQ(arm.cycle_with(kRequestOn), kAccepted);
  EXPECT_EQ(arm.state->drive_state, kOn);
}

TEST(FollowingTest, TwoAnswersInOneCycleDoNotMakeTwoSteps) {
  FakeArm arm(test_robot(1));
  ASSERT_TRUE(arm.switch_on());
  arm.half_cycle();
  arm.half_cycle();
  arm.command.tau[0] = 0.5;
  arm.command.state_seq = arm.state->seq - 1;
  EXPECT_EQ(arm.driver->accept(arm.command), kAccepted);
  arm.command.tau[0] = 1.0;
  arm.command.state_seq = arm.state->seq;
  EXPECT_EQ(arm.driver->accept(arm.command), driver_status_t::VERDICT_RATE + 0);
  arm.command.tau[0] = -0.5;
  EXPECT_EQ(arm.driver->accept(arm.command), kAccepted);
}

TEST(ObedienceTest, RefusedCommandsAreCountedByReasonAndChangeNothing) {
  FakeArm arm(test_robot(2));
  ASSERT_TRUE(arm.switch_on());
  arm.command.tau[0] = 0.2;
  arm.cycle_with(kRequestOn);
  const joint_command_t good = arm.command;
  const auto refuse = [&](int verdict, auto change) {
    for (int i = 0; i < 60; ++i) {  // far enough apart not to trip; the controller goes on
      arm.half_cycle();
      arm.command = good;
      EXPECT_EQ(arm.answer_state(), kAccepted);
    }
    const std::int64_t before = arm.read_status().commands_refused[verdict];
    arm.half_cycle();
    arm.command = good;
    arm.command.state_seq = arm.state->seq;
    change(arm.command);
    EXPECT_EQ(arm.driver->accept(arm.command), verdict);
    EXPECT_EQ(arm.read_status().commands_refused[verdict], before + 1);
    arm.half_cycle();
    EXPECT_NEAR(arm.motors[0].torque_of(raw_command(arm.motors[0].last()).t), 0.2, 5e-3);
    EXPECT_EQ(arm.state->drive_state, kOn);
  };
  using Status = driver_status_t;
  refuse(Status::VERDICT_SIZE, [](auto& c) { c.num_joints = 3; });
  refuse(Status::VERDICT_SESSION, [](auto& c) { c.session = 41; });
  refuse(Status::VERDICT_CONTROLLER, [](auto& c) { c.controller = 8; });
  refuse(Status::VERDICT_REPLAYED, [](auto& c) { c.state_seq -= 1; });
  refuse(Status::VERDICT_STALE, [](auto& c) { c.state_seq += 1; });
  refuse(Status::VERDICT_NOT_FINITE, [](auto& c) { c.tau[1] = std::nan(""); });
  refuse(Status::VERDICT_REQUEST, [](auto& c) { c.request = 5; });
  refuse(Status::VERDICT_TORQUE, [](auto& c) { c.tau_gravity[1] = 8.5; });
  refuse(Status::VERDICT_RATE, [](auto& c) { c.tau[0] = 0.8; });
}

TEST(ObedienceTest, RecordedCommandsOfAnotherRunDoNothing) {
  FakeArm first(test_robot(1));
  std::vector<joint_command_t> log;
  ASSERT_TRUE(first.run_until(kOff, kKeep));
  for (int i = 0; i < 200; ++i) {
    first.cycle_with(kRequestOn);
    log.push_back(first.command);
  }
  ASSERT_EQ(first.state->drive_state, kOn);
  FakeArm second(test_robot(1));
  MemoryBus memory;
  const auto end = memory.attach();
  second.driver =
      std::make_unique<ArmDriver>(second.robot, std::vector{second.driver_ends[0].get()},
                                  ArmDriverOptions{.session = FakeArm::kSession + 1});
  for (const joint_command_t& old : log) {
    second.half_cycle();
    EXPECT_EQ(second.driver->accept(old), driver_status_t::VERDICT_SESSION + 0);
  }
  EXPECT_EQ(second.state->drive_state, kOff);
}

TEST(ObedienceTest, ThirdRefusalWithinATenthOfASecondIsAHold) {
  FakeArm arm(test_robot(1));
  ASSERT_TRUE(arm.switch_on());
  for (int refusal = 1; refusal <= 3; ++refusal) {
    arm.half_cycle();
    arm.command.tau[0] = std::nan("");
    arm.answer_state();
    arm.command.tau[0] = 0.0;
    EXPECT_EQ(arm.answer_state(), kAccepted);
    arm.half_cycle();
    EXPECT_EQ(arm.state->drive_state, refusal < 3 ? kOn : kFallback);
  }
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_COMMAND_REFUSED + 0);
  EXPECT_EQ(arm.driver->fault_text(arm.state->fault, -1, arm.driver->fault_detail()),
            "gate.NOT_FINITE: a torque of the command is not a finite number");
}

TEST(ObedienceTest, AnotherControllerWaitsForTheFirstToBeSilent) {
  FakeArm arm(test_robot(1));
  ASSERT_TRUE(arm.switch_on());
  arm.command.controller = FakeArm::kController + 1;
  // The first falls silent: HOLD at the third missing cycle, the second is heard after 250 cycles.
  int refused = 0;
  while (arm.cycle_with(kRequestOn) == driver_status_t::VERDICT_CONTROLLER && refused < 400)
    ++refused;
  EXPECT_NEAR(refused, 249, 1);
  EXPECT_EQ(arm.state->drive_state, kFallback);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_CONTROLLER_LOST + 0);
}

TEST(ObedienceTest, HoldRequestIsRefusedWhereNothingStands) {
  FakeArm arm(test_robot(1));
  ASSERT_TRUE(arm.run_until(kOff, kKeep));
  EXPECT_EQ(arm.cycle_with(kRequestHold), driver_status_t::VERDICT_NOT_ON + 0);
  ASSERT_TRUE(arm.run_until(kOn, kRequestOn));
  EXPECT_EQ(arm.cycle_with(kRequestHold), kAccepted);
  arm.half_cycle();
  EXPECT_EQ(arm.state->drive_state, kFallback);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_REQUESTED + 0);
}

TEST(ObedienceTest, OverrunsLeadToFallback) {
  FakeArm arm(test_robot(1));
  ASSERT_TRUE(arm.switch_on());
  arm.driver->report_overruns();
  arm.half_cycle();
  EXPECT_EQ(arm.state->drive_state, kFallback);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_OVERRUN + 0);
}

TEST(ObedienceTest, StatusCountsFramesAndLoad) {
  FakeArm arm(test_robot(2));
  ASSERT_TRUE(arm.run_until(kOff, kKeep));
  while (arm.cycle < 499) arm.cycle_with(kRequestOn);
  const driver_status_t& status = arm.read_status();
  EXPECT_EQ(status.cycles, 500);
  EXPECT_EQ(status.num_joints, 2);
  EXPECT_EQ(status.num_buses, 1);
  // One question every 20 cycles, beginning with the 20th of ON.
  const auto on = static_cast<std::size_t>(status.commands_accepted);
  const std::size_t asked = arm.motors[0].questions.size() + arm.motors[1].questions.size();
  EXPECT_TRUE(asked == (on - 20) / 20 || asked == on / 20) << asked;
  EXPECT_EQ(status.frames_sent[0], 1000 + static_cast<std::int64_t>(asked));
  EXPECT_EQ(status.frames_received[0], 1000 + static_cast<std::int64_t>(asked));
  EXPECT_GT(status.commands_accepted, 480);
  EXPECT_EQ(status.commands_missing, 0);
  // Four FD frames of 49 to 57 us in each millisecond.
  EXPECT_GT(status.bus_load_counted[0], 4 * 0.049F);
  EXPECT_LT(status.bus_load_counted[0], 4 * 0.057F);
  EXPECT_NEAR(status.bus_load_predicted[0], status.bus_load_counted[0],
              0.02 * status.bus_load_counted[0]);
}

TEST(ShutDownTest, BrakesThenDisables) {
  FakeArm arm(test_robot(2));
  ASSERT_TRUE(arm.switch_on());
  arm.driver->request_shut_down();
  for (int i = 0; i < 300; ++i) {
    arm.cycle_with(kRequestOn);
    ASSERT_EQ(arm.state->drive_state, joint_state_t::DRIVE_DAMP + 0);
    const auto raw = raw_command(arm.motors[0].last());
    EXPECT_EQ(raw.kp, 0);
    EXPECT_EQ(raw.kd, 819);  // 1 N m s/rad of 5
    EXPECT_FALSE(arm.driver->shut_down());
  }
  for (int i = 0; i < 12; ++i) arm.cycle_with(kRequestOn);
  EXPECT_TRUE(arm.driver->shut_down());
  EXPECT_EQ(arm.motors[0].error, 0);
  for (int i = 0; i < 50; ++i) arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kOff);  // and nobody switches it on again
  EXPECT_TRUE(arm.driver->shut_down());
}

}  // namespace
}  // namespace limber::test_arm_driver
