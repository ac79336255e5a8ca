// A controller that is gone leaves a resting arm where it was, whatever its model had wrong.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lab/lab.h"

namespace limber::test_gone_controller {
namespace {

/// An arm in HOLD with a weight at its tip that the model does not know. From 1.5 s on the gravity
/// torque of the commands goes to 0.9 of each joint's limit, as fast as the gate lets it; after
/// 2.5 s there are none.
class GoneController {
 public:
  GoneController(const char* name, double payload_kg)
      : robot_(load_robot(name)), lab_(robot_, hold(), options()) {
    scenario_event_t weight{};
    weight.kind = scenario_event_t::EVENT_PAYLOAD;
    weight.payload_mass_kg = payload_kg;
    EXPECT_TRUE(lab_.simulator().event(weight));
  }

  void run_to(double time_s) {
    while (lab_.time_ns() < std::llround(1e9 * time_s)) lab_.step();
  }
  const joint_state_t& state() const { return lab_.state(); }
  std::vector<double> angles() { return {lab_.truth().q, lab_.truth().q + robot_.robot.size()}; }

 private:
  const Scenario& hold() {
    mode_request_t request{};
    request.client = kScenarioClient;
    request.request = mode_request_t::REQUEST_HOLD;
    scenario_.timeline = {{300'000'000, request}};
    return scenario_;
  }

  LabOptions options() {
    LabOptions options;
    options.before_gate = [this](const auto& right, auto* instead) { answer(right, instead); };
    return options;
  }

  void answer(const joint_command_t& right, std::vector<joint_command_t>* instead) {
    const double time_s = 1e-9 * static_cast<double>(lab_.time_ns());
    if (time_s >= 2.5) return;
    instead->push_back(right);
    if (time_s < 1.5) return;
    const double share = std::min(3.0 * (time_s - 1.5), 0.9);
    for (int i = 0; i < robot_.robot.size(); ++i) {
      const double limit = robot_.robot.joints[static_cast<std::size_t>(i)].torque_limit_Nm;
      const double wrong = i % 2 == 0 ? -limit : limit;
      double& gravity = instead->back().tau_gravity[i];
      gravity += share / 0.9 * (0.9 * wrong - gravity);
    }
  }

  LoadedRobot robot_;
  Scenario scenario_;
  Lab lab_;
};

class GoneControllerTest : public ::testing::TestWithParam<const char*> {};

TEST_P(GoneControllerTest, LeavesTheArmWhereItWas) {
  for (const double payload_kg : {0.0, 0.3}) {
    GoneController run(GetParam(), payload_kg);
    run.run_to(2.4);
    ASSERT_EQ(run.state().drive_state, +joint_state_t::DRIVE_ON);
    const std::vector<double> before = run.angles();
    run.run_to(5.0);
    ASSERT_EQ(run.state().drive_state, +joint_state_t::DRIVE_HOLD);
    ASSERT_EQ(run.state().fault, +joint_state_t::FAULT_CONTROLLER_LOST);
    const std::vector<double> after = run.angles();
    for (std::size_t i = 0; i < before.size(); ++i)
      EXPECT_NEAR(after[i], before[i], 0.01) << "joint " << i << ", " << payload_kg << " kg";
  }
}

INSTANTIATE_TEST_SUITE_P(Arms, GoneControllerTest,
                         ::testing::Values("planar2r", "desktop2r", "openarm", "iiwa14", "baxter",
                                           "antagonist2r"),
                         [](const auto& parameter) { return parameter.param; });

}  // namespace
}  // namespace limber::test_gone_controller
