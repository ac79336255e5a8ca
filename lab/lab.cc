#include "lab/lab.h"

#include <cmath>

#include "common/run_id.h"
#include "drivers/bus_load.h"
#include "drivers/can/lockstep_frame.h"

namespace limber {

Lab::Lab(const LoadedRobot& robot, const Scenario& scenario, const LabOptions& options)
    : period_ns_(std::llround(1e9 / robot.robot.rate_hz)),
      first_cycle_(options.first_cycle),
      cycle_(first_cycle_),
      before_gate_(options.before_gate) {
  check_wire_delay(robot.robot, scenario.wire.delay_s, scenario.path);
  std::vector<CanBus*> driver_ends;
  std::vector<CanBus*> arm_ends;
  for (std::size_t i = 0; i < robot.robot.buses.size(); ++i) {
    buses_.push_back(std::make_unique<MemoryBus>());
    for (auto* side : {&driver_ends, &arm_ends}) {
      ends_.push_back(buses_.back()->attach());
      side->push_back(ends_.back().get());
    }
    if (options.before_driver) {
      ends_.push_back(options.before_driver(driver_ends.back()));
      driver_ends.back() = ends_.back().get();
    }
  }
  simulator_ =
      std::make_unique<Simulator>(options.simulated != nullptr ? *options.simulated : robot,
                                  arm_ends, simulator_options(scenario));
  simulator_->set_timeline(&scenario.timeline);
  begin(driver_ends);
  ArmDriverOptions driver{.session = kLockstepRunId, .lockstep = true};
  driver.first_cycle = first_cycle_;
  driver_ = std::make_unique<ArmDriver>(robot.robot, driver_ends, driver);
  driver_->set_receive_filters();
  ArmControllerOptions controller;
  controller.controller = kLockstepRunId;
  controller.measure_time = false;
  controller.simulated = true;
  controller.allow_unstable = scenario.allow_unstable;
  controller_ = std::make_unique<ArmController>(robot, controller);
  controller_->set_timeline(&scenario.timeline);
}

// limber-driver has met the drives before time runs: what they sent of themselves is gone.
void Lab::begin(const std::vector<CanBus*>& driver_ends) {
  for (CanBus* bus : driver_ends) bus->send(lockstep::tick(lockstep::kStandstill));
  simulator_->poll();
  CanFrame frame;
  for (CanBus* bus : driver_ends) {
    while (bus->receive(std::span(&frame, 1)) == 1) {
    }
  }
}

std::vector<std::unique_ptr<CanBus>> Lab::attach() {
  std::vector<std::unique_ptr<CanBus>> ends;
  for (const auto& bus : buses_) ends.push_back(bus->attach());
  return ends;
}

void Lab::step() noexcept {
  driver_->transmit(time_ns(), time_ns());
  simulator_->poll();
  driver_->poll();
  state_ = &driver_->finish_cycle();
  torque_ = &controller_->step(*state_);
  if (before_gate_) {
    answers_.clear();
    before_gate_(*torque_, &answers_);
    for (const joint_command_t& answer : answers_) verdict_ = driver_->accept(answer);
  } else {
    verdict_ = driver_->accept(*torque_);
  }
  ++cycle_;
}

const driver_status_t& Lab::driver_status() noexcept {
  driver_->fill_status(&driver_status_);
  return driver_status_;
}

}  // namespace limber
