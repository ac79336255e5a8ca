// The driver against the simulator's CANopen drives: both sides of the protocol, written apart.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "sim/nodes/motor_node.h"
#include "tests/drivers/families/fake_cia402.h"

namespace limber::test_cia402_nodes {
namespace {

using testing::cia402_robot;
using testing::DrivenArm;

constexpr std::int64_t kStep_ns = 250'000;
constexpr double kPermille = 0.028;  // N m

/// Nodes whose joints stand where they are put; four steps a cycle.
class NodeArm : public DrivenArm {
 public:
  explicit NodeArm(bool fd = true) : DrivenArm(cia402_robot(fd)) {
    for (JointConfig& joint : robot.joints) {
      joint.drive.peak_torque_Nm = 28.0;
      nodes.push_back(sim::make_motor_node(joint, fd));
    }
    readings.resize(nodes.size());
  }

  void answer() override {
    CanFrame frame;
    CanFrame reply;
    while (motor_ends[0]->receive(std::span(&frame, 1)) == 1) {
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (nodes[i]->receive(frame, readings[i], now_ns, &reply)) motor_ends[0]->send(reply);
        while (nodes[i]->next_frame(&reply)) motor_ends[0]->send(reply);
      }
    }
    pass_time(4);
  }
  void pass_time(int steps) {
    for (int k = 0; k < steps; ++k) {
      now_ns += kStep_ns;
      for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i]->update(readings[i], now_ns);
    }
  }

  std::vector<std::unique_ptr<sim::MotorNode>> nodes;
  std::vector<sim::JointReading> readings;
  std::int64_t now_ns = 0;
};

class Cia402Nodes : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Buses, Cia402Nodes, ::testing::Bool(),
                         [](const auto& bus) { return bus.param ? "Fd" : "Classic"; });

TEST_P(Cia402Nodes, StartUpWithinATenthOfASecond) {
  NodeArm arm(GetParam());
  EXPECT_TRUE(arm.run_until(joint_state_t::DRIVE_OFF, joint_command_t::REQUEST_KEEP, 100))
      << arm.driver->configuration_problem();
  EXPECT_TRUE(arm.driver->configuration_warnings().empty());
  EXPECT_EQ(arm.read_status().replies_invalid[1], 0);
  EXPECT_EQ(arm.read_status().frames_foreign[0], 0);
}

TEST_P(Cia402Nodes, StateInJointCoordinates) {
  NodeArm arm(GetParam());
  arm.readings[1] = {0.5, 0.1, 0.4, -0.2, 0.0, 2.8, 3.0, 25.0};
  ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_OFF, joint_command_t::REQUEST_KEEP));
  const joint_state_t& state = arm.half_cycle();
  const double turn = 2.0 * std::numbers::pi;
  EXPECT_NEAR(state.theta[1], 0.5, turn / 65536);
  EXPECT_NEAR(state.theta_dot[1], 0.1, turn / 65536);
  EXPECT_NEAR(state.q[1], 0.4, turn / 262144);
  EXPECT_NEAR(state.v[1], -0.2, turn / 262144);
  EXPECT_NEAR(state.tau[1], 2.8, kPermille);
  EXPECT_NEAR(state.current_A[1], 3.0, 0.001 * 28.0 / 0.5);
}

TEST_P(Cia402Nodes, TorqueArrivesInJointCoordinates) {
  NodeArm arm(GetParam());
  ASSERT_TRUE(arm.switch_on());
  arm.command.tau[0] = 2.8;
  arm.command.tau[1] = 5.6;
  arm.cycle_with(joint_command_t::REQUEST_ON);
  arm.half_cycle();
  EXPECT_NEAR(arm.nodes[0]->law().tau_ff, 2.8, 1e-9);
  // rho u, as the torque sensor reads nothing.
  EXPECT_NEAR(arm.nodes[1]->law().tau_ff, 4.0 * 5.6, 1e-9);
  EXPECT_NEAR(arm.state->tau_applied[1], 5.6, 1e-9);
}

TEST_P(Cia402Nodes, ASilentDriverIsAFaultThatBrakesAndIsReset) {
  NodeArm arm(GetParam());
  ASSERT_TRUE(arm.switch_on());
  arm.pass_time(4 * 22);
  EXPECT_FALSE(arm.nodes[0]->enabled());
  arm.cycle_with(joint_command_t::REQUEST_ON);
  EXPECT_EQ(arm.state->fault, int{joint_state_t::FAULT_DRIVE_ERROR});
  EXPECT_NE(arm.state->joint_flags[0] & joint_state_t::JOINT_DRIVE_ERROR, 0);
  ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_FAULT, joint_command_t::REQUEST_KEEP));
  arm.cycle_with(joint_command_t::REQUEST_ACKNOWLEDGE);
  EXPECT_TRUE(arm.switch_on()) << arm.driver->configuration_problem();
  EXPECT_TRUE(arm.nodes[0]->enabled());
}

TEST_P(Cia402Nodes, OffFromHoldAndOnAgain) {
  NodeArm arm(GetParam());
  ASSERT_TRUE(arm.switch_on());
  for (int i = 0; i < 150; ++i) arm.cycle_with(joint_command_t::REQUEST_HOLD);
  arm.cycle_with(joint_command_t::REQUEST_OFF);
  ASSERT_TRUE(arm.run_until(joint_state_t::DRIVE_OFF, joint_command_t::REQUEST_KEEP));
  EXPECT_EQ(arm.half_cycle().joint_flags[0] & joint_state_t::JOINT_DRIVE_ERROR, 0);
  EXPECT_TRUE(arm.run_until(joint_state_t::DRIVE_ON, joint_command_t::REQUEST_ON));
}

}  // namespace
}  // namespace limber::test_cia402_nodes
