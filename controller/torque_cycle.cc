#include "controller/torque_cycle.h"

#include <algorithm>
#include <limber/controller_status_t.hpp>

#include "robots/loader/load_robot.h"

namespace limber::controller {

TorqueCycle::TorqueCycle(const LoadedRobot& robot, const std::string& law, Allowed allowed)
    : parts_(robot, law, allowed.demonstrations),
      switch_(&parts_),
      request_(robot, &parts_, allowed) {}

void TorqueCycle::measure(const joint_state_t& message) noexcept {
  ++parts_.cycles;
  read_arm_state(message, &parts_.state);
  parts_.observers.estimate_velocity(&parts_.state);
  evaluate_measured_point();
}

bool TorqueCycle::law_takes_static_point() const noexcept {
  return switch_.activity() != Activity::kStandby && parts_.position() == PositionFeedback::kStatic;
}

// First the model, then goal and gains.
void TorqueCycle::evaluate_measured_point() noexcept {
  if (law_takes_static_point()) return;
  const bool standby = switch_.activity() == Activity::kStandby;
  evaluate_and_observe(standby ? Potential::kGravity : parts_.laws.running().potential);
}

// First goal and gains, then the model.
void TorqueCycle::evaluate_static_point() noexcept {
  if (law_takes_static_point()) evaluate_and_observe(parts_.laws.running().potential);
}

void TorqueCycle::evaluate_and_observe(Potential potential) noexcept {
  parts_.evaluate_model(potential, parts_.posture.last_torque());
  parts_.observers.observe(parts_.state, parts_.arm.terms(), parts_.rows());
}

bool TorqueCycle::step(Activity activity, double dt_s) noexcept {
  CycleParts& p = parts_;
  switch_.enter(activity);
  p.output.follow_drives(p.state);
  p.trace.begin();

  const LawEntry& law = p.laws.running();
  const double period_s = p.state.period_s;
  const Goal& goal = p.goals.advance(dt_s, p.state.time_ns, period_s, law.goal_type, p.rows());
  p.gains.advance(dt_s);
  p.gains.update(goal, law, p.laws.holding(), p.arm, period_s);
  evaluate_static_point();

  compute_law(dt_s);
  p.guard.damp(p.arm.terms(), goal, period_s, law.goal_type, &p.trace.law);
  add_model_torque();
  return send(dt_s);
}

void TorqueCycle::compute_law(double dt_s) noexcept {
  CycleParts& p = parts_;
  p.laws.instance().compute(p.inputs(dt_s), &p.trace.law);
  p.laws.instance().report(p.trace.reports.data());
  p.gains.set_dissipated(std::max(-p.trace.law.tau_damping.dot(p.arm.point().v), 0.0));
}

void TorqueCycle::add_model_torque() noexcept {
  CycleParts& p = parts_;
  const LawEntry& law = p.laws.running();
  const LawSettings& settings = p.gains.effective().settings;
  const Compensation add = chosen_compensation(law.compensation, settings.model_compensation);
  const VectorJ none = VectorJ::Zero(p.gravity.size());
  p.trace.tau_null = p.posture_torque(add.null_space);
  p.trace.tau_gravity = add.gravity ? p.arm.terms().g : none;
  p.trace.tau_coriolis = add.coriolis ? p.arm.terms().Cv : none;
  p.trace.tau_friction =
      settings.friction_compensation == FrictionCompensation::kNone
          ? none
          : p.observers.friction(p.goals.goal(), law.goal_type, p.arm.point().v, p.arm.terms());
  if (switch_.activity() == Activity::kLaw)
    p.trace.law.tau_feedforward += p.overlay.torque(p.state.time_ns);
}

bool TorqueCycle::send(double dt_s) noexcept {
  CycleParts& p = parts_;
  CycleTrace& trace = p.trace;
  trace.limits |= trace.law.limits;
  if (p.arm.solved() != last_solved_) p.output.blend_next();
  last_solved_ = p.arm.solved();
  const VectorJ tau = trace.law.tau() + trace.tau_null + trace.tau_gravity + trace.tau_coriolis +
                      trace.tau_friction;
  const bool finite = p.output.shape(tau, p.laws.instance().preload(), p.state, p.arm.terms(),
                                     p.arm.deflection(), dt_s, &trace.limits);
  if (p.goals.stream().bounded()) trace.limits |= controller_status_t::LIMIT_STREAM;
  if (p.gains.moving()) trace.limits |= controller_status_t::LIMIT_RAMP;
  if (p.gains.reduced()) trace.limits |= controller_status_t::LIMIT_STIFFNESS;
  if (!p.arm.solved()) trace.limits |= controller_status_t::LIMIT_STATIC_UNSOLVED;
  trace_result();
  return finite;
}

void TorqueCycle::stand_by(const Standby& how) noexcept {
  CycleParts& p = parts_;
  const VectorJ none = VectorJ::Zero(p.gravity.size());
  if (switch_.activity() != Activity::kStandby) p.evaluate_model(Potential::kGravity, none);
  switch_.stand_by();
  p.goals.reset(p.arm.terms().X_BT, p.arm.point().q);
  p.guard.reset();
  p.gains.set_dissipated(0.0);
  p.trace.begin();
  p.trace.tau_null = p.posture.rest();
  p.trace.tau_coriolis = p.trace.tau_friction = none;
  p.trace.tau_gravity = p.gravity;
  VectorJ target = none;
  if (how.torque == Standby::Torque::kGravity) target = p.gravity;
  if (how.torque == Standby::Torque::kAsSent) target = p.state.tau_applied;
  p.output.stand_by(target, how, p.state, &p.trace.limits);
  trace_result();
}

void TorqueCycle::trace_result() noexcept {
  parts_.trace.tau_sent = parts_.output.torque();
  parts_.trace.tank_energy_J = parts_.gains.tank_energy_J();
  parts_.trace.passivity_energy_J = parts_.guard.energy_J();
}

Refusal TorqueCycle::set_goal(const compliance_goal_t& message, Activity activity) noexcept {
  switch_.enter(activity);
  const GoalTracker::Set set = parts_.goals.set(message, parts_.laws.running().goal_type);
  if (set.switched) parts_.output.blend_next();
  return set.refusal;
}

Refusal TorqueCycle::set_stream(const target_stream_t& message, Activity activity) noexcept {
  switch_.enter(activity);
  const GoalTracker::Set set =
      parts_.goals.set_stream(message, parts_.laws.running().goal_type, parts_.state.time_ns);
  if (set.switched) parts_.output.blend_next();
  if (!set.refusal && message.stiffness_scale != 0.0F)
    parts_.gains.scale_stiffness(static_cast<double>(message.stiffness_scale));
  return set.refusal;
}

Refusal TorqueCycle::set_gains(const compliance_gains_t& message, Activity activity) noexcept {
  switch_.enter(activity);
  const Refusal refusal = request_.take(message);
  if (refusal != nullptr) return refusal;
  const Gains& gains = request_.gains();
  parts_.observers.set(gains.settings);
  parts_.guard.set_max_damping(gains.settings.passivity_damping_Ns_per_m);
  if (parts_.gains.start(gains, message.ramp_s)) parts_.output.blend_next();
  switch_.select(request_.law(), activity);
  return refusal;
}

}  // namespace limber::controller
