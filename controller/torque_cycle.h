// One control cycle, from the measured state to the torque. Mode logic is in Supervisor.
//
//   measure    velocities estimated; the model evaluated at the control point; contact observed
//   requests   goals and gains are taken; they act from this cycle on
//   step       goal, gains, law, passivity, model torque, output: see torque_cycle.cc
//   or stand_by while no law runs
//
// The model is evaluated once a cycle, twice where a law begins. Where the control point is the
// link's static equilibrium, it depends on goal and gains: then it is found in step(), between
// gains and law, and what needs the model before (the springs' share of K_x, the tank) has it of
// the last cycle. Everything else that is of the last cycle is named last_*.
#pragma once

#include <limber/compliance_gains_t.hpp>
#include <limber/compliance_goal_t.hpp>
#include <limber/joint_state_t.hpp>

#include "controller/cycle_trace.h"
#include "controller/gains/damping_check.h"
#include "controller/gains/gain_scheduler.h"
#include "controller/gains/gains_check.h"
#include "controller/gains/stability.h"
#include "controller/goals/goal_tracker.h"
#include "controller/laws/law_bank.h"
#include "controller/model/arm_view.h"
#include "controller/observers/estimator_check.h"
#include "controller/observers/observers.h"
#include "controller/output/passivity_guard.h"
#include "controller/output/torque_output.h"
#include "controller/refusal.h"

namespace limber::controller {

/// What the cycle does in a mode.
enum class Activity {
  kStandby,  ///< no law runs
  kHold,     ///< joint_pd where the arm was, with nothing of the user's choices but K_q: it carries
             ///< the weight and damps, whatever was tried before
  kLaw,      ///< the selected law
  kStop,     ///< the running law, while its goal comes to rest
};

/// After construction no member allocates, locks, logs or throws; all may be called in the cycle.
class TorqueCycle {
 public:
  struct Allowed {
    bool demonstrations =
        false;  ///< of mistakes, and goals out of reach: where every bus is simulated
    bool unstable_gains = false;
  };
  /// Throws ConfigError.
  TorqueCycle(const LoadedRobot& robot, const std::string& law, Allowed allowed);

  /// A state that has been judged usable.
  void measure(const joint_state_t& message) noexcept;
  /// The next state does not follow on the last one: nothing estimated from the past is kept.
  void restart() noexcept { observers_.restart(); }

  /// Nothing: accepted, perhaps with a warning; else why not; then nothing has changed.
  Refusal set_goal(const compliance_goal_t& message, Activity activity) noexcept;
  Refusal set_gains(const compliance_gains_t& message, Activity activity) noexcept;

  /// One cycle of a law, `dt_s` after the last. Where an activity or a law begins, its first torque
  /// is the one present, and fades over. False if the result is not finite: the last torque stays.
  bool step(Activity activity, double dt_s) noexcept;
  /// One cycle without a law; the goal is where the arm is.
  void stand_by(const Standby& how) noexcept;

  const VectorJ& torque() const noexcept { return output_.torque(); }
  const VectorJ& preload_torque() const noexcept { return output_.preload_torque(); }
  /// The model's gravity torque, within the joints' limits; the last finite one.
  const VectorJ& gravity() const noexcept { return gravity_; }
  /// As of measure().
  const ArmTerms& terms() const noexcept { return arm_.terms(); }
  /// Likewise, of ArmView.
  VectorJ spring_torque() const noexcept { return arm_.spring_torque(state_); }
  VectorJ link_gravity() noexcept { return arm_.link_gravity(state_); }
  const MatrixJ& link_inertia() noexcept { return arm_.link_inertia(state_); }
  /// Of the soft walls at the joints' ends in the last step(), N m.
  const VectorJ& walls() const noexcept { return output_.walls(); }
  const CycleTrace& trace() const noexcept { return trace_; }

 private:
  /// nullptr each where there is none.
  struct Doubts {
    const char* unstable;
    const char* undamped;
  };
  Doubts doubts_about(const Gains& gains, const LawEntry& law) noexcept;
  void enter(Activity activity) noexcept;
  void switch_law(GoalType from, bool from_here) noexcept;
  void evaluate_model(Potential potential, const VectorJ& tau_constant) noexcept;
  void evaluate_and_observe(Potential potential) noexcept;
  bool point_depends_on_goal() const noexcept;
  PositionFeedback position() const noexcept;
  bool due(Term term) const noexcept;
  LawInputs inputs(double dt_s) const noexcept;
  TaskRows last_rows() const noexcept { return TaskRows(gains_.effective().K_x); }
  void add_model_torque(const LawEntry& law) noexcept;
  VectorJ null_space_torque() noexcept;
  void trace_result() noexcept;
  VectorJ friction_torque(GoalType type) noexcept;

  ArmState state_;
  ArmView arm_;
  LawBank laws_;
  GoalTracker goals_;
  GainScheduler gains_;
  Observers observers_;
  PassivityGuard guard_;
  TorqueOutput output_;
  CycleTrace trace_;

  GainsCheck check_;
  StabilityCheck stability_;
  DampingCheck damping_;
  EstimatorCheck estimator_;
  bool allow_unstable_;
  compliance_gains_t requested_fields_;  // of the last accepted request, merged; no parameters
  Gains requested_;                      // the same, with parameters
  Gains candidate_;                      // those of a request that is not accepted yet
  VectorJ gravity_;
  VectorJ zero_;
  VectorJ null_limit_;
  std::int64_t cycles_ = 0;
  Activity last_activity_ = Activity::kStandby;
  TaskRows last_null_rows_;
  bool last_solved_ = true;
};

}  // namespace limber::controller
