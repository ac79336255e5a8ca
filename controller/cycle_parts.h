// What a control cycle works on: one owner each of the state, the model, the law, the goal, the
// gains, the observers and the torque that is sent.
#pragma once

#include <cstdint>
#include <string>

#include "controller/cycle_trace.h"
#include "controller/elastic/arm_view.h"
#include "controller/gains/gain_scheduler.h"
#include "controller/goals/goal_tracker.h"
#include "controller/impedance/posture.h"
#include "controller/laws/law_bank.h"
#include "controller/observers/observers.h"
#include "controller/output/passivity_guard.h"
#include "controller/output/torque_output.h"
#include "controller/output/torque_overlay.h"

namespace limber::controller {

/// TorqueCycle moves them along, LawSwitch starts a law with them. After construction all members
/// may be called in the cycle.
struct CycleParts {
  /// `simulated`: every bus is. Throws ConfigError.
  CycleParts(const LoadedRobot& robot, const std::string& law, bool simulated);
  CycleParts(const CycleParts&) = delete;  // `trace` refers to the others
  CycleParts& operator=(const CycleParts&) = delete;

  /// Where the running law receives an arm with springs.
  PositionFeedback position() const noexcept;
  /// The model at the control point, with goal and gains as they are; what is due of it.
  void evaluate_model(Potential potential, const VectorJ& tau_constant) noexcept;
  /// Rows of the task with the gains as they are: of the last cycle before GainScheduler::update.
  TaskRows rows() const noexcept { return TaskRows(gains.effective().K_x); }
  LawInputs inputs(double dt_s) const noexcept;
  /// Null-space torque of the running law, n, N m.
  const VectorJ& posture_torque(bool wanted) noexcept;

  ArmState state;
  ArmView arm;
  LawBank laws;
  GoalTracker goals;
  GainScheduler gains;
  Observers observers;
  PassivityGuard guard;
  TorqueOutput output;
  TorqueOverlay overlay;
  Posture posture;
  VectorJ gravity;  ///< n, N m, within the joints' limits; the last finite one
  CycleTrace trace;
  std::int64_t cycles = 0;

 private:
  bool due(Term term) const noexcept;
};

}  // namespace limber::controller
