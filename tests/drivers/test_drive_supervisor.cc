// Watchdogs and fallbacks: what is bridged, what trips, what the drives are then told.
#include <gtest/gtest.h>

#include <cmath>

#include "drivers/drive/loss_window.h"
#include "tests/drivers/fake_arm.h"
#include "tests/drivers/faulty_bus.h"

namespace limber::test_drive_supervisor {
namespace {

using testing::FakeArm;
using testing::is_special;
using testing::raw_command;
using testing::test_robot;

constexpr int kRequestOn = joint_command_t::REQUEST_ON;
constexpr int kOff = joint_state_t::DRIVE_OFF;
constexpr int kOn = joint_state_t::DRIVE_ON;
constexpr int kFallback = joint_state_t::DRIVE_HOLD;
constexpr int kDamp = joint_state_t::DRIVE_DAMP;
constexpr int kFault = joint_state_t::DRIVE_FAULT;

constexpr int kKp50 = 410;  // of 500 N m/rad in 4095
constexpr int kKd1 = 819;   // of 5 N m s/rad in 4095

double torque_sent(const FakeArm& arm, std::size_t motor) {
  return arm.robot.joints[motor].drive.sign *
         arm.motors[motor].torque_of(raw_command(arm.motors[motor].last()).t);
}

std::string text_of_fault(const FakeArm& arm) {
  return arm.driver->fault_text(arm.state->fault, arm.state->fault_joint,
                                arm.driver->fault_detail());
}

/// On, with 0.4 N m of which 0.3 hold gravity, on every joint.
FakeArm loaded_arm(int joints, int buses = 1) {
  FakeArm arm(test_robot(joints, buses));
  EXPECT_TRUE(arm.switch_on());
  for (int i = 0; i < joints; ++i) {
    arm.command.tau[i] = 0.4;
    arm.command.tau_gravity[i] = 0.3;
  }
  for (int i = 0; i < 5; ++i) EXPECT_EQ(arm.cycle_with(kRequestOn), 0);
  return arm;
}

TEST(ControllerLostTest, TwoCyclesAreBridgedTheThirdHolds) {
  FakeArm arm = loaded_arm(2);
  arm.half_cycle();  // sends the last torque that was accepted
  for (int missing = 1; missing <= 2; ++missing) {
    arm.half_cycle();
    EXPECT_EQ(arm.state->drive_state, kOn);
    EXPECT_NEAR(torque_sent(arm, 0), 0.4, 5e-3);
    EXPECT_EQ(raw_command(arm.motors[0].last()).kd, 0);
  }
  arm.half_cycle();
  EXPECT_EQ(arm.state->drive_state, kFallback);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_CONTROLLER_LOST + 0);
  EXPECT_EQ(arm.read_status().commands_missing, 3);
}

TEST(ControllerLostTest, GravityAndDampingThenThePositionReached) {
  FakeArm arm = loaded_arm(2);
  for (int i = 0; i < 4; ++i) arm.half_cycle();
  ASSERT_EQ(arm.state->drive_state, kFallback);
  arm.set_speed(0, 1.0);
  for (int cycle = 1; cycle <= 100; ++cycle) {  // that was the first of them
    for (std::size_t j = 0; j < 2; ++j) {
      const auto raw = raw_command(arm.motors[j].last());
      EXPECT_EQ(raw.kp, 0) << cycle;
      if (cycle > 3 || j == 1) EXPECT_EQ(raw.kd, kKd1) << cycle;  // 1 N m in steps of 0.5 N m
      EXPECT_NEAR(torque_sent(arm, j), 0.3, 5e-3);
    }
    arm.set_angle(0, 0.1 * cycle / 100.0);  // sinks a little meanwhile
    arm.half_cycle();
  }
  arm.set_speed(0, 0.0);
  for (int cycle = 0; cycle < 500; ++cycle) {
    const auto raw = raw_command(arm.motors[0].last());
    EXPECT_EQ(raw.kp, kKp50);
    EXPECT_EQ(raw.kd, kKd1);
    EXPECT_NEAR(-12.5 + raw.p * 25.0 / 65535.0, 0.099, 1e-3);  // where it was when damping ended
    EXPECT_NEAR(torque_sent(arm, 0), 0.3, 5e-3);
    arm.half_cycle();
  }
  // The other joint counts the other way round from 0.3 rad.
  EXPECT_NEAR(-12.5 + raw_command(arm.motors[1].last()).p * 25.0 / 65535.0, 0.0, 5e-4);
  EXPECT_EQ(arm.state->drive_state, kFallback);
}

TEST(ControllerLostTest, AnAnswerInTimeResetsTheCount) {
  FakeArm arm = loaded_arm(1);
  for (int i = 0; i < 200; ++i) {
    arm.half_cycle();
    arm.half_cycle();
    arm.half_cycle();
    ASSERT_EQ(arm.answer_state(), 0);
    ASSERT_EQ(arm.state->drive_state, kOn);
  }
}

TEST(HoldTest, SpringGivesWayAtTheTorqueLimit) {
  FakeArm arm = loaded_arm(1);
  for (int i = 0; i < 110; ++i) arm.half_cycle();
  // Pushed by 1 rad: 50 N m/rad would be 50 N m; with 0.3 of gravity 7.7 are left: 0.154 rad.
  arm.set_speed(0, 0.2);
  for (int i = 0; i < 5000; ++i) {
    arm.set_angle(0, 1.0 * i / 5000.0);
    arm.half_cycle();
    EXPECT_LE(std::abs(arm.state->tau_applied[0]), 8.0 + 0.5);  // damping, and a cycle's motion
  }
  arm.half_cycle();
  const auto raw = raw_command(arm.motors[0].last());
  EXPECT_NEAR(-12.5 + raw.p * 25.0 / 65535.0, 0.9998 - 7.7 / 50.0, 1e-3);
}

TEST(ReplyLostTest, TwoAreBridgedTheThirdHoldsTheOthers) {
  FakeArm arm = loaded_arm(3);
  arm.motors[1].silent = true;
  for (int missing = 1; missing <= 2; ++missing) {
    arm.cycle_with(kRequestOn);
    EXPECT_EQ(arm.state->drive_state, kOn);
    EXPECT_EQ(arm.state->age_cycles[1], missing);
    EXPECT_EQ(arm.state->joint_flags[1] & joint_state_t::JOINT_FRESH, 0);
  }
  arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kFallback);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_REPLY_LOST + 0);
  EXPECT_EQ(arm.state->fault_joint, 1);
  EXPECT_EQ(arm.read_status().replies_lost[1], 3);
  for (int i = 0; i < 110; ++i) arm.cycle_with(kRequestOn);
  EXPECT_EQ(raw_command(arm.motors[0].last()).kp, kKp50);
  EXPECT_EQ(raw_command(arm.motors[1].last()).kp, 0);  // nobody knows where it is
  EXPECT_EQ(raw_command(arm.motors[1].last()).kd, kKd1);
  EXPECT_NEAR(torque_sent(arm, 1), 0.3, 5e-3);
  // When it is back for 50 ms it is held as well, where it is then; the fault stays.
  arm.motors[1].silent = false;
  arm.set_angle(1, 0.31);  // drive angle -0.01
  for (int i = 0; i < 50; ++i) {
    arm.cycle_with(kRequestOn);
    EXPECT_EQ(raw_command(arm.motors[1].last()).kp, 0);
  }
  arm.cycle_with(kRequestOn);
  EXPECT_EQ(raw_command(arm.motors[1].last()).kp, kKp50);
  EXPECT_NEAR(-12.5 + raw_command(arm.motors[1].last()).p * 25.0 / 65535.0, -0.01, 5e-4);
  EXPECT_EQ(arm.state->drive_state, kFallback);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_REPLY_LOST + 0);
}

