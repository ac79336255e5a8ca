#include "controller/cycle_parts.h"

#include "common/config_error.h"
#include "robots/loader/load_robot.h"

namespace limber::controller {

CycleParts::CycleParts(const LoadedRobot& robot, const std::string& law, bool simulated)
    : state(robot.robot.size()),
      arm(robot),
      laws({robot.robot, arm.model()}, law, simulated),
      goals(robot, &arm.model(), simulated),
      gains(robot.robot, arm.springs(), law_catalog().parameters),
      observers(robot),
      output(robot.robot),
      overlay(robot.robot),
      posture(TaskRows(gains.target().K_x), output.torque_limit()),
      gravity(VectorJ::Zero(robot.robot.size())),
      trace{.point = arm.point(),
            .terms = arm.terms(),
            .goal = goals.goal(),
            .gains = gains.effective(),
            .settings = gains.settings(),
            .estimates = observers.estimates(),
            .law = LawOutput(robot.robot.size()),
            .tau_null = gravity,
            .tau_gravity = gravity,
            .tau_coriolis = gravity,
            .tau_friction = gravity,
            .tau_sent = gravity,
            .selected_law = laws.selected()} {
  if (const char* reason = laws.check(laws.selected(), gains.target())) {
    throw ConfigError(robot.robot.name + ": " + law + ": " + reason);
  }
}

bool CycleParts::due(Term term) const noexcept {
  return cycles % gains.settings().period_cycles[static_cast<std::size_t>(term)] == 0;
}

PositionFeedback CycleParts::position() const noexcept {
  return gains.position(laws.running(), laws.holding(), arm);
}

void CycleParts::evaluate_model(Potential potential, const VectorJ& tau_constant) noexcept {
  const LawEntry& law = laws.running();
  const Gains& present = gains.effective();
  const bool carried =
      potential == Potential::kGravity ||
      chosen_compensation(law.compensation, present.settings.model_compensation).gravity;
  const bool first = cycles == 1;
  arm.evaluate(position(), state, {potential, carried, goals.goal(), present, tau_constant},
               {.jacobian = first || due(Term::kJacobian),
                .inertia = first || due(Term::kInertia),
                .coriolis = first || due(Term::kCoriolis),
                .tip_inertia = law.compensation.null_space});
  const VectorJ& most = output.torque_limit();
  if (arm.terms().g.allFinite()) gravity = arm.terms().g.cwiseMax(-most).cwiseMin(most);
}

LawInputs CycleParts::inputs(double dt_s) const noexcept {
  return {.point = arm.point(),
          .state = state,
          .terms = arm.terms(),
          .goal = goals.goal(),
          .gains = gains.effective(),
          .estimates = observers.estimates(),
          .elastic = arm.elastic(),
          .dt_s = dt_s,
          .stiffness_due = due(Term::kStiffness),
          .damping_due = due(Term::kDamping)};
}

const VectorJ& CycleParts::posture_torque(bool wanted) noexcept {
  if (!wanted) return posture.rest();
  const VectorJ& tau = posture.update(arm.point(), arm.terms(), goals.goal(), gains.effective());
  if (posture.rows_changed()) output.blend_next();
  return tau;
}

}  // namespace limber::controller
