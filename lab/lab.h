// The whole stack in one process: driver, controller and simulator on an in-memory CAN bus, in lock
// step, as fast as the processor allows. Nothing here does what the three processes do; it only
// calls the same members in the same order.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "controller/arm_controller.h"
#include "drivers/arm_driver.h"
#include "drivers/can/memory_bus.h"
#include "scenarios/loader/scenario.h"
#include "sim/simulator.h"

namespace limber {

/// For those who inject faults.
struct LabOptions {
  /// What the simulated drives have stored, where that differs from robot.yaml; null: the same.
  const LoadedRobot* simulated = nullptr;
  /// Stands between the driver and its end of a bus, which outlives it. Called once a bus, in the
  /// order of robot.yaml. Empty: nothing does.
  std::function<std::unique_ptr<CanBus>(CanBus* end)> before_driver;
  /// Puts what reaches the gate in the place of the controller's answer into `instead`. Empty: the
  /// answer itself.
  std::function<void(const joint_command_t& answer, std::vector<joint_command_t>* instead)>
      before_gate;
  /// The number of the first cycle, and arm time accordingly.
  std::int64_t first_cycle = 0;
};

class Lab {
 public:
  /// The scenario and robots outlive the lab. Throws ConfigError.
  Lab(const LoadedRobot& robot, const Scenario& scenario, const LabOptions& options = {});

  /// One more end on each bus, in the order of robot.yaml, to listen; they live no longer than the
  /// lab. Set-up only.
  std::vector<std::unique_ptr<CanBus>> attach();

  /// One control cycle:
  ///   commands -> nodes answer, arm advances one period -> replies -> JOINT_STATE -> law ->
  ///   JOINT_TORQUE -> gate.
  /// Free of allocation, locks, logs and exceptions, as far as LabOptions::before_gate is.
  void step() noexcept;

  /// So many have been.
  std::int64_t cycles() const noexcept { return cycle_ - first_cycle_; }
  /// Arm time of the next one.
  std::int64_t time_ns() const noexcept { return cycle_ * period_ns_; }

  /// What the last step() exchanged.
  const joint_state_t& state() const noexcept { return *state_; }
  const joint_command_t& torque() const noexcept { return *torque_; }
  const sim_truth_t& truth() noexcept { return simulator_->truth(); }
  const controller_status_t& controller_status() const noexcept { return controller_->status(); }
  const driver_status_t& driver_status() noexcept;
  int verdict() const noexcept { return verdict_; }

  ArmController& controller() noexcept { return *controller_; }
  Simulator& simulator() noexcept { return *simulator_; }
  ArmDriver& driver() noexcept { return *driver_; }

 private:
  void begin(const std::vector<CanBus*>& driver_ends);

  std::vector<std::unique_ptr<MemoryBus>> buses_;
  std::vector<std::unique_ptr<CanBus>> ends_;
  std::unique_ptr<Simulator> simulator_;
  std::unique_ptr<ArmDriver> driver_;
  std::unique_ptr<ArmController> controller_;
  std::int64_t period_ns_;
  std::int64_t first_cycle_;
  std::int64_t cycle_;
  const joint_state_t* state_ = nullptr;
  const joint_command_t* torque_ = nullptr;
  int verdict_ = 0;
  driver_status_t driver_status_{};
  decltype(LabOptions::before_gate) before_gate_;
  std::vector<joint_command_t> answers_;
};

}  // namespace limber