TEST(ReplyLostTest, TenWithinASecondAreTooManyAsWell) {
  for (int gap : {110, 112}) {  // ten losses over 991 or 1009 cycles
    FakeArm arm = loaded_arm(2);
    for (int loss = 1; loss <= 10; ++loss) {
      ASSERT_EQ(arm.state->drive_state, kOn) << loss;
      arm.motors[0].silent = true;
      arm.cycle_with(kRequestOn);
      arm.motors[0].silent = false;
      for (int i = 1; i < gap && loss < 10; ++i) arm.cycle_with(kRequestOn);
    }
    EXPECT_EQ(arm.state->drive_state, gap == 110 ? kFallback : kOn);
  }
}

TEST(ReplyLostTest, AllSilentIsAHoldUntilTheDrivesOwnWatchdogsHaveActed) {
  FakeArm arm = loaded_arm(2);
  for (testing::FakeMotor& motor : arm.motors) motor.silent = true;
  for (int silent = 1; silent <= 22; ++silent) {
    arm.cycle_with(kRequestOn);
    EXPECT_EQ(arm.state->drive_state, silent < 3    ? kOn
                                      : silent < 20 ? kFallback
                                                    : kFault)
        << silent;
  }
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_REPLY_LOST + 0);
  EXPECT_EQ(arm.state->fault_joint, -1);
  EXPECT_TRUE(is_special(arm.motors[0].last(), 0xFD));
  EXPECT_TRUE(is_special(arm.motors[1].last(), 0xFD));
}

