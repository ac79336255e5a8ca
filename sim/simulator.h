// The simulated arm behind its motor nodes. The process (sim/main.cc) and the lab call the same
// members.
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
  /// Longest integration step, s; shortened until a whole number of steps makes a control period
  /// and each drive's loop period.
  double step_s = 250e-6;
  bool friction = true;
  std::vector<double> start_q;  ///< empty: home
  bool stand = false;           ///< carried at the start pose until the drives hold the arm
  bool lockstep = true;         ///< false: TICKs are ignored, time passes by advance_to() alone
  /// The arm, its motors and sensors as they are, where that is not what robot.yaml says of them;
  /// null: as it says. The drives' firmware believes robot.yaml in any case.
  const LoadedRobot* reality = nullptr;
};

/// What a scenario, which must outlive them, asks of the simulated world. Lock step is the caller's
/// business.
inline SimulatorOptions simulator_options(const Scenario& scenario) {
  return {scenario.integrator,
          scenario.step_s,
          scenario.friction,
          scenario.start_q,
          scenario.stand,
          true,
          scenario.reality ? &*scenario.reality : nullptr};
}

/// Lock step: TICK(k) starts the control period [k T, (k+1) T] of arm time. JOINT_STATE(k), taken
/// from the replies before the TICK, is the arm at k T; what the timeline holds for up to k T is
/// done before the period is integrated. So a push "at 1 s" first acts on the arm at exactly 1 s of
/// arm time, in the period that starts with the state the controller sees at 1 s.
///
/// After construction every member is free of allocation, locks, logs and exceptions.
class Simulator {
 public:
  /// `buses` in the order of robot.buses; robot and reality need not outlive the simulator, the
  /// buses do.
  /// Throws ConfigError: no drives, a start outside the joint limits, links the integrator cannot
  /// take, a reality with other joints or motors.
  Simulator(const LoadedRobot& robot, std::vector<CanBus*> buses, const SimulatorOptions& options);
  ~Simulator();

  /// Handles the frames that wait: nodes answer theirs at once; the TICK that completes a number on
  /// every bus advances one control period and is answered with its TOCK on every bus. A number
  /// already done is answered without advancing; any other number, larger or smaller, is a new one.
  /// Returns true after each advance, with frames possibly left (call again for them), false when
  /// none wait or 4096 have been handled.
  bool poll() noexcept;

  /// Realtime: advances the arm and the nodes' watchdogs by whole integration steps up to this
  /// simulated time.
  void advance_to(std::int64_t sim_time_ns) noexcept;
  /// Simulated time now and at the end of the next step, since construction.
  std::int64_t sim_time_ns() const noexcept;
  std::int64_t next_step_ns() const noexcept;
  /// Control periods completed.
  std::int64_t periods() const noexcept;

  /// Arm time of the current period: number of the last TICK times the period. Realtime: what
  /// set_arm_time_ns() said, and the simulated time passed since.
  std::int64_t arm_time_ns() const noexcept;
  /// Realtime: the arm time that it is now. Until it is first told, the timeline waits.
  void set_arm_time_ns(std::int64_t time_ns) noexcept;
  /// The messages outlive the simulator; those for others (modes, goals, gains) are passed over.
  void set_timeline(const std::vector<TimedMessage>* timeline) noexcept;
  /// A new session of the driver: if there is a timeline it starts over, in a world without walls,
  /// payload, pushes and faults. Lock step sees a new session by itself, when the TICK's number
  /// falls.
  void restart_timeline() noexcept;

  /// Checked whole; false and nothing changed if a value is not finite, out of range, or names an
  /// unknown link, or all 8 slots for pushes are taken.
  bool push(const push_t& push) noexcept;
  bool event(const scenario_event_t& event) noexcept;
  /// Messages of the timeline that were refused so.
  std::int64_t refused() const noexcept;

  /// The arm now. time_ns is the arm time of this very state: after TICK(k) has been advanced,
  /// (k+1) T, as in JOINT_STATE(k+1). seq is periods().
  const sim_truth_t& truth() noexcept;
  /// Steps that were not taken because they would have ended in a state that is not finite; the arm
  /// stopped instead.
  std::int64_t diverged() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace limber
