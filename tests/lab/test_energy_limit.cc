// A blow that gives the arm more kinetic energy than energy_limit_J stops it; one that gives less
// does not; with springs in the joints as without.
#include <gtest/gtest.h>

#include <cmath>

#include "lab/lab.h"

namespace limber::test_energy_limit {
namespace {

using Status = controller_status_t;

TimedMessage request_at(double time_s, int what) {
  mode_request_t mode{};
  mode.client = kScenarioClient;
  mode.request = static_cast<std::int8_t>(what);
  return {std::llround(1e9 * time_s), mode};
}

struct Outcome {
  int mode = 0;
  int reason = 0;
  double most_kinetic_J = 0.0;
  double most_unexplained_J = 0.0;
};

struct Blow {
  const char* robot;
  double force_N;  ///< along the base's y at the tip, for 0.15 s
};

Outcome after(const Blow& blow, double limit_J) {
  LoadedRobot robot = load_robot(blow.robot);
  robot.robot.energy_limit_J = limit_J;
  push_t push{};
  push.wrench[1] = blow.force_N;
  push.duration_s = 0.15;
  Scenario scenario;
  scenario.timeline = {request_at(0.3, mode_request_t::REQUEST_HOLD),
                       request_at(0.6, mode_request_t::REQUEST_ACTIVE),
                       {1'500'000'000, push}};
  Lab lab(robot, scenario);
  Outcome outcome;
  while (lab.time_ns() < 2'500'000'000) {
    lab.step();
    const Status& status = lab.controller_status();
    outcome.most_kinetic_J = std::max(outcome.most_kinetic_J, status.kinetic_energy_J);
    outcome.most_unexplained_J = std::max(outcome.most_unexplained_J, status.unexplained_energy_J);
  }
  outcome.mode = lab.controller_status().mode;
  outcome.reason = lab.controller_status().reason;
  return outcome;
}

class EnergyLimit : public ::testing::TestWithParam<Blow> {};

TEST_P(EnergyLimit, StopsAnArmThatWasHit) {
  const Blow& blow = GetParam();
  const Outcome free = after(blow, 1e5);
  EXPECT_EQ(free.mode, +Status::MODE_ACTIVE);
  // All of its speed comes from the blow; the springs take some of the work besides.
  ASSERT_GT(free.most_kinetic_J, 1.0);
  EXPECT_GT(free.most_unexplained_J, 0.9 * free.most_kinetic_J);
  const Outcome stopped = after(blow, 0.5 * free.most_kinetic_J);
  EXPECT_EQ(stopped.mode, +Status::MODE_FAULT);
  EXPECT_EQ(stopped.reason, +Status::REASON_ENERGY);
  const Outcome let = after(blow, 1.1 * free.most_unexplained_J);
  EXPECT_EQ(let.mode, +Status::MODE_ACTIVE);
}

INSTANTIATE_TEST_SUITE_P(Arms, EnergyLimit,
                         ::testing::Values(Blow{"planar2r", 100.0}, Blow{"panda", 150.0},
                                           Blow{"antagonist2r", 100.0}),
                         [](const auto& parameter) { return parameter.param.robot; });

}  // namespace
}  // namespace limber::test_energy_limit