TEST(ReplyLostTest, TheJointIsNamedUnlessAllAreSilentForAsLong) {
  FakeArm arm = loaded_arm(2);
  arm.motors[0].silent = true;
  arm.cycle_with(kRequestOn);
  arm.motors[1].silent = true;
  for (int i = 0; i < 2; ++i) arm.cycle_with(kRequestOn);
  ASSERT_EQ(arm.state->fault, joint_state_t::FAULT_REPLY_LOST + 0);
  EXPECT_EQ(arm.state->fault_joint, 0);
  EXPECT_EQ(text_of_fault(arm), "joint1 (id 0x1): no reply for 3 cycles");
}

TEST(ReplyLostTest, AllOfThemAreNamedAndManySingleOnesAreToldAsSuch) {
  FakeArm silent = loaded_arm(2);
  for (testing::FakeMotor& motor : silent.motors) motor.silent = true;
  for (int i = 0; i < 3; ++i) silent.cycle_with(kRequestOn);
  ASSERT_EQ(silent.state->fault_joint, -1);
  EXPECT_EQ(text_of_fault(silent),
            "all drives, joint1 (id 0x1) to joint2 (id 0x2): no reply for 3 cycles");
  FakeArm often = loaded_arm(2);
  for (int i = 0; i < 100 && often.state->fault == joint_state_t::FAULT_NONE; ++i) {
    often.motors[1].silent = i % 5 == 0;
    often.cycle_with(kRequestOn);
  }
  EXPECT_EQ(text_of_fault(often),
            "joint2 (id 0x2): ten replies within a second missing or impossible");
}

TEST(ReplyLostTest, OnASimulatedBusInRealTimeTheSimulatorIsNamed) {
  Robot robot = test_robot(2);
  for (BusConfig& bus : robot.buses) bus.can = "virtual:test";
  FakeArm arm(robot);
  ASSERT_TRUE(arm.switch_on());
  for (testing::FakeMotor& motor : arm.motors) motor.silent = true;
  for (int i = 0; i < 3; ++i) arm.cycle_with(kRequestOn);
  EXPECT_NE(text_of_fault(arm).find("limber-sim ended or stood still"), std::string::npos);
}

TEST(OverrunTest, TheLongestIsTold) {
  FakeArm arm = loaded_arm(2);
  arm.driver->report_overruns(212'300'000);
  arm.cycle_with(kRequestOn);
  ASSERT_EQ(arm.state->fault, joint_state_t::FAULT_OVERRUN + 0);
  EXPECT_EQ(text_of_fault(arm), "limber-driver stood still, or took, 212 ms in a cycle of 1 ms");
}

TEST(ReplyLostTest, AStallOfTenCyclesEndsInAFirmHold) {
  FakeArm arm = loaded_arm(2);
  for (testing::FakeMotor& motor : arm.motors) motor.silent = true;
  for (int i = 0; i < 10; ++i) arm.cycle_with(kRequestOn);
  for (testing::FakeMotor& motor : arm.motors) motor.silent = false;
  for (int i = 0; i < 94; ++i) {
    arm.cycle_with(kRequestOn);
    EXPECT_NEAR(torque_sent(arm, 0), 0.3, 5e-3);  // never without its weight
  }
  EXPECT_EQ(raw_command(arm.motors[0].last()).kp, kKp50);
}

