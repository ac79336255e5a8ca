// The three in one process: the same bytes each time, no allocation, and the arm does what the
// scenario says.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "lab/lab.h"
#include "tests/support/allocation_counter.h"

namespace limber {
namespace {

const std::string kScenarios = std::string(LIMBER_SOURCE_DIR) + "/scenarios/";

struct Stage {
  explicit Stage(const std::string& name)
      : robot(load_robot(scenario_robot(kScenarios + name))),
        scenario(load_scenario(kScenarios + name, robot)),
        lab(robot, scenario) {}

  void run_to(double time_s) {
    while (lab.time_ns() < static_cast<std::int64_t>(std::llround(time_s * 1e9))) lab.step();
  }

  LoadedRobot robot;
  Scenario scenario;
  Lab lab;
};

template <typename Message>
std::string bytes(const Message& message) {
  std::string out(static_cast<std::size_t>(message.getEncodedSize()), '\0');
  message.encode(out.data(), 0, static_cast<int>(out.size()));
  return out;
}

TEST(Lab, GivesTheSameBytesTwice) {
  Stage first("quick.yaml");
  Stage second("quick.yaml");
  for (int cycle = 0; cycle < 3000; ++cycle) {
    first.lab.step();
    second.lab.step();
    ASSERT_EQ(bytes(first.lab.state()), bytes(second.lab.state())) << cycle;
    ASSERT_EQ(bytes(first.lab.torque()), bytes(second.lab.torque())) << cycle;
    ASSERT_EQ(bytes(first.lab.truth()), bytes(second.lab.truth())) << cycle;
  }
}

TEST(Lab, NeverAllocatesInTheCycle) {
  for (const char* name : {"quick.yaml", "desktop2r_push.yaml", "planar2r_push.yaml"}) {
    Stage stage(name);
    stage.run_to(0.01);
    const std::int64_t before = testing::allocations();
    stage.run_to(3.0);  // enabling, HOLD, ACTIVE, gains, pushes, a wall, a goal
    EXPECT_EQ(testing::allocations() - before, 0) << name;
  }
}

TEST(Lab, EveryStateIsAnsweredAndObeyed) {
  Stage stage("quick.yaml");
  for (int cycle = 0; cycle < 3000; ++cycle) {
    stage.lab.step();
    ASSERT_EQ(stage.lab.state().seq, cycle);
    ASSERT_EQ(stage.lab.state().time_ns, cycle * 1'000'000LL);
    ASSERT_EQ(stage.lab.torque().state_seq, cycle);
    ASSERT_EQ(stage.lab.verdict(), int{driver_status_t::VERDICT_ACCEPTED}) << cycle;
  }
  EXPECT_EQ(stage.lab.state().drive_state, int{joint_state_t::DRIVE_ON});
  EXPECT_EQ(stage.lab.state().fault, int{joint_state_t::FAULT_NONE});
  EXPECT_EQ(stage.lab.driver_status().commands_missing, 0);
}

TEST(Lab, ForceMeetsTheStiffnessAskedFor) {
  Stage stage("push.yaml");  // friction off; 8 N along x from 2.0 s for 1.6 s, against 500 N/m
  stage.run_to(2.0);
  const double before = stage.lab.truth().p_BT[0];
  double sum = 0.0;
  int count = 0;
  stage.run_to(3.0);
  while (stage.lab.time_ns() < 3'400'000'000) {
    stage.lab.step();
    sum += stage.lab.truth().p_BT[0] - before;
    ++count;
  }
  EXPECT_NEAR(sum / count, 8.0 / 500.0, 0.02 * 8.0 / 500.0);
}

TEST(Lab, ArmIsCarriedUntilItsDrivesHoldIt) {
  Stage stage("quick.yaml");
  const std::vector<double> start(stage.lab.truth().q,
                                  stage.lab.truth().q + stage.robot.robot.size());
  while (stage.lab.time_ns() < 1'200'000'000) {
    stage.lab.step();
    for (std::size_t i = 0; i < start.size(); ++i) {
      ASSERT_NEAR(stage.lab.truth().q[i], start[i], 0.01) << "joint " << i + 1;
    }
  }
}

}  // namespace
}  // namespace limber
