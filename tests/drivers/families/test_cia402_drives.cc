// An arm of CANopen drives: controlwords, torque, state, holding and faults, byte by byte.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/drive/joint_link.h"
#include "tests/drivers/families/fake_cia402.h"

namespace limber::test_cia402_drives {
namespace {

using testing::cia402_robot;
using testing::Cia402Arm;
using testing::FakeCia402;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kCount = kTurn / 65536.0;       // of the motor
constexpr double kLinkCount = kTurn / 262144.0;  // of the link
constexpr double kPermille = 0.028;              // N m

/// Everything that the drive was commanded since `from`, repetitions left out.
std::vector<std::string> said_since(const FakeCia402& motor, std::size_t from) {
  std::vector<std::string> said;
  for (std::size_t i = from; i < motor.heard.size(); ++i) {
    if (said.empty() || said.back() != motor.heard[i]) said.push_back(motor.heard[i]);
  }
  return said;
}

TEST(Cia402Enable, ThroughReadyAndSwitchedOnWithoutTorque) {
  Cia402Arm arm;
  ASSERT_TRUE(arm.start());
  const std::size_t from = arm.motors[0].heard.size();
  ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_ON, joint_command_t::REQUEST_ON));
  EXPECT_EQ(said_since(arm.motors[0], from),
            std::vector<std::string>({"203#06000000", "203#07000000", "203#0F000000"}));
  EXPECT_EQ(arm.motors[1].status(), testing::kOperationEnabled);
}

// A drive may open a brake first. 1.5 s; two are the most.
TEST(Cia402Enable, MayTakeItsTime) {
  Cia402Arm arm;
  ASSERT_TRUE(arm.start());
  arm.motors[1].stubborn = true;
  for (int i = 0; i < 1500; ++i) arm.cycle_with(joint_command_t::REQUEST_ON);
  EXPECT_EQ(arm.state->drive_state, int{joint_state_t::DRIVE_ENABLING});
  arm.motors[1].stubborn = false;
  EXPECT_TRUE(arm.run_until(joint_state_t::DRIVE_ON, joint_command_t::REQUEST_ON));
}

TEST(Cia402Enable, AFaultIsResetByAnEdge) {
  Cia402Arm arm;
  ASSERT_TRUE(arm.start());
  arm.motors[0].set_status(testing::kFault);
  arm.cycle_with(joint_command_t::REQUEST_KEEP);
  EXPECT_NE(arm.state->joint_flags[0] & joint_state_t::JOINT_DRIVE_ERROR, 0);
  const std::size_t from = arm.motors[0].heard.size();
  ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_ON, joint_command_t::REQUEST_ON));
  const std::vector<std::string> said = said_since(arm.motors[0], from);
  EXPECT_EQ(said.front(), "203#80000000");
  EXPECT_EQ(said.back(), "203#0F000000");
}

TEST(Cia402Enable, ADriveThatStaysOffIsAFault) {
  Cia402Arm arm;
  ASSERT_TRUE(arm.start());
  arm.motors[1].stubborn = true;
  EXPECT_FALSE(arm.run_until(joint_state_t::DRIVE_ON, joint_command_t::REQUEST_ON, 2100));
  EXPECT_EQ(arm.state->fault, int{joint_state_t::FAULT_DRIVE_ERROR});
  EXPECT_EQ(arm.state->fault_joint, 1);
}

// After HOLD the dialogue starts afresh, and the drive is disabled before it leaves operational.
TEST(Cia402Enable, OffFromHoldDisablesFirst) {
  Cia402Arm arm;
  ASSERT_TRUE(arm.switch_on());
  arm.cycle_with(joint_command_t::REQUEST_HOLD);
  arm.cycle_with(joint_command_t::REQUEST_HOLD);
  const std::size_t from = arm.motors[0].heard.size();
  arm.cycle_with(joint_command_t::REQUEST_OFF);
  ASSERT_TRUE(arm.start());
  const std::vector<std::string> said = said_since(arm.motors[0], from);
  const auto place = [&](const char* text) {
    return std::find(said.begin(), said.end(), text) - said.begin();
  };
  EXPECT_LT(place("203#00000000"), place("000#8003"));
  EXPECT_LT(place("000#8003"), place("000#0103"));
  EXPECT_EQ(arm.read_status().replies_invalid[0], 0);
  EXPECT_TRUE(arm.run_until(joint_state_t::DRIVE_ON, joint_command_t::REQUEST_ON));
}