TEST(ReplyLostTest, ASilentDriveWhileOffMayHaveForgottenItsSettings) {
  FakeArm arm(test_robot(2));
  ASSERT_TRUE(arm.run_until(kOff, joint_command_t::REQUEST_KEEP));
  arm.motors[0].silent = true;
  for (int i = 0; i < 3; ++i) arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kFault);
}

TEST(ReplyLostTest, LateRepliesAreCountedAndACycleOld) {
  FakeArm arm = loaded_arm(2);
  arm.set_angle(0, 0.005);
  arm.driver->transmit(++arm.cycle * 1'000'000, 0);
  arm.driver->poll();
  const joint_state_t& state = arm.driver->finish_cycle();
  EXPECT_EQ(state.age_cycles[0], 1);
  arm.answer();  // too late
  arm.half_cycle();
  EXPECT_EQ(arm.read_status().replies_late[0], 1);
  EXPECT_EQ(arm.read_status().replies_lost[0], 0);
  EXPECT_EQ(arm.state->age_cycles[0], 0);  // by its own reply of this cycle
}

TEST(ReplyLostTest, ForeignFramesAreCounted) {
  FakeArm arm = loaded_arm(1);
  CanFrame foreign;
  foreign.length = 8;
  for (std::uint32_t id : {0x21U, 0x10U, 0x12U, 0x7FFU}) {
    foreign.id = id;
    arm.motor_ends[0]->send(foreign);
  }
  foreign.id = 0x11;
  foreign.extended = true;
  arm.motor_ends[0]->send(foreign);
  arm.half_cycle();
  EXPECT_EQ(arm.read_status().frames_foreign[0], 5);
  EXPECT_EQ(arm.state->drive_state, kOn);
}

// A pause of the messages' delivery is bridged also when all that was under way comes at once.
TEST(BridgeTest, LateAnswersAreBridgedLikeMissingOnes) {
  Robot robot = test_robot(2);
  for (JointConfig& joint : robot.joints) joint.drive.watchdog_s = 0.1;
  FakeArm arm(robot, false, 50);
  ASSERT_TRUE(arm.switch_on());
  joint_command_t late = arm.command;
  std::vector<std::int64_t> unanswered;
  for (int i = 0; i < 40; ++i) unanswered.push_back(arm.half_cycle().seq);
  for (std::int64_t seq : unanswered) {
    late.state_seq = seq;
    arm.driver->accept(late);
  }
  arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kOn);
}

// On a virtual bus, whose pauses are those of a scheduler, more is bridged.
TEST(ToleranceTest, AsManyCyclesAsWantedAreBridgedAndNotOneMore) {
  for (int bridged : {2, 3, 7, 50}) {
    Robot robot = test_robot(2);
    for (JointConfig& joint : robot.joints) joint.drive.watchdog_s = 0.1;
    FakeArm arm(robot, false, bridged);
    ASSERT_TRUE(arm.switch_on());
    arm.motors[0].silent = true;
    for (int i = 0; i < bridged; ++i) arm.cycle_with(kRequestOn);
    EXPECT_EQ(arm.state->drive_state, kOn) << bridged;
    arm.motors[0].silent = false;
    arm.cycle_with(kRequestOn);
    EXPECT_EQ(arm.state->age_cycles[0], 0);
    for (int i = 0; i < bridged; ++i) arm.half_cycle();
    EXPECT_EQ(arm.state->drive_state, kOn) << bridged;
    arm.cycle_with(kRequestOn);
    arm.motors[0].silent = true;
    for (int i = 0; i < bridged + 1; ++i) arm.cycle_with(kRequestOn);
    EXPECT_EQ(arm.state->drive_state, kFallback) << bridged;
    EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_REPLY_LOST + 0);
  }
}

