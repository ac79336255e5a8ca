#include "controller/torque_cycle.h"

#include <algorithm>
#include <limber/controller_status_t.hpp>

#include "common/config_error.h"
#include "controller/gains/nullspace.h"
#include "controller/model/singularity.h"
#include "controller/modes/mode_table.h"
#include "lcmtypes/gains_merge.h"
#include "robots/loader/default_gains.h"

namespace limber::controller {
namespace {

// The posture may take this share of a joint's torque.
constexpr double kNullShare = 0.3;

}  // namespace

void TorqueCycle::measure(const joint_state_t& message) noexcept {
  ++cycles_;
  read_arm_state(message, &state_);
  observers_.estimate_velocity(&state_);
  const bool standby = last_activity_ == Activity::kStandby;
  if (!point_depends_on_goal()) {
    evaluate_and_observe(standby ? Potential::kGravity : laws_.running().potential);
  }
}

// A link in static equilibrium under its law is found in step(), with goal and gains of this cycle.
bool TorqueCycle::point_depends_on_goal() const noexcept {
  return last_activity_ != Activity::kStandby && position() == PositionFeedback::kStatic;
}

void TorqueCycle::evaluate_and_observe(Potential potential) noexcept {
  evaluate_model(potential, trace_.tau_null);
  observers_.observe(state_, arm_.terms(), last_rows());
}

bool TorqueCycle::step(Activity activity, double dt_s) noexcept {
  enter(activity);
  output_.follow_drives(state_);
  const LawEntry& law = laws_.running();
  trace_.limits = 0;

  const Goal& goal = goals_.advance(dt_s, state_.period_s, law.goal_type, last_rows());
  gains_.advance(dt_s);
  gains_.update(goal, law, laws_.holding(), arm_, state_.period_s);
  if (point_depends_on_goal()) evaluate_and_observe(law.potential);

  trace_.law.reset();
  laws_.instance().compute(inputs(dt_s), &trace_.law);
  trace_.reports.fill(0.0F);
  laws_.instance().report(trace_.reports.data());
  gains_.set_dissipated(std::max(-trace_.law.tau_damping.dot(arm_.point().v), 0.0));
  guard_.damp(arm_.terms(), goal, state_.period_s, law.goal_type, &trace_.law);
  add_model_torque(law);

  trace_.limits |= trace_.law.limits;
  if (arm_.solved() != last_solved_) output_.blend_next();
  last_solved_ = arm_.solved();
  const VectorJ tau = trace_.law.tau() + trace_.tau_null + trace_.tau_gravity +
                      trace_.tau_coriolis + trace_.tau_friction;
  const bool finite = output_.shape(tau, laws_.instance().preload(), state_, arm_.terms(),
                                    arm_.deflection(), dt_s, &trace_.limits);
  if (gains_.moving()) trace_.limits |= controller_status_t::LIMIT_RAMP;
  if (gains_.reduced()) trace_.limits |= controller_status_t::LIMIT_STIFFNESS;
  if (!arm_.solved()) trace_.limits |= controller_status_t::LIMIT_STATIC_UNSOLVED;
  trace_result();
  return finite;
}

void TorqueCycle::stand_by(const Standby& how) noexcept {
  if (last_activity_ != Activity::kStandby) evaluate_model(Potential::kGravity, zero_);
  last_activity_ = Activity::kStandby;
  goals_.reset(arm_.terms().X_BT, arm_.point().q);
  guard_.reset();
  gains_.set_dissipated(0.0);
  trace_.law.reset();
  trace_.reports.fill(0.0F);
  trace_.limits = 0;
  trace_.tau_null = trace_.tau_coriolis = trace_.tau_friction = zero_;
  trace_.tau_gravity = gravity_;
  VectorJ target = zero_;
  if (how.torque == Standby::Torque::kGravity) target = gravity_;
  if (how.torque == Standby::Torque::kAsSent) target = state_.tau_applied;
  output_.stand_by(target, how, state_, &trace_.limits);
  trace_result();
}

void TorqueCycle::trace_result() noexcept {
  trace_.tau_sent = output_.torque();
  trace_.tank_energy_J = gains_.tank_energy_J();
  trace_.passivity_energy_J = guard_.energy_J();
}

// Where the activity changes. Whatever runs then starts where the arm is.
void TorqueCycle::enter(Activity activity) noexcept {
  const Activity last = last_activity_;
  if (activity == last || activity == Activity::kStandby) return;
  const GoalType from = laws_.running().goal_type;
  if (last == Activity::kStandby) {
    output_.stand_by(state_.tau_applied, {.preload = PreloadAtRest::kAsApplied}, state_,
                     &trace_.limits);
  }
  if (activity == Activity::kHold) laws_.run_hold();
  if (activity == Activity::kLaw) laws_.run_selected();
  last_activity_ = activity;
  if (activity == Activity::kStop) {
    goals_.stop(static_cast<double>(kSoftStop_ns) * 1e-9);
  } else {
    switch_law(from, true);
  }
}

// The running law has changed: the model is evaluated once more, at the point where this law looks.
void TorqueCycle::switch_law(GoalType from, bool from_here) noexcept {
  const LawEntry& law = laws_.running();
  output_.blend_next();
  if (from_here) {
    evaluate_model(Potential::kGravity, zero_);
    goals_.reset(arm_.terms().X_BT, arm_.point().q);
  } else {
    goals_.hand_over(from, law.goal_type, last_rows(), arm_.point().q);
  }
  guard_.reset();
  gains_.set_dissipated(0.0);
  goals_.match(state_.period_s, law.goal_type, last_rows());
  gains_.update(goals_.goal(), law, laws_.holding(), arm_, state_.period_s);
  if (!from_here) evaluate_model(law.potential, zero_);
  trace_.tau_null = law.compensation.null_space ? null_space_torque() : zero_;
  // A law starts with terms of now, due or not.
  LawInputs now = inputs(0.0);
  now.stiffness_due = now.damping_due = true;
  laws_.instance().start(now);
}

Refusal TorqueCycle::set_goal(const compliance_goal_t& message, Activity activity) noexcept {
  enter(activity);
  const GoalTracker::Set set = goals_.set(message, laws_.running().goal_type);
  if (set.switched) output_.blend_next();
  return set.refusal;
}

Refusal TorqueCycle::set_gains(const compliance_gains_t& message, Activity activity) noexcept {
  enter(activity);
  compliance_gains_t fields =
      requested_fields_;  // its strings and lists are empty: nothing is allocated
  merge_gains(message, &fields);
  if (const char* reason = check_.check(message, fields))
    return {request_answer_t::REFUSED_GAINS_RANGE, reason};
  const int law = message.law.empty() ? laws_.selected() : find_law(message.law);
  if (law < 0) return {request_answer_t::REFUSED_MALFORMED, "no control law has this name"};
  const LawEntry& wanted = LawBank::entry(law);
  candidate_ = requested_;
  read_gains(fields, &candidate_);
  read_parameters(message, &candidate_.parameters, fields.num_joints);
  if (const char* reason = laws_.check(law, candidate_))
    return {request_answer_t::REFUSED_LAW, reason};
  if (const char* reason = gains_.check_springs(candidate_, wanted, goals_.goal(), arm_)) {
    return {request_answer_t::REFUSED_SPRINGS, reason};
  }
  if (const char* reason = estimator_.check(candidate_.settings, arm_.terms()))
    return {request_answer_t::REFUSED_GAINS_RANGE, reason};
  const Doubts doubts = doubts_about(candidate_, wanted);
  if (!allow_unstable_ && doubts.unstable != nullptr) {
    return {request_answer_t::REFUSED_UNSTABLE, doubts.unstable};
  }

  requested_fields_ = fields;
  requested_ = candidate_;
  observers_.set(requested_.settings);
  guard_.set_max_damping(requested_.settings.passivity_damping_Ns_per_m);
  if (gains_.start(requested_, message.ramp_s)) output_.blend_next();
  laws_.select(law);
  trace_.selected_law = law;
  if (activity == Activity::kLaw && law != laws_.running_index()) {
    // A law that follows a goal goes on with the one there is.
    const GoalType from = laws_.running().goal_type;
    laws_.run_selected();
    switch_law(from, wanted.goal_type == GoalType::kNone || from == GoalType::kNone);
  }
  return {.warning = doubts.unstable != nullptr ? doubts.unstable : doubts.undamped};
}

TorqueCycle::Doubts TorqueCycle::doubts_about(const Gains& gains, const LawEntry& law) noexcept {
  if (arm_.elastic() == nullptr) {
    return {stability_.check(gains, arm_.terms()), nullptr};
  }
  JointElasticity elastic = *arm_.elastic();
  elastic.K_J = arm_.springs().at_rest();
  elastic.position = arm_.resolve(gains.settings.position_feedback, law.potential);
  const Gains here = gains_.here(gains, law, goals_.goal(), arm_);
  return {stability_.check(here, arm_.terms(), &elastic),
          damping_.check(here, law, arm_.terms(), elastic)};
}

bool TorqueCycle::due(Term term) const noexcept {
  return cycles_ % gains_.settings().period_cycles[static_cast<std::size_t>(term)] == 0;
}

LawInputs TorqueCycle::inputs(double dt_s) const noexcept {
  return {.point = arm_.point(),
          .state = state_,
          .terms = arm_.terms(),
          .goal = goals_.goal(),
          .gains = gains_.effective(),
          .estimates = observers_.estimates(),
          .elastic = arm_.elastic(),
          .dt_s = dt_s,
          .stiffness_due = due(Term::kStiffness),
          .damping_due = due(Term::kDamping)};
}

PositionFeedback TorqueCycle::position() const noexcept {
  return gains_.position(laws_.running(), laws_.holding(), arm_);
}

// With goal and gains as they are.
void TorqueCycle::evaluate_model(Potential potential, const VectorJ& tau_constant) noexcept {
  const LawEntry& law = laws_.running();
  const Gains& gains = gains_.effective();
  const bool gravity =
      potential == Potential::kGravity ||
      chosen_compensation(law.compensation, gains.settings.model_compensation).gravity;
  const bool first = cycles_ == 1;
  arm_.evaluate(position(), state_, {potential, gravity, goals_.goal(), gains, tau_constant},
                {.jacobian = first || due(Term::kJacobian),
                 .inertia = first || due(Term::kInertia),
                 .coriolis = first || due(Term::kCoriolis),
                 .tip_inertia = law.compensation.null_space});
  const VectorJ& most = output_.torque_limit();
  if (arm_.terms().g.allFinite()) gravity_ = arm_.terms().g.cwiseMax(-most).cwiseMin(most);
}

void TorqueCycle::add_model_torque(const LawEntry& law) noexcept {
  const LawSettings& settings = gains_.effective().settings;
  const Compensation add = chosen_compensation(law.compensation, settings.model_compensation);
  trace_.tau_null = add.null_space ? null_space_torque() : zero_;
  trace_.tau_gravity = add.gravity ? arm_.terms().g : zero_;
  trace_.tau_coriolis = add.coriolis ? arm_.terms().Cv : zero_;
  trace_.tau_friction = friction_torque(law.goal_type);
}

VectorJ TorqueCycle::null_space_torque() noexcept {
  const Gains& gains = gains_.effective();
  const TaskRows rows(gains.K_x);
  if (!(rows == last_null_rows_)) output_.blend_next();  // the task lost or gained a direction
  last_null_rows_ = rows;
  return controller::null_space_torque(arm_.point(), arm_.terms(), goals_.goal(), gains, rows,
                                       null_limit_);
}

VectorJ TorqueCycle::friction_torque(GoalType type) noexcept {
  if (gains_.effective().settings.friction_compensation == FrictionCompensation::kNone) {
    return zero_;
  }
  const Goal& goal = goals_.goal();
  VectorJ v_d = zero_;
  if (follows_joints(type)) {
    v_d = goal.v_d;
  } else if (!goal.V_BD.isZero(0.0)) {
    v_d = damped_pseudo_inverse(arm_.terms().J) * goal.V_BD;
  }
  return observers_.friction(v_d, arm_.point().v, arm_.terms());
}

TorqueCycle::TorqueCycle(const LoadedRobot& robot, const std::string& law, Allowed allowed)
    : state_(robot.robot.size()),
      arm_(robot),
      laws_(robot, law, allowed.demonstrations),
      goals_(robot, &arm_.model(), allowed.demonstrations),
      gains_(robot.robot, arm_.springs()),
      observers_(robot),
      output_(robot.robot),
      trace_{.point = arm_.point(),
             .terms = arm_.terms(),
             .goal = goals_.goal(),
             .gains = gains_.effective(),
             .settings = gains_.settings(),
             .estimates = observers_.estimates(),
             .law = LawOutput(robot.robot.size()),
             .tau_null = VectorJ::Zero(robot.robot.size()),
             .tau_gravity = VectorJ::Zero(robot.robot.size()),
             .tau_coriolis = VectorJ::Zero(robot.robot.size()),
             .tau_friction = VectorJ::Zero(robot.robot.size()),
             .tau_sent = VectorJ::Zero(robot.robot.size()),
             .selected_law = laws_.selected()},
      check_(robot.robot.size(), allowed.demonstrations),
      stability_(1.0 / robot.robot.rate_hz, robot.robot.joint_names()),
      estimator_(robot.robot, output_.torque_limit()),
      allow_unstable_(allowed.unstable_gains),
      requested_fields_(limber::default_gains(robot.robot)),
      requested_(gains_.target()),
      candidate_(requested_),
      gravity_(VectorJ::Zero(robot.robot.size())),
      zero_(gravity_),
      null_limit_(kNullShare * output_.torque_limit()),
      last_null_rows_(gains_.target().K_x) {
  if (const char* reason = laws_.check(laws_.selected(), gains_.target())) {
    throw ConfigError(robot.robot.name + ": " + law + ": " + reason);
  }
}

}  // namespace limber::controller
