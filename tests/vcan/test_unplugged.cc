// An arm whose adapter goes and comes back: off while it is gone, on only after an acknowledgement.
#include <gtest/gtest.h>
#include <unistd.h>

#include "drivers/arm_driver.h"
#include "tests/drivers/fake_arm.h"
#include "tests/vcan/lab.h"

namespace limber::test_unplugged {
namespace {

using testing::FakeMotor;
using testing::run;

constexpr int kKeep = joint_command_t::REQUEST_KEEP;
constexpr int kOn = joint_state_t::DRIVE_ON;
constexpr int kFault = joint_state_t::DRIVE_FAULT;

/// Two motors and their driver, each on an end of vcan6.
class Arm {
 public:
  Arm() : robot_(testing::test_robot(2)) {
    driver_end_ = open_can_bus("socketcan:vcan6", true);
    motor_end_ = open_can_bus("socketcan:vcan6", true);
    for (const JointConfig& joint : robot_.joints) motors.emplace_back(joint.drive);
    driver = std::make_unique<ArmDriver>(robot_, std::vector<CanBus*>{driver_end_.get()},
                                         ArmDriverOptions{42, false, 2});
    driver->set_receive_filters();
  }

  void cycle(int request) {
    ++cycle_;
    driver->transmit(cycle_ * 1'000'000, monotonic_ns());
    CanFrame frame;
    CanFrame reply;
    while (motor_end_->receive(std::span(&frame, 1)) == 1) {
      for (FakeMotor& motor : motors) {
        if (motor.handle(frame, &reply)) motor_end_->send(reply);
      }
    }
    driver->poll();
    state = driver->finish_cycle();
    joint_command_t command{};
    command.session = 42;
    command.controller = 7;
    command.num_joints = 2;
    command.state_seq = state.seq;
    command.request = static_cast<std::int8_t>(request);
    driver->accept(command);
  }

  bool run_until(int drive_state, int request, int most = 300) {
    for (int i = 0; i < most && state.drive_state != drive_state; ++i) cycle(request);
    return state.drive_state == drive_state;
  }
  bool switch_on() {
    return run_until(joint_state_t::DRIVE_OFF, kKeep) &&
           run_until(kOn, joint_command_t::REQUEST_ON);
  }
  /// Cycles at a pace at which the ends of the bus can look for their interface.
  bool sends_again() {
    for (int i = 0; i < 500; ++i) {
      const std::int64_t sent = driver_end_->statistics().sent;
      cycle(kKeep);
      if (driver_end_->statistics().sent > sent && motors[0].frames.size() > heard_) return true;
      heard_ = motors[0].frames.size();
      usleep(20'000);
    }
    return false;
  }

  std::vector<FakeMotor> motors;
  std::unique_ptr<ArmDriver> driver;
  joint_state_t state{};

 private:
  Robot robot_;
  std::unique_ptr<CanBus> driver_end_;
  std::unique_ptr<CanBus> motor_end_;
  std::int64_t cycle_ = -1;
  std::size_t heard_ = 0;
};

constexpr const char* kPlug = "ip link add dev vcan6 type vcan && ip link set vcan6 mtu 72 up";

class Unplugged : public ::testing::Test {
 protected:
  void SetUp() override { run(kPlug); }
  void TearDown() override { run("ip link del vcan6"); }
};

void expect_stopped_until_acknowledged(Arm* arm) {
  EXPECT_EQ(arm->state.drive_state, kFault);
  EXPECT_EQ(arm->state.fault, +joint_state_t::FAULT_BUS);
  for (int i = 0; i < 100; ++i) arm->cycle(joint_command_t::REQUEST_ON);
  EXPECT_EQ(arm->state.drive_state, kFault) << "nobody has acknowledged";
  for (const FakeMotor& motor : arm->motors) EXPECT_EQ(motor.error, 0) << "still enabled";
  arm->cycle(joint_command_t::REQUEST_ACKNOWLEDGE);
  EXPECT_TRUE(arm->switch_on());
}

TEST_F(Unplugged, TakenOutAndPutBack) {
  Arm arm;
  ASSERT_TRUE(arm.switch_on());
  run("ip link del vcan6");
  arm.cycle(kKeep);
  EXPECT_NE(arm.state.drive_state, kOn);
  EXPECT_EQ(arm.state.fault, +joint_state_t::FAULT_BUS);
  EXPECT_EQ(
      arm.driver->fault_text(arm.state.fault, -1, arm.driver->fault_detail()),
      "can0: the interface is down or gone; plug it in and bring it up; `limber doctor ROBOT` "
      "prints the command");
  ASSERT_TRUE(arm.run_until(kFault, kKeep));
  run(kPlug);
  ASSERT_TRUE(arm.sends_again());
  expect_stopped_until_acknowledged(&arm);
}

TEST_F(Unplugged, AcknowledgedWhileItIsOutItStaysOff) {
  Arm arm;
  ASSERT_TRUE(arm.switch_on());
  run("ip link del vcan6");
  ASSERT_TRUE(arm.run_until(kFault, kKeep));
  for (int i = 0; i < 50; ++i) arm.cycle(joint_command_t::REQUEST_ACKNOWLEDGE);
  arm.cycle(kKeep);
  EXPECT_EQ(arm.state.drive_state, kFault);
  run(kPlug);
  ASSERT_TRUE(arm.sends_again());
  expect_stopped_until_acknowledged(&arm);
}

TEST_F(Unplugged, DownAndUp) {
  Arm arm;
  ASSERT_TRUE(arm.switch_on());
  run("ip link set vcan6 down");
  ASSERT_TRUE(arm.run_until(kFault, kKeep));
  run("ip link set vcan6 up");
  ASSERT_TRUE(arm.sends_again());
  expect_stopped_until_acknowledged(&arm);
}

}  // namespace
}  // namespace limber::test_unplugged
