// Joints as a whole: position limits, and two motors that pull against each other.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "tests/drivers/fake_arm.h"

namespace limber::test_arm_joint {
namespace {

using testing::FakeArm;
using testing::raw_command;
using testing::test_robot;

constexpr double kAngleCount = 25.0 / 65535.0;  // range +-12.5 rad
constexpr double kSpeedCount = 60.0 / 4095.0;   // range +-30 rad/s
constexpr double kTorqueCount = 20.0 / 4095.0;  // range +-10 N m
constexpr std::size_t kFirst = 1, kSecond = 2;  // motors of joint 1

/// A joint with one motor (id 1), one with two (ids 2 and 5). Motor 2 counts backwards with its
/// zero at 0.3 rad, motor 5 forwards with its zero at -0.2 rad; they may wind up 0.5 rad, and make
/// 9.5 N m each, where the joint may have 8.
Robot robot_with_a_pair() {
  Robot robot = test_robot(2);
  JointConfig& joint = robot.joints[1];
  joint.transmission.kind = TransmissionKind::kAntagonistic;
  joint.transmission.preload_max_rad = 0.5;
  joint.drive.peak_torque_Nm = 9.5;
  testing::add_second_motor(&joint);
  joint.antagonist.sign = 1.0;
  joint.antagonist.offset_rad = -0.2;
  return robot;
}

/// Sets what the drives of the pair measure.
void place(FakeArm* arm, double theta_1, double theta_2) {
  arm->motors[kFirst].angle = -theta_1 + 0.3;
  arm->motors[kSecond].angle = theta_2 - 0.2;
}

/// Torque that the drive's last frame asks for, in the motor's own direction at the joint.
double asked(const FakeArm& arm, std::size_t motor) {
  const double sign = motor == kFirst ? -1.0 : 1.0;
  return sign * (-10.0 + raw_command(arm.motors[motor].last()).t * kTorqueCount);
}

TEST(ArmJoint, PositionTripLies20MilliradiansOutside) {
  for (double sign : {1.0, -1.0}) {
    for (double beyond : {0.0, 0.019, 0.021}) {
      FakeArm arm(test_robot(1));
      arm.half_cycle();
      arm.set_angle(0, sign * (2.0 + beyond));
      ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_OFF, joint_command_t::REQUEST_KEEP));
      arm.half_cycle();
      EXPECT_EQ((arm.state->joint_flags[0] & joint_state_t::JOINT_OUT_OF_RANGE) != 0,
                beyond > 0.02);
    }
  }
}

TEST(TwoMotors, StateIsEquilibriumAndPreload) {
  FakeArm arm(robot_with_a_pair());
  place(&arm, 0.5, -0.1);
  arm.motors[kFirst].speed = -0.6;  // theta_1' = 0.6
  arm.motors[kSecond].speed = 0.2;
  arm.motors[kFirst].torque = -3.0;  // tau_1 = 3
  arm.motors[kSecond].torque = 1.0;
  ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_OFF, joint_command_t::REQUEST_KEEP));
  arm.half_cycle();
  const joint_state_t& state = *arm.state;
  EXPECT_NEAR(state.theta[1], 0.3, kAngleCount);
  EXPECT_NEAR(state.preload[1], 0.2, kAngleCount);
  EXPECT_NEAR(state.theta_dot[1], 0.2, kSpeedCount);
  EXPECT_NEAR(state.preload_dot[1], 0.4, kSpeedCount);
  EXPECT_NEAR(state.tau[1], 2.0, kTorqueCount);
  EXPECT_EQ(state.q[1], state.theta[1]) << "no link encoder";
  EXPECT_EQ(state.v[1], state.theta_dot[1]);
  EXPECT_EQ(state.joint_flags[1], 1 + 64);  // fresh, two motors
  EXPECT_EQ(state.joint_flags[0], int{joint_state_t::JOINT_FRESH});
  EXPECT_EQ(state.preload[0], 0.0F);
  EXPECT_EQ(state.num_joints, 2);
}