TEST(Cia402Torque, InThousandthsOfTheRatedTorque) {
  Cia402Arm arm;
  ASSERT_TRUE(arm.switch_on());
  arm.command.tau[0] = 5.6;
  arm.command.tau[1] = 2.8;
  ASSERT_EQ(arm.cycle_with(joint_command_t::REQUEST_ON), int{driver_status_t::VERDICT_ACCEPTED});
  arm.half_cycle();
  EXPECT_EQ(arm.sent, std::vector<std::string>({"203#0F00C800", "204#0F009CFF", "080#"}));
  EXPECT_NEAR(arm.state->tau_applied[0], 5.6, 1e-12);
  EXPECT_NEAR(arm.state->tau_applied[1], 2.8, 1e-12);
}

TEST(Cia402Torque, IsExactInTheMeanAndNeverBeyondTheLimit) {
  JointLink link(cia402_robot().joints[0], true, 1e-3, 2);
  const auto permille = [&](double tau) {
    const CanFrame frame = link.torque(tau);
    return static_cast<std::int16_t>(frame.data[2] | frame.data[3] << 8);
  };
  for (double wanted : {0.01, -0.003, 1.2345}) {
    double sum = 0.0;
    for (int i = 0; i < 1000; ++i) sum += permille(wanted) * kPermille;
    EXPECT_NEAR(sum, 1000.0 * wanted, 1.001 * kPermille);
  }
  for (double wanted : {13.99999, 14.0, 14.1, 1e9}) {
    for (int i = 0; i < 20; ++i) {
      EXPECT_LE(permille(wanted), 500);
      EXPECT_GE(permille(-wanted), -500);
    }
  }
}

TEST(Cia402Torque, WhatIsNotFiniteIsNotSent) {
  for (double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    for (const JointCommand& command : {JointCommand{0, 0, 0, bad}, JointCommand{bad, 1, 1, 0},
                                        JointCommand{0, bad, 0, 0}, JointCommand{0, 0, bad, 0}}) {
      JointLink link(cia402_robot().joints[0], true, 1e-3, 2);
      EXPECT_EQ(testing::text(link.command(command)), "080#");
      EXPECT_EQ(link.torque(0.28).data[2], 10);  // the next good one is as it should be
    }
  }
}

TEST(Cia402State, SignsOffsetsAndUnitsOfBothSides) {
  Cia402Arm arm;
  for (FakeCia402& motor : arm.motors) {
    motor.position = 3000;
    motor.velocity = -2000;
    motor.link_position = 12345;
    motor.link_velocity = -54321;
    motor.torque = 100;
    motor.current = -250;
  }
  ASSERT_TRUE(arm.start());
  const joint_state_t& state = arm.half_cycle();
  EXPECT_NEAR(state.theta[0], 3000 * kCount, 1e-12);
  EXPECT_NEAR(state.theta_dot[0], -2000 * kCount, 1e-12);
  EXPECT_EQ(state.q[0], state.theta[0]);
  EXPECT_EQ(state.v[0], state.theta_dot[0]);
  EXPECT_NEAR(state.tau[0], 2.8, 1e-12);
  EXPECT_NEAR(state.current_A[0], -0.25 * 28.0 / 0.5, 1e-6);
  EXPECT_EQ(state.joint_flags[0], int{joint_state_t::JOINT_FRESH});
  // Sign and offset are the motor's; the link encoder counts as the joint does.
  EXPECT_NEAR(state.theta[1], -(3000 * kCount - 0.3), 1e-12);
  EXPECT_NEAR(state.theta_dot[1], 2000 * kCount, 1e-12);
  EXPECT_NEAR(state.q[1], 12345 * kLinkCount, 1e-12);
  EXPECT_NEAR(state.v[1], -54321 * kLinkCount, 1e-12);
  EXPECT_NEAR(state.tau[1], -2.8, 1e-12);
  EXPECT_EQ(state.joint_flags[1], 1 + 16 + 32);  // fresh, link encoder, torque sensor
}

