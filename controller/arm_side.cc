#include "controller/arm_side.h"

#include "controller/laws/registry.h"

namespace limber::controller {
namespace {

// What a cycle has time for; an encoder sees a ten thousandth of the tolerance's inverse.
constexpr QbarSolver::Options kInTheCycle{
    .tolerance = 1e-9, .max_iterations = 30, .max_newton_steps = 6};

}  // namespace

ArmSide::ArmSide(const Robot& robot, ArmModel* model)
    : springs_(robot),
      link_measured_((sensors_of(robot) & sensors::kLinkEncoder) != 0),
      K_J_(springs_.at_rest()),
      deflection_(VectorJ::Zero(robot.size())),
      qbar_(model, K_J_, kInTheCycle) {}

Position ArmSide::resolve(Position asked, StaticForm form) const noexcept {
  if (!springs_.any()) return Position::kLink;
  if (asked != Position::kOfArm) return asked;
  return form == StaticForm::kNone ? Position::kMotor : Position::kStatic;
}

void ArmSide::look(Position resolved, const ArmState& measured, const Statics& statics,
                   ArmState* seen) noexcept {
  *seen = measured;
  if (!springs_.any()) return;
  seen->v = measured.theta_dot;
  K_J_ = springs_.stiffness(deflection_, measured.preload);
  solved_ = true;
  if (resolved != Position::kLink) seen->q = measured.theta;
  if (resolved == Position::kStatic) {
    solved_ = solve(measured.theta, statics);
    seen->q = qbar_.q_bar();
  }
  deflection_ = measured.theta - (link_measured_ ? measured.q : seen->q);
}

bool ArmSide::solve(const VectorJ& theta, const Statics& statics) noexcept {
  qbar_.set(K_J_, statics.gravity, statics.besides);
  const Goal& goal = statics.goal;
  const Gains& gains = statics.gains;
  if (statics.form == StaticForm::kTipSpring) {
    const LawSettings& s = gains.settings;
    return qbar_.solve(theta,
                       TipSpring{goal.X_BD, gains.K_x, s.orientation, goal.F_ff,
                                 SpringLimit(gains.K_x, s.spring_force_N, s.spring_moment_Nm)});
  }
  const bool spring = statics.form == StaticForm::kJointSpring;
  const Eigen::Index n = theta.size();
  return qbar_.solve(theta,
                     JointSpring{goal.q_d, spring ? gains.K_q : MatrixJ(MatrixJ::Zero(n, n))});
}

}  // namespace limber::controller
