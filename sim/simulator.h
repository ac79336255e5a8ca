// The simulated arm behind its motor nodes, and the time that passes there. The process
// (sim_process.h) and the lab call the same members.
#pragma once

#include <cstdint>
#include <limber/block_truth_t.hpp>
#include <limber/hand_truth_t.hpp>
#include <limber/push_t.hpp>
#include <limber/scenario_event_t.hpp>
#include <limber/sim_truth_t.hpp>
#include <limber/workpiece_t.hpp>
#include <vector>

#include "drivers/can/can_bus.h"
#include "robots/loader/load_robot.h"
#include "scenarios/loader/scenario.h"
#include "sim/nodes/arm_nodes.h"
#include "sim/nodes/tick_count.h"
#include "sim/plant/sim_clock.h"
#include "sim/plant/simulated_arm.h"

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
  /// Lock step: frames take time and may be lost. Stamps of what the driver receives are arm time.
  WireOptions wire;
  std::vector<ObjectConfig> objects;  ///< for the hand
  /// The arm, its motors and sensors as they are, where they differ from robot.yaml;
  /// null: robot.yaml is right. The drives' firmware believes robot.yaml in any case.
  const LoadedRobot* plant = nullptr;
};

/// What a scenario, which must outlive them, wants of the simulated world. Lock step is set by the
/// caller.
inline SimulatorOptions simulator_options(const Scenario& scenario) {
  return {scenario.integrator, scenario.step_s,  scenario.friction,
          scenario.start_q,    scenario.stand,   true,
          scenario.wire,       scenario.objects, scenario.plant ? &*scenario.plant : nullptr};
}

/// Lock step: TICK(k) starts the control period [k T, (k+1) T] of arm time. JOINT_STATE(k), taken
/// from the replies before the TICK, is the arm at k T; what the timeline holds for up to k T is
/// done before the period is integrated. So a push "at 1 s" first acts on the arm at exactly 1 s of
/// arm time, in the period that starts with the state the controller sees at 1 s.
///
/// With a wire, frames of the cycle enter the driver's adapter at k T and reach the nodes when they
/// have left the wire. A drive acts on a command from the next integration step on and answers with
/// the state at the start of the step. TICK(kStandstill) gives the nodes what waits without letting
/// time pass: for the roll call.
///
/// After construction every member is free of allocation, locks, logs and exceptions.
class Simulator {
 public:
  /// `buses` in the order of robot.buses; robot and plant need not outlive the simulator, the
  /// buses do.
  /// Throws ConfigError: no drives, a start outside the joint limits, links the integrator cannot
  /// take, a plant with other joints or motors.
  Simulator(const LoadedRobot& robot, std::vector<CanBus*> buses, const SimulatorOptions& options);

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
  std::int64_t sim_time_ns() const noexcept { return clock_.now_ns(); }
  std::int64_t next_step_ns() const noexcept { return clock_.next_ns(); }
  /// Control periods completed.
  std::int64_t periods() const noexcept { return clock_.periods(); }

  /// Realtime: the arm time that it is now. Until it is first set, the timeline waits.
  void set_arm_time_ns(std::int64_t time_ns) noexcept { clock_.set_arm_time_ns(time_ns); }
  /// The messages outlive the simulator; those for others (modes, goals, gains) are passed over.
  void set_timeline(const std::vector<TimedMessage>* timeline) noexcept;
  /// A new session of the driver: if there is a timeline it starts over, in a world without walls,
  /// payload, pushes and faults, with its objects where they lay. Lock step sees a new session by
  /// itself, when the TICK's number falls.
  void restart_timeline() noexcept;

  /// Checked whole; false and nothing changed if a value is not finite, out of range, or names an
  /// unknown link, or all 8 slots for pushes are taken.
  bool push(const push_t& push) noexcept;
  bool event(const scenario_event_t& event) noexcept;
  bool workpiece(const workpiece_t& workpiece) noexcept;
  /// The drives of a joint get a frame over another wire than the bus, such as from their maker's
  /// tool; nobody hears what they answer.
  void tell_past_the_bus(int joint, const CanFrame& frame) noexcept {
    nodes_.tell(joint, frame, clock_.now_ns());
  }
  /// The simulated wire of a bus; nullptr without one.
  const sim::Wire* wire(int bus) const noexcept { return buses_[bus].wire(); }
  /// Messages of the timeline that were refused so.
  std::int64_t refused() const noexcept { return refused_; }

  /// The arm now. time_ns is the arm time of this very state: after TICK(k) has been advanced,
  /// (k+1) T, as in JOINT_STATE(k+1). seq is periods().
  const sim_truth_t& truth() noexcept;
  /// Likewise the block on a table; nullptr without one.
  const block_truth_t* block_truth() noexcept;
  /// The same of the hand; nullptr without one.
  const hand_truth_t* hand_truth() noexcept;
  /// Steps that were not taken because they would have ended in a state that is not finite; the arm
  /// stopped instead.
  std::int64_t diverged() const noexcept { return arm_.diverged(); }

 private:
  bool handle_frames() noexcept;
  void deliver() noexcept;
  bool on_tick(int bus, std::int64_t number) noexcept;
  void flush(int bus) noexcept;
  void carry_frames() noexcept;
  void step() noexcept;
  void apply_timeline() noexcept;
  bool apply(const ScenarioMessage& message) noexcept;
  void set_payload(double mass, const Eigen::Vector3d& p_TL) noexcept;
  void load_nodes() noexcept;

  bool lockstep_;
  sim::SimulatedArm arm_;
  sim::ArmNodes nodes_;
  sim::SimClock clock_;
  std::vector<sim::BusSide> buses_;
  sim::TickCount ticks_;
  Timeline timeline_{nullptr};
  bool has_timeline_ = false;
  std::int64_t refused_ = 0;
  sim_truth_t truth_{};
  block_truth_t block_truth_{};
  hand_truth_t hand_truth_{};
};

}  // namespace limber
