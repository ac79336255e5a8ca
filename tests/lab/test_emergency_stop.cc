// An emergency stop on the bus, from the button to the drives and back.
#include <gtest/gtest.h>

#include <cmath>

#include "lab/lab.h"

namespace limber::test_emergency_stop {
namespace {

using Status = controller_status_t;

constexpr double kPressed_s = 1.0;
constexpr double kReleased_s = 2.0;

TimedMessage request_at(double time_s, int what) {
  mode_request_t mode{};
  mode.client = kScenarioClient;
  mode.request = static_cast<std::int8_t>(what);
  return {std::llround(1e9 * time_s), mode};
}

class EmergencyStop : public ::testing::TestWithParam<std::int8_t> {
 protected:
  EmergencyStop() : robot_(load_robot("openarm")) {
    EmergencyStopConfig stop;
    stop.id = 0x185;
    robot_.robot.emergency_stop = stop;
    scenario_event_t fault{};
    fault.kind = scenario_event_t::EVENT_FAULT;
    fault.joint = scenario_event_t::NODE_EMERGENCY_STOP;
    fault.fault = GetParam();
    fault.duration_s = kReleased_s - kPressed_s;
    fault.normal[2] = 1.0;
    scenario_.timeline = {request_at(0.3, mode_request_t::REQUEST_HOLD),
                          request_at(0.6, mode_request_t::REQUEST_ACTIVE),
                          {std::llround(1e9 * kPressed_s), fault},
                          request_at(1.8, mode_request_t::REQUEST_ACKNOWLEDGE),
                          request_at(2.5, mode_request_t::REQUEST_ACKNOWLEDGE)};
    lab_.emplace(robot_, scenario_);
  }
  void run_to(double time_s) {
    while (lab_->time_ns() < std::llround(1e9 * time_s)) lab_->step();
  }
  int mode() const { return lab_->controller_status().mode; }
  int drives() const { return lab_->state().drive_state; }

  LoadedRobot robot_;
  Scenario scenario_;
  std::optional<Lab> lab_;
};

TEST_P(EmergencyStop, HoldsThenSwitchesOffAndNeedsReleaseAndAcknowledgement) {
  const bool silent = GetParam() == scenario_event_t::FAULT_SILENT;
  run_to(0.99);
  EXPECT_EQ(mode(), +Status::MODE_ACTIVE);
  EXPECT_EQ(lab_->state().emergency_stop, +joint_state_t::STOP_RELEASED);
  // A press is told at once; silence is one after 0.1 s.
  run_to(kPressed_s + (silent ? 0.125 : 0.004));
  EXPECT_EQ(mode(), +Status::MODE_ESTOP);
  EXPECT_EQ(drives(), +joint_state_t::DRIVE_HOLD);
  EXPECT_EQ(lab_->state().fault, +joint_state_t::FAULT_EMERGENCY_STOP);
  run_to(kPressed_s + (silent ? 0.57 : 0.49));
  EXPECT_EQ(drives(), +joint_state_t::DRIVE_HOLD) << "half a second to come to rest";
  run_to(kPressed_s + 0.64);
  EXPECT_EQ(drives(), +joint_state_t::DRIVE_FAULT);
  EXPECT_EQ(lab_->state().fault, +joint_state_t::FAULT_EMERGENCY_STOP);
  run_to(1.81);
  EXPECT_EQ(mode(), +Status::MODE_ESTOP) << "acknowledged too early";
  EXPECT_EQ(lab_->controller_status().requests_refused, 1);
  run_to(2.45);
  EXPECT_EQ(lab_->state().emergency_stop, +joint_state_t::STOP_RELEASED);
  EXPECT_EQ(mode(), +Status::MODE_ESTOP);
  EXPECT_EQ(drives(), +joint_state_t::DRIVE_FAULT) << "a release alone moves nothing";
  run_to(2.7);  // the drives' start-up, and a hundred good states
  EXPECT_EQ(mode(), +Status::MODE_IDLE);
  EXPECT_EQ(drives(), +joint_state_t::DRIVE_OFF);
  const mode_request_t hold = std::get<mode_request_t>(scenario_.timeline[0].message);
  EXPECT_EQ(lab_->controller().on_mode(hold), nullptr) << "the arm has sunk, and swings";
  run_to(1e-9 * static_cast<double>(lab_->time_ns()) + 1.5);
  EXPECT_EQ(mode(), +Status::MODE_HOLD);
  EXPECT_EQ(drives(), +joint_state_t::DRIVE_ON);
}

INSTANTIATE_TEST_SUITE_P(Ways, EmergencyStop,
                         ::testing::Values(scenario_event_t::FAULT_PRESSED,
                                           scenario_event_t::FAULT_SILENT));

}  // namespace
}  // namespace limber::test_emergency_stop
