// The simulated arm behind its motor nodes. The process (sim/main.cc) and the lab call the same members.
#pragma once

#include <cstdint>
#include <limber/push_t.hpp>
#include <limber/scenario_event_t.hpp>
#include <limber/sim_truth_t.hpp>
#include <memory>
#include <vector>

#include "drivers/can/can_bus.h"
#include "robots/load_robot.h"
#include "scenarios/scenario.h"

namespace limber {

struct SimulatorOptions {
  Integrator integrator = Integrator::kOde;
  double step_s = 250e-6;
  bool friction = true;
  std::vector<double> start_q;  ///< empty: home
};

/// After construction every member is free of allocation, locks, logs and exceptions (set-up of pushes included: they
/// are copied into fixed slots).
class Simulator {
 public:
  /// `buses` in the order of robot.buses; they outlive the simulator. Throws ConfigError.
  Simulator(const LoadedRobot& robot, std::vector<CanBus*> buses, const SimulatorOptions& options);
  ~Simulator();

  /// Handles all frames that wait: nodes answer; a TICK with a new number advances one control period (lock step) and is
  /// answered with its TOCK once every bus has ticked. Returns true if a period was advanced by a TICK.
  bool poll() noexcept;

  /// Realtime: advances the arm and the nodes' watchdogs by whole integration steps up to this simulated time.
  void advance_to(std::int64_t sim_time_ns) noexcept;

  /// Arm time of the current period, for the timeline: number of the last TICK times the period. Realtime: set by the
  /// process from JOINT_STATE.
  std::int64_t arm_time_ns() const noexcept;
  void set_arm_time_ns(std::int64_t time_ns) noexcept;
  /// Messages that act at an arm time; in lock step they are applied exactly at the start of that period.
  void set_timeline(const std::vector<TimedMessage>* timeline) noexcept;

  /// Checked whole; false and nothing changed if a value is not finite, out of range, or names an unknown link.
  bool push(const push_t& push) noexcept;
  bool event(const scenario_event_t& event) noexcept;

  const sim_truth_t& truth() noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace limber
