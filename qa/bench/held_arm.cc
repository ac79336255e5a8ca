#include "qa/bench/held_arm.h"

#include <stdexcept>

namespace limber::bench {
namespace {

constexpr std::int64_t kUntilActive = 3000;  // cycles

Scenario held(Integrator integrator) {
  Scenario scenario;
  scenario.integrator = integrator;
  scenario.friction = false;
  scenario.step_s = 1e-3;
  mode_request_t request{};
  request.client = kScenarioClient;
  request.request = mode_request_t::REQUEST_HOLD;
  scenario.timeline.push_back({300'000'000, request});
  request.request = mode_request_t::REQUEST_ACTIVE;
  scenario.timeline.push_back({1'500'000'000, request});
  return scenario;
}

}  // namespace

HeldArm::HeldArm(const std::string& robot, Integrator integrator)
    : robot_(load_robot(robot)), scenario_(held(integrator)), lab_(robot_, scenario_) {
  run(kUntilActive);
  require_held();
}

void HeldArm::require_held() const {
  if (lab_.controller_status().mode != controller_status_t::MODE_ACTIVE)
    throw std::runtime_error("the arm is not held: its controller is not ACTIVE");
}

}  // namespace limber::bench