// The same from two and three frames; without a torque sensor the current is what the torque tells.
TEST(Cia402State, PutTogetherOfSeveralClassicFrames) {
  Cia402Arm arm(cia402_robot(false));
  for (FakeCia402& motor : arm.motors) {
    motor.position = 3000;
    motor.velocity = -2000;
    motor.link_position = 12345;
    motor.link_velocity = -54321;
    motor.torque = 100;
    motor.current = -250;
  }
  ASSERT_TRUE(arm.start());
  const joint_state_t& state = arm.half_cycle();
  EXPECT_NEAR(state.theta[0], 3000 * kCount, 1e-12);
  EXPECT_NEAR(state.theta_dot[0], -2000 * kCount, 1e-12);
  EXPECT_NEAR(state.tau[0], 2.8, 1e-12);
  EXPECT_NEAR(state.current_A[0], 2.8 / 0.5, 1e-6);
  EXPECT_NEAR(state.q[1], 12345 * kLinkCount, 1e-12);
  EXPECT_NEAR(state.v[1], -54321 * kLinkCount, 1e-12);
  EXPECT_NEAR(state.current_A[1], 0.25 * 28.0 / 0.5, 1e-6);
  EXPECT_EQ(state.age_cycles[0], 0);
  EXPECT_TRUE(arm.run_until(joint_state_t::DRIVE_ON, joint_command_t::REQUEST_ON));
  EXPECT_EQ(arm.read_status().replies_invalid[0], 0);
  EXPECT_EQ(arm.read_status().replies_invalid[1], 0);
}

TEST(Cia402State, HalfAStateIsNone) {
  for (const int number : {1, 2, 3}) {
    Cia402Arm arm(cia402_robot(false));
    ASSERT_TRUE(arm.switch_on());
    arm.motors[1].position += 20;
    arm.motors[1].withheld = {number};
    arm.half_cycle();
    EXPECT_EQ(arm.state->age_cycles[1], 1) << number;
    EXPECT_EQ(arm.read_status().replies_lost[1], 1);
    // What has come of this cycle does not complete the next one.
    arm.motors[1].withheld = {number == 1 ? 2 : 1};
    arm.half_cycle();
    EXPECT_EQ(arm.state->age_cycles[1], 2) << number;
    arm.motors[1].withheld = {};
    arm.half_cycle();
    EXPECT_EQ(arm.state->age_cycles[1], 0) << number;
    EXPECT_EQ(arm.read_status().replies_invalid[1], 0);
  }
}

// A TPDO that comes between the cycles belongs to the cycle before: the state is whole, and as old.
TEST(Cia402State, ALatePartCompletesItsOwnCycle) {
  Cia402Arm arm(cia402_robot(false));
  ASSERT_TRUE(arm.switch_on());
  FakeCia402& motor = arm.motors[0];
  motor.withheld = {2};
  for (const int velocity : {100, 200, 300}) {
    const int position = motor.position;
    arm.half_cycle();
    motor.position += 10;
    CanFrame second;
    second.id = 0x283;
    second.length = 6;
    second.data[0] = static_cast<std::uint8_t>(velocity);
    second.data[1] = static_cast<std::uint8_t>(velocity >> 8);
    arm.motor_ends[0]->send(second);
    arm.half_cycle();
    EXPECT_EQ(arm.state->age_cycles[0], 1);
    EXPECT_NEAR(arm.state->theta[0], position * kCount, 1e-12);
    EXPECT_NEAR(arm.state->theta_dot[0], velocity * kCount, 1e-12);
    motor.withheld = {};
    arm.half_cycle();
    EXPECT_EQ(arm.state->age_cycles[0], 0);
    EXPECT_NEAR(arm.state->theta[0], motor.position * kCount, 1e-12);
    EXPECT_EQ(arm.state->theta_dot[0], 0.0);
    motor.withheld = {2};
  }
  EXPECT_EQ(arm.read_status().replies_invalid[0], 0);
}

TEST(Cia402State, ATpdoThatComesTwiceOrTooShortIsInvalid) {
  Cia402Arm arm(cia402_robot(false));
  ASSERT_TRUE(arm.switch_on());
  arm.motors[1].withheld = {3};
  const auto say = [&](std::uint32_t id, std::uint8_t length) {
    CanFrame frame;
    frame.id = id;
    frame.length = length;
    arm.motor_ends[0]->send(frame);
  };
  arm.on_bus = [&](int, const std::vector<std::string>&) {
    say(0x184, 6);
    say(0x384, 7);
    say(0x484, 8);  // one that nobody uses
  };
  arm.half_cycle();
  EXPECT_EQ(arm.read_status().replies_invalid[1], 2);
  EXPECT_EQ(arm.state->age_cycles[1], 1);
  EXPECT_EQ(arm.read_status().frames_foreign[0], 0);
}

