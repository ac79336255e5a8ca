// The start-up dialogue with fake drives: every request by its bytes, every way to fail.
#include <gtest/gtest.h>

#include <cmath>

#include "drivers/drive/configure.h"
#include "drivers/protocols/mit.h"
#include "tests/drivers/fake_arm.h"

namespace limber::test_configure {
namespace {

using testing::FakeArm;
using testing::test_robot;

constexpr int kConfiguring = joint_state_t::DRIVE_CONFIGURING;
constexpr int kOff = joint_state_t::DRIVE_OFF;
constexpr int kFault = joint_state_t::DRIVE_FAULT;

void expect_bytes(const CanFrame& frame, std::uint32_t id, std::array<int, 8> bytes) {
  EXPECT_EQ(frame.id, id);
  EXPECT_TRUE(frame.fd && frame.bitrate_switch);
  ASSERT_EQ(frame.length, 8);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(frame.data[i], bytes[i]) << "byte " << i;
}

TEST(ConfigureTest, OneRequestACycleByteByByte) {
  FakeArm arm(test_robot(2));
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(arm.half_cycle().drive_state, i < 7 ? kConfiguring : kOff) << i;
  }
  arm.half_cycle();
  const std::vector<CanFrame>& f = arm.motors[1].frames;  // id 2
  ASSERT_EQ(f.size(), 9U);
  expect_bytes(f[0], 2, {0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFD});
  expect_bytes(f[1], 0x7FF, {2, 0, 0x33, 21, 0, 0, 0, 0});
  expect_bytes(f[2], 0x7FF, {2, 0, 0x33, 22, 0, 0, 0, 0});
  expect_bytes(f[3], 0x7FF, {2, 0, 0x33, 23, 0, 0, 0, 0});
  expect_bytes(f[4], 0x7FF, {2, 0, 0x55, 10, 1, 0, 0, 0});
  expect_bytes(f[5], 0x7FF, {2, 0, 0x33, 10, 0, 0, 0, 0});
  expect_bytes(f[6], 0x7FF, {2, 0, 0x55, 9, 0x90, 0x01, 0, 0});  // 20 ms = 400 * 50 us
  expect_bytes(f[7], 0x7FF, {2, 0, 0x33, 9, 0, 0, 0, 0});
  expect_bytes(f[8], 0x7FF, {2, 0, 0xCC, 0, 0, 0, 0, 0});  // OFF: polled, never commanded
  EXPECT_EQ(arm.motors[1].registers[9], 400U);
  EXPECT_EQ(arm.motors[1].registers[10], 1U);
}

TEST(ConfigureTest, ARangeThatIsNotRobotYamlsIsRefused) {
  for (int reg : {21, 22, 23}) {
    for (double factor : {0.5, 0.999, 1.001, -1.0, 0.0, std::nan("")}) {
      FakeArm arm(test_robot(2));
      const double right = reg == 21 ? 12.5 : reg == 22 ? 30.0 : 10.0;
      arm.motors[1].set_float(reg, right * factor);
      for (int i = 0; i < 12; ++i) arm.half_cycle();
      EXPECT_EQ(arm.state->drive_state, kFault) << reg << " " << factor;
      EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_CONFIGURATION + 0);
      EXPECT_EQ(arm.state->fault_joint, 1);
      EXPECT_NE(arm.driver->configuration_problem().find("joint2"), std::string::npos);
      EXPECT_NE(arm.driver->configuration_problem().find(std::to_string(reg)), std::string::npos);
      // Whatever the controller wants, the drives stay off.
      for (int i = 0; i < 50; ++i) arm.cycle_with(joint_command_t::REQUEST_ON);
      EXPECT_EQ(arm.state->drive_state, kFault);
      EXPECT_EQ(arm.motors[0].error, 0);
      EXPECT_TRUE(testing::is_special(arm.motors[0].last(), 0xFD));
    }
  }
}

TEST(ConfigureTest, Float32RoundingIsNoMismatch) {
  Robot robot = test_robot(1);
  robot.joints[0].drive.range.position_rad = 12.566;  // the drive holds 4 pi
  FakeArm arm(robot);
  arm.motors[0].set_float(21, 12.566370614);
  EXPECT_TRUE(arm.run_until(kOff, joint_command_t::REQUEST_KEEP, 12));
}

TEST(ConfigureTest, WritesThatDoNotTakeAreRefused) {
  FakeArm arm(test_robot(1));
  arm.motors[0].ignores_writes = true;
  for (int i = 0; i < 12; ++i) arm.half_cycle();
  EXPECT_EQ(arm.state->drive_state, kFault);
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_CONFIGURATION + 0);
}

TEST(ConfigureTest, AMotorLeftEnabledIsDisabledAndNeverCommanded) {
  FakeArm arm(test_robot(2));
  arm.motors[0].error = 1;  // somebody's leftover
  ASSERT_TRUE(arm.run_until(kOff, joint_command_t::REQUEST_KEEP, 20));
  EXPECT_EQ(arm.motors[0].error, 0);
  int disabled = 0;
  for (const CanFrame& frame : arm.motors[0].frames) {
    const bool disable = testing::is_special(frame, 0xFD);
    EXPECT_TRUE(frame.id == 0x7FF || disable);
    disabled += disable ? 1 : 0;
  }
  EXPECT_EQ(disabled,
            2);  // the reply to the first still said enabled; it is believed at the second
}