TEST(TwoMotors, TorqueIsSplit) {
  FakeArm arm(robot_with_a_pair());
  ASSERT_TRUE(arm.switch_on());
  const auto send = [&](double tau, double preload) {
    arm.command.tau[1] = tau;
    arm.command.tau_preload[1] = preload;
    ASSERT_EQ(arm.cycle_with(joint_command_t::REQUEST_ON), int{driver_status_t::VERDICT_ACCEPTED});
  };
  for (int i = 1; i <= 6; ++i) send(0.4 * i, 1.0 * i);  // steps of at most 0.5 and 1 N m
  double first = 0.0;
  double second = 0.0;
  for (int i = 0; i < 100; ++i) {
    send(2.4, 6.0);
    first += asked(arm, kFirst) / 100.0;
    second += asked(arm, kSecond) / 100.0;
  }
  EXPECT_NEAR(first, 4.2, 0.02 * kTorqueCount);
  EXPECT_NEAR(second, 1.8, 0.02 * kTorqueCount);
  EXPECT_NEAR(arm.state->tau_applied[1], 2.4, 2.0 * kTorqueCount);
}

TEST(TwoMotors, PreloadStepsFromWhatIsPresent) {
  FakeArm arm(robot_with_a_pair());
  ASSERT_TRUE(arm.switch_on());
  arm.command.tau_preload[1] = 1.01;
  EXPECT_EQ(arm.cycle_with(joint_command_t::REQUEST_ON), int{driver_status_t::VERDICT_RATE});
  arm.command.tau_preload[1] = 1.0;
  EXPECT_EQ(arm.cycle_with(joint_command_t::REQUEST_ON), int{driver_status_t::VERDICT_ACCEPTED});
  arm.command.tau_preload[1] = 2.0;
  EXPECT_EQ(arm.cycle_with(joint_command_t::REQUEST_ON), int{driver_status_t::VERDICT_ACCEPTED});
}

TEST(TwoMotors, EachMayDoWhatItsDriveCan) {
  FakeArm arm(robot_with_a_pair());
  ASSERT_TRUE(arm.switch_on());
  const auto verdict = [&](double tau, double preload) {
    arm.command.tau[1] = tau;
    arm.command.tau_preload[1] = preload;
    return arm.cycle_with(joint_command_t::REQUEST_ON);
  };
  for (int i = 1; i <= 19; ++i)
    ASSERT_EQ(verdict(0.0, i), int{driver_status_t::VERDICT_ACCEPTED}) << i;
  EXPECT_EQ(verdict(0.0, 19.01), int{driver_status_t::VERDICT_TORQUE});
  EXPECT_EQ(verdict(0.01, 19.0), int{driver_status_t::VERDICT_TORQUE});
  EXPECT_EQ(verdict(0.4, 18.6), int{driver_status_t::VERDICT_ACCEPTED});
  arm.half_cycle();
  EXPECT_NEAR(asked(arm, kFirst), 9.5, 2.0 * kTorqueCount);
  EXPECT_NEAR(asked(arm, kSecond), 9.1, 2.0 * kTorqueCount);
}

TEST(TwoMotors, HoldKeepsBothMotorsAndTheirPreload) {
  FakeArm arm(robot_with_a_pair());
  place(&arm, 0.5, -0.1);
  ASSERT_TRUE(arm.switch_on());
  arm.command.tau_gravity[1] = 0.8;
  for (int i = 1; i <= 4; ++i) {
    arm.command.tau_preload[1] = 1.0 * i;
    arm.cycle_with(joint_command_t::REQUEST_ON);
  }
  for (int i = 0; i < 110; ++i) arm.cycle_with(joint_command_t::REQUEST_HOLD);
  ASSERT_EQ(arm.state->drive_state, int{joint_state_t::DRIVE_HOLD});
  EXPECT_NEAR(asked(arm, kFirst), (4.0 + 0.8) / 2.0, kTorqueCount);
  EXPECT_NEAR(asked(arm, kSecond), (4.0 - 0.8) / 2.0, kTorqueCount);
  for (std::size_t motor : {kFirst, kSecond}) {
    const testing::RawCommand raw = raw_command(arm.motors[motor].last());
    EXPECT_EQ(raw.kp, 410);  // 50 of 500
    EXPECT_EQ(raw.kd, 819);  // 1 of 5
    EXPECT_NEAR(-12.5 + raw.p * kAngleCount, arm.motors[motor].angle, kAngleCount);
  }
  // Taking over steps from what the drives exert, preload included.
  EXPECT_EQ(arm.cycle_with(joint_command_t::REQUEST_ACKNOWLEDGE),
            int{driver_status_t::VERDICT_ACCEPTED});
  arm.command.tau[1] = 0.8;
  arm.command.tau_preload[1] = 0.0;
  EXPECT_EQ(arm.cycle_with(joint_command_t::REQUEST_ON), int{driver_status_t::VERDICT_RATE});
  arm.command.tau_preload[1] = 4.0;
  EXPECT_EQ(arm.cycle_with(joint_command_t::REQUEST_ON), int{driver_status_t::VERDICT_ACCEPTED});
  EXPECT_EQ(arm.half_cycle().drive_state, int{joint_state_t::DRIVE_ON});
}