TEST(ToleranceTest, FiveTimesAsManyWithinASecondAreTooMany) {
  LossWindow wire(2);
  LossWindow scheduler(50);
  int wire_losses = 0;
  int scheduler_losses = 0;
  for (std::int64_t cycle = 0; !wire.add(3 * cycle, 1000); ++cycle) ++wire_losses;
  for (std::int64_t cycle = 0; !scheduler.add(3 * cycle, 1000); ++cycle) ++scheduler_losses;
  EXPECT_EQ(wire_losses + 1, 10);
  EXPECT_EQ(scheduler_losses + 1, 250);
}

TEST(EncoderTest, OneGlitchIsRejectedAStepIsAFault) {
  FakeArm arm = loaded_arm(2);
  arm.set_angle(0, 0.5);
  arm.cycle_with(kRequestOn);
  EXPECT_NEAR(arm.state->q[0], 0.0, 4e-4);
  EXPECT_EQ(arm.read_status().replies_invalid[0], 1);
  arm.set_angle(0, 0.0);
  arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kOn);
  arm.set_angle(0, 0.5);
  for (int i = 0; i < 3; ++i) arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kFallback);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_REPLY_INVALID + 0);
  EXPECT_EQ(arm.state->fault_joint, 0);
  EXPECT_EQ(arm.read_status().replies_lost[0], 0) << "they came";
  for (int i = 0; i < 200; ++i) arm.cycle_with(kRequestOn);
  EXPECT_EQ(raw_command(arm.motors[0].last()).kp, 0);  // never held at an angle it is not at
}

// Its angle is told again, so that the loss can be acknowledged; it is held there only after that.
TEST(EncoderTest, AStepIsReportedAndHeldOnceAcknowledged) {
  FakeArm arm = loaded_arm(2);
  arm.set_angle(0, 0.5);
  for (int i = 0; i < 300; ++i) arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kFallback);
  EXPECT_NEAR(arm.state->q[0], 0.5, 4e-4);
  EXPECT_NE(arm.state->joint_flags[0] & joint_state_t::JOINT_FRESH, 0);
  EXPECT_EQ(raw_command(arm.motors[0].last()).kp, 0);
  arm.cycle_with(joint_command_t::REQUEST_ACKNOWLEDGE);
  arm.half_cycle();
  for (int j = 0; j < 2; ++j) arm.command.tau[j] = arm.state->tau_applied[j];
  arm.command.request = kRequestOn;
  arm.answer_state();
  arm.half_cycle();
  EXPECT_EQ(arm.state->drive_state, kOn);
}

TEST(DriveErrorTest, EveryErrorHoldsTheOthersAndIsNotTalkedOver) {
  for (int error : {0, 2, 7, 8, 9, 0xA, 0xB, 0xC, 0xD, 0xE, 0xF}) {
    FakeArm arm = loaded_arm(2);
    arm.motors[1].error = error;
    arm.cycle_with(kRequestOn);
    EXPECT_EQ(arm.state->drive_state, kFallback) << error;
    EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_DRIVE_ERROR + 0);
    EXPECT_EQ(arm.state->fault_joint, 1);
    EXPECT_EQ((arm.state->joint_flags[1] & joint_state_t::JOINT_DRIVE_ERROR) != 0, error > 1);
    for (int i = 0; i < 300; ++i) arm.cycle_with(kRequestOn);
    EXPECT_EQ(arm.motors[1].last().id, 0x7FFU);
    EXPECT_EQ(raw_command(arm.motors[0].last()).kp, kKp50);
    EXPECT_EQ(arm.state->drive_state, kFallback);
  }
}

TEST(DriveErrorTest, WhenNoDriveIsEnabledAnyMoreThereIsNothingToHold) {
  FakeArm arm = loaded_arm(2);
  for (testing::FakeMotor& motor : arm.motors) motor.error = 0xD;
  arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kFault);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_DRIVE_ERROR + 0);
}

