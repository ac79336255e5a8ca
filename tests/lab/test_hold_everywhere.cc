// HOLD is entered and kept wherever an arm may rest: at the ends of each joint's way, in its soft
// walls, and between.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "lab/lab.h"

namespace limber::test_hold_everywhere {
namespace {

using Status = controller_status_t;

constexpr double kTurn_rad = 6.3;  // as far as a continuous joint is tried

/// The mode 1.3 s after HOLD was requested of an arm that rests there.
int mode_at(const LoadedRobot& robot, const std::vector<double>& q) {
  mode_request_t hold{};
  hold.client = kScenarioClient;
  hold.request = mode_request_t::REQUEST_HOLD;
  Scenario scenario;
  scenario.start_q = q;
  scenario.timeline = {{300'000'000, hold}};
  Lab lab(robot, scenario);
  while (lab.time_ns() < 1'600'000'000) lab.step();
  return lab.controller_status().mode;
}

class HoldEverywhere : public ::testing::TestWithParam<const char*> {};

TEST_P(HoldEverywhere, EndsOfEachJointIncluded) {
  const LoadedRobot robot = load_robot(GetParam());
  std::vector<double> home;
  for (const JointConfig& joint : robot.robot.joints) home.push_back(joint.home);
  for (std::size_t i = 0; i < home.size(); ++i) {
    const JointConfig& joint = robot.robot.joints[i];
    const double low = std::max(joint.position_min, joint.home - kTurn_rad);
    const double high = std::min(joint.position_max, joint.home + kTurn_rad);
    for (const double from_end : {0.005, 0.02, 0.06}) {
      for (const double angle : {low + from_end, high - from_end}) {
        std::vector<double> q = home;
        q[i] = angle;
        EXPECT_EQ(mode_at(robot, q), +Status::MODE_HOLD) << joint.name << " at " << angle;
      }
    }
    for (const double share : {0.25, 0.5, 0.75}) {
      std::vector<double> q = home;
      q[i] = low + share * (high - low);
      EXPECT_EQ(mode_at(robot, q), +Status::MODE_HOLD) << joint.name << " at " << q[i];
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Arms, HoldEverywhere,
                         ::testing::Values("ideal7", "desktop2r", "openarm", "panda", "iiwa14",
                                           "planar2r", "baxter", "antagonist2r", "antagonist7",
                                           "testbench"),
                         [](const auto& parameter) { return parameter.param; });

}  // namespace
}  // namespace limber::test_hold_everywhere