TEST(TwoMotors, TheJointIsAsBadAsItsWorseMotor) {
  for (std::size_t motor : {kFirst, kSecond}) {
    FakeArm arm(robot_with_a_pair());
    ASSERT_TRUE(arm.switch_on());
    arm.motors[motor].silent = true;
    arm.cycle_with(joint_command_t::REQUEST_ON);
    EXPECT_EQ(arm.state->age_cycles[1], 1);
    EXPECT_EQ(arm.state->joint_flags[1] & joint_state_t::JOINT_FRESH, 0);
    for (int i = 0; i < 2; ++i) arm.cycle_with(joint_command_t::REQUEST_ON);
    EXPECT_EQ(arm.state->fault, int{joint_state_t::FAULT_REPLY_LOST});
    EXPECT_EQ(arm.state->fault_joint, 1);
    EXPECT_EQ(arm.read_status().replies_lost[1], 3);
  }
}

TEST(TwoMotors, AnErrorOfEitherDriveIsTheJoints) {
  for (std::size_t motor : {kFirst, kSecond}) {
    FakeArm arm(robot_with_a_pair());
    ASSERT_TRUE(arm.switch_on());
    arm.motors[motor].error = 0xA;
    arm.cycle_with(joint_command_t::REQUEST_ON);
    EXPECT_EQ(arm.state->fault, int{joint_state_t::FAULT_DRIVE_ERROR});
    EXPECT_EQ(arm.state->fault_joint, 1);
    EXPECT_EQ(arm.state->joint_flags[1] & joint_state_t::JOINT_ENABLED, 0);
    EXPECT_NE(arm.state->joint_flags[1] & joint_state_t::JOINT_DRIVE_ERROR, 0);
  }
}

// The link may go to 2 rad and each motor 0.5 rad further, where it winds up.
TEST(TwoMotors, LimitsOfTheLinkAndOfEachMotor) {
  for (const auto& [theta_1, theta_2, out] : {std::tuple{2.51, -1.4, false},
                                              {2.53, -1.4, true},
                                              {1.4, -2.53, true},
                                              {2.1, -2.1, true},
                                              {2.5, 2.5, false}}) {
    FakeArm arm(robot_with_a_pair());
    place(&arm, theta_1, theta_2);
    ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_OFF, joint_command_t::REQUEST_KEEP));
    EXPECT_EQ((arm.state->joint_flags[1] & joint_state_t::JOINT_OUT_OF_RANGE) != 0, out)
        << theta_1 << " " << theta_2;
  }
}

// 7.5 mrad a cycle for the link; a motor may turn and wind at once: 15 mrad = 39.3 counts, and two.
TEST(TwoMotors, AMotorMayWindWhileItTurns) {
  for (int counts : {41, 42}) {
    FakeArm arm(robot_with_a_pair());
    ASSERT_TRUE(arm.switch_on());
    arm.motors[kSecond].angle += counts * kAngleCount;
    arm.half_cycle();
    EXPECT_EQ(arm.state->age_cycles[1], counts == 41 ? 0 : 1);
  }
}

TEST(TwoMotors, TheSecondMotorIsNamed) {
  FakeArm arm(robot_with_a_pair());
  arm.motors[kSecond].set_float(23, 28.0);
  for (int i = 0; i < 12; ++i) arm.half_cycle();
  EXPECT_EQ(arm.state->fault_joint, 1);
  EXPECT_EQ(arm.driver->configuration_problem(),
            "joint2 (antagonist) (id 0x5): register 23 is 28, expected 10");
}

}  // namespace
}  // namespace limber::test_arm_joint
