// One control cycle, from the measured state to the torque. Mode logic is in Supervisor.
//
//   measure    velocities estimated; the model evaluated at the control point; contact observed
//   requests   goals and gains are taken; they act from this cycle on
//   step       goal, gains, law, passivity, model torque, output
//   or stand_by while no law runs
//
// The model is evaluated once a cycle, twice where a law begins. There are two orders: where the
// law receives a measured position, the model comes first (evaluate_measured_point); where it
// receives the link's static equilibrium, which depends on goal and gains, the model comes after
// them (evaluate_static_point), and what needs the model before (the springs' share of K_x, the
// tank) has it of the last cycle. Everything else that is of the last cycle is named last_*.
#pragma once

#include <limber/compliance_gains_t.hpp>
#include <limber/compliance_goal_t.hpp>
#include <limber/joint_state_t.hpp>
#include <limber/target_stream_t.hpp>
#include <limber/torque_overlay_t.hpp>

#include "controller/cycle_parts.h"
#include "controller/gains_request.h"
#include "controller/kinds/refusal.h"
#include "controller/law_switch.h"

namespace limber::controller {

/// After construction no member allocates, locks, logs or throws; all may be called in the cycle.
class TorqueCycle {
 public:
  using Allowed = GainsRequest::Allowed;
  /// Throws ConfigError.
  TorqueCycle(const LoadedRobot& robot, const std::string& law, Allowed allowed);

  /// A state that has been judged usable.
  void measure(const joint_state_t& message) noexcept;
  /// The next state does not follow on the last one: nothing estimated from the past is kept.
  void restart() noexcept { parts_.observers.restart(); }

  /// Nothing: accepted, perhaps with a warning; else why not; then nothing has changed.
  Refusal set_goal(const compliance_goal_t& message, Activity activity) noexcept;
  Refusal set_gains(const compliance_gains_t& message, Activity activity) noexcept;

  Refusal set_stream(const target_stream_t& message, Activity activity) noexcept;
  Refusal set_overlay(const torque_overlay_t& message) noexcept {
    return parts_.overlay.set(message, parts_.state.time_ns);
  }
  /// Of the last state, arm time.
  std::int64_t time_ns() const noexcept { return parts_.state.time_ns; }
  const TorqueOverlay& overlay() const noexcept { return parts_.overlay; }
  TargetStream& stream() noexcept { return parts_.goals.stream(); }

  /// One cycle of a law, `dt_s` after the last. Where an activity or a law begins, its first torque
  /// is the one present, and fades over. False if the result is not finite: the last torque stays.
  bool step(Activity activity, double dt_s) noexcept;
  /// One cycle without a law; the goal is where the arm is.
  void stand_by(const Standby& how) noexcept;

  const VectorJ& torque() const noexcept { return parts_.output.torque(); }
  const VectorJ& preload_torque() const noexcept { return parts_.output.preload_torque(); }
  /// The model's gravity torque, within the joints' limits; the last finite one.
  const VectorJ& gravity() const noexcept { return parts_.gravity; }
  /// As of measure().
  const ArmTerms& terms() const noexcept { return parts_.arm.terms(); }
  VectorJ spring_torque() const noexcept { return parts_.arm.spring_torque(parts_.state); }
  VectorJ link_gravity() noexcept { return parts_.arm.link_gravity(parts_.state); }
  const MatrixJ& link_inertia() noexcept { return parts_.arm.link_inertia(parts_.state); }
  /// Of the soft walls at the joints' ends in the last step(), N m.
  const VectorJ& walls() const noexcept { return parts_.output.walls(); }
  const CycleTrace& trace() const noexcept { return parts_.trace; }

 private:
  void evaluate_measured_point() noexcept;
  void evaluate_static_point() noexcept;
  void evaluate_and_observe(Potential potential) noexcept;
  bool law_takes_static_point() const noexcept;
  void compute_law(double dt_s) noexcept;
  void add_model_torque() noexcept;
  bool send(double dt_s) noexcept;
  void trace_result() noexcept;

  CycleParts parts_;
  LawSwitch switch_;
  GainsRequest request_;
  bool last_solved_ = true;
};

}  // namespace limber::controller
