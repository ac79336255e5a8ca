#include "controller/law_switch.h"

namespace limber::controller {

void LawSwitch::enter(Activity activity) noexcept {
  const Activity last = activity_;
  if (activity == last || activity == Activity::kStandby) return;
  CycleParts& p = parts_;
  const GoalType from = p.laws.running().goal_type;
  if (last == Activity::kStandby) {
    p.output.stand_by(p.state.tau_applied, {.preload = PreloadAtRest::kAsApplied}, p.state,
                      &p.trace.limits);
  }
  if (activity == Activity::kHold) p.laws.run_hold();
  if (activity == Activity::kLaw) p.laws.run_selected();
  activity_ = activity;
  if (activity == Activity::kStop) {
    p.goals.stop(static_cast<double>(kSoftStop_ns) * 1e-9);
  } else {
    start_law(from, true);
  }
}

void LawSwitch::select(int law, Activity activity) noexcept {
  CycleParts& p = parts_;
  p.laws.select(law);
  p.trace.selected_law = law;
  if (activity != Activity::kLaw || law == p.laws.running_index()) return;
  const GoalType from = p.laws.running().goal_type;
  p.laws.run_selected();
  // A law that follows a goal goes on with the one there is.
  start_law(from, p.laws.running().goal_type == GoalType::kNone || from == GoalType::kNone);
}

void LawSwitch::start_law(GoalType from, bool from_here) noexcept {
  CycleParts& p = parts_;
  const LawEntry& law = p.laws.running();
  const VectorJ none = VectorJ::Zero(p.gravity.size());
  p.output.blend_next();
  if (from_here) {
    p.evaluate_model(Potential::kGravity, none);
    p.goals.reset(p.arm.terms().X_BT, p.arm.point().q);
  } else {
    p.goals.hand_over(from, law.goal_type, p.rows(), p.arm.point().q);
  }
  p.guard.reset();
  p.gains.set_dissipated(0.0);
  p.goals.match(p.state.period_s, law.goal_type, p.rows());
  p.gains.update(p.goals.goal(), law, p.laws.holding(), p.arm, p.state.period_s);
  if (!from_here) p.evaluate_model(law.potential, none);
  p.trace.tau_null = p.posture_torque(law.compensation.null_space);
  // A law starts with terms of now, due or not.
  LawInputs now = p.inputs(0.0);
  now.stiffness_due = now.damping_due = true;
  p.laws.instance().start(now);
}

}  // namespace limber::controller