// The link: 5 rad/s for 1 ms, half as much again: 7.5 mrad = 312.9 counts, and two. The motor winds
// up its spring besides, by 14000 N m/s over 5000 N m/rad: 11.7 mrad = 122.0 counts, and two.
TEST(Cia402State, JumpsOfEitherSideAreRefused) {
  for (const auto& [motor_counts, link_counts, taken] :
       {std::tuple{124, 0, true}, {125, 0, false}, {0, -314, true}, {0, -315, false}}) {
    Cia402Arm arm;
    ASSERT_TRUE(arm.switch_on());
    arm.motors[1].position += motor_counts;
    arm.motors[1].link_position += link_counts;
    arm.half_cycle();
    EXPECT_EQ(arm.state->age_cycles[1], taken ? 0 : 1) << motor_counts << " " << link_counts;
    EXPECT_EQ(arm.read_status().replies_invalid[1], taken ? 0 : 1);
  }
}

TEST(Cia402State, ThePositionLimitIsTheLinks) {
  for (const auto& [motor, link, tripped] :
       {std::tuple{2.1, 2.0, false}, {1.9, 2.021, true}, {1.9, 2.019, false}}) {
    Cia402Arm arm;
    arm.motors[1].position = static_cast<int>((-motor + 0.3) / kCount);
    arm.motors[1].link_position = static_cast<int>(link / kLinkCount);
    ASSERT_TRUE(arm.start());
    arm.half_cycle();
    EXPECT_EQ((arm.state->joint_flags[1] & joint_state_t::JOINT_OUT_OF_RANGE) != 0, tripped);
    EXPECT_EQ(arm.run_until(joint_state_t::DRIVE_ON, joint_command_t::REQUEST_ON), !tripped);
  }
}

TEST(Cia402State, WhatElseTheNodeSaysIsNeitherForeignNorInvalid) {
  Cia402Arm arm;
  ASSERT_TRUE(arm.switch_on());
  const auto say = [&](std::uint32_t id, std::uint8_t length) {
    CanFrame frame;
    frame.id = id;
    frame.length = length;
    arm.motor_ends[0]->send(frame);
  };
  const auto say_the_rest = [&](int, const std::vector<std::string>&) {
    say(0x083, 8);  // emergency
    say(0x703, 1);  // heartbeat
    say(0x583, 8);  // an SDO answer
  };
  arm.on_bus = say_the_rest;
  arm.half_cycle();
  say_the_rest(0, {});  // between the cycles
  arm.half_cycle();
  EXPECT_EQ(arm.read_status().replies_invalid[0], 0);
  EXPECT_EQ(arm.read_status().replies_late[0], 0);
  EXPECT_EQ(arm.read_status().frames_foreign[0], 0);
  EXPECT_EQ(arm.state->age_cycles[0], 0);
  arm.on_bus = [&](int, const std::vector<std::string>&) {
    say(0x085, 8);  // of a node that nobody knows
    say(0x185, 8);
    say(0x183, 4);  // too short to be a state
  };
  arm.half_cycle();
  EXPECT_EQ(arm.read_status().frames_foreign[0], 2);
  EXPECT_EQ(arm.read_status().replies_invalid[0], 1);
}

TEST(Cia402Sync, OnceACycleOnEachBusAfterAllCommands) {
  Robot robot = cia402_robot();
  robot.buses.push_back(robot.buses[0]);
  robot.joints[1].drive.bus = 1;
  Cia402Arm arm(robot);
  std::int64_t cycles = 0;
  arm.on_bus = [&](int, const std::vector<std::string>& sent) {
    ++cycles;
    ASSERT_FALSE(sent.empty());
    EXPECT_EQ(sent.back(), "080#");
    EXPECT_EQ(std::count(sent.begin(), sent.end(), "080#"), 1);
    EXPECT_LE(sent.size(), 2U);
  };
  ASSERT_TRUE(arm.switch_on());
  arm.cycle_with(joint_command_t::REQUEST_HOLD);
  for (int i = 0; i < 10; ++i) arm.half_cycle();
  EXPECT_EQ(cycles, 2 * (arm.cycle + 1));
}