// A tenth of a second, and 20 cycles at least: three here would be too few for all steps.
TEST(EnablingTest, LastsAsLongAsTheDrivesMayTakeAndNoCycleLonger) {
  for (const auto& [rate_hz, most] : {std::pair{1000.0, 100}, {30.0, 20}}) {
    Robot robot = test_robot(2);
    robot.rate_hz = rate_hz;
    FakeArm arm(robot);
    ASSERT_TRUE(arm.run_until(kOff, joint_command_t::REQUEST_KEEP));
    arm.motors[0].obedient = false;
    ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_ENABLING, kRequestOn));
    int cycles = 1;
    for (; arm.state->drive_state == joint_state_t::DRIVE_ENABLING && cycles < 1000; ++cycles)
      arm.cycle_with(kRequestOn);
    EXPECT_EQ(arm.state->drive_state, kFault);
    EXPECT_EQ(cycles, most) << rate_hz << " Hz";
    EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_DRIVE_ERROR + 0);
    EXPECT_EQ(arm.state->fault_joint, 0);
    EXPECT_EQ(arm.driver->fault_text(arm.state->fault, 0, arm.driver->fault_detail()),
              "did not enable in time (its state is disabled, without an error)");
  }
}

// While they brake as well: the state is told as it is, and a fault begins the start-up anew.
TEST(DriveErrorTest, WhenNoDriveIsEnabledInDampTheArmIsInFault) {
  FakeArm arm = loaded_arm(2);
  arm.set_speed(0, 5.6);
  for (int i = 0; i < 3; ++i) arm.cycle_with(kRequestOn);
  ASSERT_EQ(arm.state->drive_state, kDamp);
  for (testing::FakeMotor& motor : arm.motors) motor.error = 0;
  arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kFault);
}

TEST(EncoderTest, AnArmThatIsOffMaySwing) {
  FakeArm arm(test_robot(2));
  ASSERT_TRUE(arm.run_until(kOff, joint_command_t::REQUEST_KEEP));
  for (int i = 0; i < 100; ++i) {
    const double q = 0.1 * (i % 20);  // 100 rad/s, and back at once
    arm.set_angle(0, q);
    arm.cycle_with(joint_command_t::REQUEST_KEEP);
    EXPECT_NEAR(arm.state->q[0], q, 4e-4);
    EXPECT_EQ(arm.state->drive_state, kOff);
  }
  EXPECT_EQ(arm.read_status().replies_invalid[0], 0);
}

TEST(MotionTest, OutsideTheLimitsHolds) {
  FakeArm arm = loaded_arm(1);
  arm.set_speed(0, 5.0);
  for (double q = 0.0; q < 2.0195; q += 0.005) {
    arm.set_angle(0, q);
    arm.cycle_with(kRequestOn);
    ASSERT_EQ(arm.state->drive_state, kOn) << q;
  }
  arm.set_angle(0, 2.021);
  arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kFallback);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_POSITION + 0);
  EXPECT_NE(arm.state->joint_flags[0] & joint_state_t::JOINT_OUT_OF_RANGE, 0);
}

TEST(MotionTest, ThreeCyclesAbove110PercentOfTheVelocityBrake) {
  for (double v : {5.45, -5.45, 5.55, -5.55}) {  // limit 5 rad/s
    FakeArm arm = loaded_arm(2);
    arm.set_speed(1, v);
    for (int i = 0; i < 2; ++i) {
      arm.cycle_with(kRequestOn);
      EXPECT_EQ(arm.state->drive_state, kOn);
    }
    arm.cycle_with(kRequestOn);
    EXPECT_EQ(arm.state->drive_state, std::abs(v) > 5.5 ? kDamp : kOn);
  }
}

TEST(MotionTest, DampIsDampingAndNothingElse) {
  FakeArm arm = loaded_arm(2);
  arm.set_speed(1, 5.6);
  for (int i = 0; i < 3; ++i) arm.cycle_with(kRequestOn);
  arm.set_speed(1, 0.0);
  // 0.4 N m are gone at the torque's rate, 0.5 N m each cycle
  for (int i = 0; i < 2; ++i) arm.cycle_with(kRequestOn);
  for (int i = 0; i < 300; ++i) {
    arm.cycle_with(kRequestOn);
    for (std::size_t j = 0; j < 2; ++j) {
      const auto raw = raw_command(arm.motors[j].last());
      EXPECT_EQ(raw.kp, 0);
      EXPECT_EQ(raw.kd, kKd1);
      EXPECT_NEAR(torque_sent(arm, j), 0.0, 5e-3) << i;
    }
  }
  EXPECT_EQ(arm.state->drive_state, kDamp);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_VELOCITY + 0);
  EXPECT_EQ(arm.state->fault_joint, 1);
}