TEST(ConfigureTest, AMotorThatCannotBeDisabledIsRefused) {
  FakeArm arm(test_robot(2));
  arm.motors[1].error = 1;
  arm.motors[1].stubborn = true;
  for (int i = 0; i < 10; ++i) arm.half_cycle();
  EXPECT_EQ(arm.state->drive_state, kFault);
  EXPECT_EQ(arm.state->fault_joint, 1);
  EXPECT_NE(arm.driver->configuration_problem().find("could not be disabled"), std::string::npos);
}

TEST(ConfigureTest, AnAnswerThatWasNotAskedForYetDoesNotCount) {
  const DriveConfig drive = test_robot(1).joints[0].drive;
  const auto family = make_drive_family(test_robot(1).joints[0], true, 1e-3);
  ConfigureDialogue dialogue(family);
  testing::FakeMotor motor(drive);
  dialogue.start();
  dialogue.receive_state(false);
  dialogue.close_cycle();
  CanFrame pmax;
  CanFrame vmax;
  ASSERT_TRUE(
      motor.handle(mit::encode_register_read(1, mit::Register::kPositionRange, true), &pmax));
  ASSERT_TRUE(
      motor.handle(mit::encode_register_read(1, mit::Register::kVelocityRange, true), &vmax));
  EXPECT_FALSE(dialogue.receive(vmax));
  EXPECT_TRUE(dialogue.receive(pmax));
  EXPECT_FALSE(dialogue.receive(vmax));  // its question leaves in the next cycle
  dialogue.close_cycle();
  EXPECT_TRUE(dialogue.receive(vmax));
}

TEST(ConfigureTest, AStepIsTriedFourTimes) {
  for (int silent_cycles : {3, 4}) {
    FakeArm arm(test_robot(2));
    arm.half_cycle();
    arm.half_cycle();
    arm.motors[0].silent = true;
    for (int i = 0; i < silent_cycles; ++i) arm.half_cycle();
    arm.motors[0].silent = false;
    for (int i = 0; i < 12; ++i) arm.half_cycle();
    EXPECT_EQ(arm.state->drive_state, silent_cycles == 3 ? kOff : kFault);
  }
}

TEST(ConfigureTest, AcknowledgedFaultRunsTheWholeDialogueAgain) {
  FakeArm arm(test_robot(2));
  arm.motors[1].set_float(23, 28.0);
  for (int i = 0; i < 12; ++i) arm.cycle_with(joint_command_t::REQUEST_KEEP);
  ASSERT_EQ(arm.state->drive_state, kFault);
  arm.cycle_with(joint_command_t::REQUEST_ACKNOWLEDGE);
  ASSERT_TRUE(arm.run_until(kFault, joint_command_t::REQUEST_KEEP, 12));  // still wrong
  arm.motors[1].set_float(23, 10.0);
  arm.cycle_with(joint_command_t::REQUEST_ACKNOWLEDGE);
  ASSERT_TRUE(arm.run_until(kOff, joint_command_t::REQUEST_KEEP, 12));
  EXPECT_EQ(arm.state->fault, joint_state_t::FAULT_NONE + 0);
}

TEST(ConfigureTest, AStateBeforeTheFirstReplyIsMarkedUnknown) {
  FakeArm arm(test_robot(2));
  arm.motors[0].silent = true;
  arm.set_angle(0, 0.7);
  arm.half_cycle();
  EXPECT_EQ(arm.state->q[0], 0.0);
  EXPECT_GT(arm.state->age_cycles[0], 1'000'000);
  EXPECT_EQ(arm.state->joint_flags[0] & joint_state_t::JOINT_FRESH, 0);
  EXPECT_NE(arm.state->joint_flags[1] & joint_state_t::JOINT_FRESH, 0);
  arm.motors[0].silent = false;
  for (int i = 0; i < 12; ++i) arm.half_cycle();
  EXPECT_NEAR(arm.state->q[0], 0.7, 4e-4);
  EXPECT_EQ(arm.state->age_cycles[0], 0);
}

TEST(ConfigureTest, AnArmThatMovesMeanwhileIsFoundWhereItIs) {
  FakeArm arm(test_robot(1));
  for (int i = 0; i < 20; ++i) {
    arm.set_angle(0, 0.006 * i);  // 6 rad/s: faster than the joint's limit, slower than impossible
    arm.half_cycle();
  }
  EXPECT_EQ(arm.state->drive_state, kOff);
  EXPECT_EQ(arm.state->age_cycles[0], 0);
  EXPECT_NEAR(arm.state->q[0], 0.006 * 19, 4e-4);
  EXPECT_EQ(arm.read_status().replies_invalid[0], 0);
}

TEST(ConfigureTest, SetUpThatCannotWorkIsRefused) {
  const auto start = [](const Robot& robot, std::size_t buses, std::int64_t session = 1) {
    MemoryBus memory;
    const auto end = memory.attach();
    ArmDriver driver(robot, std::vector<CanBus*>(buses, end.get()), {.session = session});
  };
  EXPECT_NO_THROW(start(test_robot(2), 1));
  EXPECT_THROW(start(test_robot(2), 2), ConfigError);
  EXPECT_THROW(start(test_robot(2), 1, 0), ConfigError);
  EXPECT_THROW(start(test_robot(0), 1), ConfigError);
  Robot bare = test_robot(2);
  bare.has_drives = false;
  EXPECT_THROW(start(bare, 1), ConfigError);
  Robot crowded = test_robot(7);
  EXPECT_NO_THROW(start(crowded, 1));  // 79 % of a 1/5 Mbit/s FD bus at 1 kHz
  crowded.buses[0].fd = false;         // 189 % of a classic one
  EXPECT_THROW(start(crowded, 1), ConfigError);
  crowded.rate_hz = 400.0;
  EXPECT_NO_THROW(start(crowded, 1));
}

}  // namespace
}  // namespace limber::test_configure