// The drive has neither spring nor damper: the driver computes them of what it saw last.
TEST(Cia402Hold, DampsFirstAndThenHoldsWhereTheMotorIs) {
  Cia402Arm arm;
  ASSERT_TRUE(arm.switch_on());
  FakeCia402& motor = arm.motors[1];  // sign -1, kp 50, kd 1
  motor.velocity = 16384;             // a quarter of a turn a second, at the drive
  arm.command.tau_gravity[1] = 1.4;
  arm.cycle_with(joint_command_t::REQUEST_HOLD);
  arm.half_cycle();
  ASSERT_EQ(arm.state->drive_state, int{joint_state_t::DRIVE_HOLD});
  const double damping = -1.0 * kTurn / 4.0;
  EXPECT_NEAR(motor.permille() * kPermille, -1.4 + damping, 0.5001 * kPermille);
  EXPECT_NEAR(arm.state->tau_applied[1], 1.4 - damping, 0.5001 * kPermille);
  motor.velocity = 0;
  for (int i = 0; i < 110; ++i) arm.cycle_with(joint_command_t::REQUEST_HOLD);
  motor.position += 60;
  arm.cycle_with(joint_command_t::REQUEST_HOLD);  // sees it
  double mean = 0.0;
  for (int i = 0; i < 50; ++i) {
    arm.cycle_with(joint_command_t::REQUEST_HOLD);
    mean += motor.permille() * kPermille / 50.0;
  }
  EXPECT_NEAR(mean, -1.4 - 50.0 * 60 * kCount, 0.03 * kPermille);
  EXPECT_EQ(motor.controlword(), 0x0F);
}

TEST(Cia402Hold, NoLoopIsClosedOnWhatIsTooOld) {
  Cia402Arm arm;
  ASSERT_TRUE(arm.switch_on());
  FakeCia402& motor = arm.motors[0];
  motor.velocity = 8192;
  arm.command.tau_gravity[0] = 2.8;
  arm.half_cycle();
  motor.silent = true;
  for (int i = 0; i < 3; ++i) arm.cycle_with(joint_command_t::REQUEST_KEEP);
  ASSERT_EQ(arm.state->drive_state, int{joint_state_t::DRIVE_HOLD});
  EXPECT_EQ(arm.state->fault, int{joint_state_t::FAULT_REPLY_LOST});
  EXPECT_EQ(arm.state->fault_joint, 0);
  arm.half_cycle();
  EXPECT_EQ(motor.permille(), 100);  // gravity alone
  EXPECT_EQ(motor.controlword(), 0x0F);
}

TEST(Cia402Faults, ADriveThatLeavesEnabledIsNotSpokenToAsIfItHadNot) {
  for (int status : {testing::kFault, testing::kSwitchOnDisabled, 0x0217}) {
    Cia402Arm arm;
    ASSERT_TRUE(arm.switch_on());
    arm.motors[0].set_status(status);
    arm.cycle_with(joint_command_t::REQUEST_ON);
    EXPECT_EQ(arm.state->drive_state, int{joint_state_t::DRIVE_HOLD});
    EXPECT_EQ(arm.state->fault, int{joint_state_t::FAULT_DRIVE_ERROR});
    const std::size_t heard = arm.motors[0].heard.size();
    arm.cycle_with(joint_command_t::REQUEST_KEEP);
    EXPECT_EQ(arm.motors[0].heard.size(), heard);
    EXPECT_EQ(arm.sent.size(), 2U);  // the other one's torque, and the SYNC
  }
}

TEST(Cia402Faults, ShutDownDisablesEveryDrive) {
  Cia402Arm arm;
  ASSERT_TRUE(arm.switch_on());
  arm.driver->request_shut_down();
  for (int i = 0; i < 400 && !arm.driver->shut_down(); ++i) arm.half_cycle();
  EXPECT_TRUE(arm.driver->shut_down());
  for (const FakeCia402& motor : arm.motors) EXPECT_EQ(motor.status(), testing::kSwitchOnDisabled);
}

}  // namespace
}  // namespace limber::test_cia402_drives