/// An arm whose driver looks through a faulty bus.
struct FaultyArm : FakeArm {
  FaultyArm(const Robot& from, std::vector<BusFault> faults) : FakeArm(from) {
    bus = std::make_unique<FaultyBus>(driver_ends[0].get(), std::move(faults), 1);
    std::vector<CanBus*> ends{bus.get()};
    for (std::size_t b = 1; b < driver_ends.size(); ++b) ends.push_back(driver_ends[b].get());
    driver = std::make_unique<ArmDriver>(from, ends, ArmDriverOptions{.session = kSession});
  }
  std::unique_ptr<FaultyBus> bus;
};

TEST(BusTest, AFullQueueDropsTheFrameAndTheNextCycleSendsANewerOne) {
  BusFault full{.kind = BusFault::Kind::kRefuse, .direction = BusFault::Direction::kSent};
  full.active = false;
  FaultyArm arm(test_robot(2), {full});
  ASSERT_TRUE(arm.switch_on());
  for (int refused = 1; refused <= 2; ++refused) {
    arm.bus->set_active(0, true);
    const std::size_t before = arm.motors[0].frames.size();
    for (int i = 0; i < refused; ++i) arm.cycle_with(kRequestOn);
    arm.bus->set_active(0, false);
    arm.command.tau[0] = 0.1 * refused;
    arm.cycle_with(kRequestOn);
    arm.cycle_with(kRequestOn);
    EXPECT_EQ(arm.motors[0].frames.size(), before + 2);  // nothing was queued
    EXPECT_NEAR(torque_sent(arm, 0), 0.1 * refused, 5e-3);
    EXPECT_EQ(arm.state->drive_state, kOn);
  }
  EXPECT_EQ(arm.read_status().send_refused[0], 6);
}

TEST(BusTest, RefusedInThreeCyclesIsABusFault) {
  BusFault full{.kind = BusFault::Kind::kRefuse, .direction = BusFault::Direction::kSent};
  full.active = false;
  FaultyArm arm(test_robot(4, 2), {full});
  ASSERT_TRUE(arm.switch_on());
  arm.bus->set_active(0, true);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(arm.state->drive_state, kOn);
    arm.cycle_with(kRequestOn);
  }
  EXPECT_EQ(arm.state->drive_state, kFallback);  // the joints on the other bus are held
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_BUS + 0);
  for (int i = 0; i < 110; ++i) arm.cycle_with(kRequestOn);
  EXPECT_EQ(raw_command(arm.motors[1].last()).kp, kKp50);
}

TEST(BusTest, BusOffOfTheOnlyBusIsAFault) {
  BusFault off{.kind = BusFault::Kind::kBusOff};
  off.active = false;
  FaultyArm arm(test_robot(2), {off});
  ASSERT_TRUE(arm.switch_on());
  arm.bus->set_active(0, true);
  arm.cycle_with(kRequestOn);
  EXPECT_NE(arm.state->drive_state, kOn);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_BUS + 0);
  for (int i = 0; i < 20; ++i) arm.cycle_with(kRequestOn);
  EXPECT_EQ(arm.state->drive_state, kFault);
}

TEST(BusTest, CorruptedAndDuplicatedRepliesDoNotCount) {
  BusFault flip{.kind = BusFault::Kind::kCorrupt};
  flip.id = 0x11;
  flip.id_mask = 0x7FF;
  flip.byte = 1;
  flip.flip = 0x40;  // 16384 counts: 6 rad
  flip.probability = 0.005;
  BusFault twice{.kind = BusFault::Kind::kDuplicate};
  FaultyArm arm(test_robot(2), {flip, twice});
  ASSERT_TRUE(arm.switch_on());
  for (int i = 0; i < 1000; ++i) {
    arm.cycle_with(kRequestOn);
    ASSERT_NEAR(arm.state->q[0], 0.0, 4e-4);
  }
  EXPECT_GT(arm.bus->hits(0), 0);
  EXPECT_GT(arm.read_status().replies_invalid[1], 900);  // each second copy
}

}  // namespace
}  // namespace limber::test_drive_supervisor
