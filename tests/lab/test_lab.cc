// The three in one process: the same bytes each time, no allocation, and the arm does what the
// scenario says.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "common/config_error.h"
#include "controller/laws/registry.h"
#include "lab/lab.h"
#include "tests/support/mutation.h"
#include "tests/support/source_path.h"
#include "tools/allocations/allocations.h"

namespace limber::test_lab {
namespace {

const std::string kScenarios = source_path("scenarios/");

struct Stage {
  explicit Stage(const std::string& name)
      : robot(load_robot(scenario_robot(kScenarios + name))),
        scenario(load_scenario(kScenarios + name, robot, &controller::law_catalog())),
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
  for (const char* name : {"quick.yaml", "desktop2r_push.yaml", "planar2r_push.yaml",
                           "desktop2r_ak_push.yaml", "desktop2r_odrive_push.yaml"}) {
    Stage stage(name);
    stage.run_to(0.01);
    const std::int64_t before = allocations();
    stage.run_to(3.0);  // enabling, HOLD, ACTIVE, gains, pushes, a wall, a goal
    EXPECT_EQ(allocations() - before, 0) << name;
  }
}

// The shipped arms at their shipped rates on a wire with bit time: nothing is late, and the count
// agrees with the prediction.
TEST(Lab, EveryArmRunsOnItsWire) {
  for (const char* name :
       {"push.yaml", "desktop2r_push.yaml", "planar2r_push.yaml", "ideal7_push.yaml",
        "iiwa14_push.yaml", "panda_push.yaml", "baxter_push.yaml", "antagonist2r_stiffness.yaml",
        "edulite_a3_push.yaml", "yam_push.yaml", "trlc_dk1_push.yaml", "rebot_b601_dm_push.yaml",
        "axol_push.yaml", "desktop2r_ak_push.yaml", "desktop2r_odrive_push.yaml"}) {
    Stage stage(name);
    stage.run_to(1.0);
    const driver_status_t before = stage.lab.driver_status();
    for (int i = 0; i < 1000; ++i) {
      stage.lab.step();
      const joint_state_t& state = stage.lab.state();
      for (int j = 0; j < state.num_joints; ++j) ASSERT_EQ(state.age_cycles[j], 0) << name;
      ASSERT_EQ(state.drive_state, +joint_state_t::DRIVE_ON) << name;
    }
    const driver_status_t after = stage.lab.driver_status();
    for (int b = 0; b < after.num_buses; ++b) {
      // Stuff bits depend on the data, which differ from arm to arm.
      EXPECT_NEAR(after.bus_load_counted[b] / after.bus_load_predicted[b], 1.0, 0.03) << name;
      const sim::Wire* wire = stage.lab.simulator().wire(b);
      ASSERT_NE(wire, nullptr) << name;
      EXPECT_EQ(wire->count().errors, 0) << name;
    }
    for (int j = 0; j < after.num_joints; ++j) {
      EXPECT_EQ(after.replies_lost[j], before.replies_lost[j]) << name;
      EXPECT_EQ(after.replies_late[j], before.replies_late[j]) << name;
    }
  }
}

TEST(Lab, ASlowAdapterIsRefusedWithTheRateThatWorks) {
  LoadedRobot robot = load_robot("openarm");
  const Scenario scenario = load_scenario(kScenarios + "push.yaml", robot, nullptr);
  robot.robot.buses[0].adapter = CanAdapter::kUsb;
  try {
    Lab lab(robot, scenario);
    FAIL() << "1 kHz through USB";
  } catch (const ConfigError& error) {
    EXPECT_NE(std::string(error.what()).find("the highest rate is 805 Hz"), std::string::npos)
        << error.what();
  }
  robot.robot.rate_hz = 800.0;
  EXPECT_NO_THROW(Lab(robot, scenario));
}

// One frame of a thousand is dropped by its receiver, one of five hundred is destroyed and sent
// again: the arm stays on.
TEST(Lab, ANoisyWireIsBridged) {
  Stage clean("push.yaml");
  Scenario noisy = clean.scenario;
  noisy.wire.loss = 1e-4;
  noisy.wire.corruption = 2e-3;
  Lab lab(clean.robot, noisy);
  while (lab.time_ns() < 4'000'000'000) lab.step();
  EXPECT_EQ(lab.state().drive_state, +joint_state_t::DRIVE_ON);
  EXPECT_GT(lab.driver_status().error_frames[0], 50);
  EXPECT_GT(lab.simulator().wire(0)->count().lost, 0);
  EXPECT_EQ(lab.controller_status().mode, +controller_status_t::MODE_ACTIVE);
}

// Each way, which an adapter or a hub takes: held as long as a cycle has room, else refused with
// what it has room for.
TEST(Lab, ALateWireIsHeldWithinItsCycle) {
  const Stage stage("push.yaml");
  Scenario scenario = stage.scenario;
  scenario.step_s = 20e-6;  // what arrives within a step acts from the next one on
  Lab prompt(stage.robot, scenario);
  scenario.wire.delay_s = 20e-6;
  Lab late(stage.robot, scenario);
  while (late.time_ns() < 2'500'000'000) {
    late.step();
    prompt.step();
  }
  EXPECT_EQ(late.controller_status().mode, +controller_status_t::MODE_ACTIVE);
  EXPECT_EQ(late.driver_status().replies_late[0], 0);
  EXPECT_NE(late.state().q[1], prompt.state().q[1]) << "the torque reaches the motor later";
  EXPECT_NEAR(late.state().q[1], prompt.state().q[1], 1e-3);
  scenario.wire.delay_s = 1e-3;
  const std::string refused =
      testing::complaint_of([&] { const Lab too_late(stage.robot, scenario); });
  EXPECT_NE(refused.find("wire.delay_s: is 0.001; on bus"), std::string::npos) << refused;
  EXPECT_NE(refused.find("at 1000 Hz a cycle has room for"), std::string::npos) << refused;
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

TEST(Lab, TheGateJudgesWhatStandsBeforeIt) {
  const std::string path = kScenarios + "quick.yaml";
  const LoadedRobot robot = load_robot(scenario_robot(path));
  const Scenario scenario = load_scenario(path, robot, &controller::law_catalog());
  for (const std::size_t copies : {0U, 1U, 2U}) {
    LabOptions options;
    options.before_gate = [copies](const joint_command_t& answer, auto* instead) {
      instead->assign(copies, answer);
    };
    Lab lab(robot, scenario, options);
    constexpr int kCycles = 50;
    for (int cycle = 0; cycle < kCycles; ++cycle) lab.step();
    const driver_status_t& status = lab.driver_status();
    EXPECT_EQ(status.commands_accepted, copies > 0 ? kCycles : 0);
    EXPECT_EQ(status.commands_refused[driver_status_t::VERDICT_REPLAYED], copies > 1 ? kCycles : 0);
  }
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
}  // namespace limber::test_lab
