#include "controller/elastic/arm_view.h"

#include <algorithm>

#include "controller/kinds/sensors.h"
#include "robots/loader/load_robot.h"

namespace limber::controller {
namespace {

// What a cycle has time for; the tolerance is a ten thousandth of an encoder step.
constexpr QbarSolver::Options kInTheCycle{
    .tolerance = 1e-9, .max_iterations = 30, .max_newton_steps = 6};

}  // namespace

ArmView::ArmView(const LoadedRobot& robot)
    : model_(robot),
      point_(model_.size()),
      terms_(model_.size()),
      springs_(robot.robot),
      link_measured_((sensors_of(robot.robot) & sensors::kLinkEncoder) != 0),
      elastic_(robot.robot, springs_),
      gravity_gradient_(MatrixJ::Zero(model_.size(), model_.size())),
      link_inertia_(gravity_gradient_),
      deflection_(VectorJ::Zero(model_.size())),
      torque_limit_(deflection_),
      qbar_(&model_, elastic_.K_J, kInTheCycle) {
  VectorJ home = deflection_;
  for (Eigen::Index i = 0; i < home.size(); ++i) {
    const JointConfig& joint = robot.robot.joints[static_cast<std::size_t>(i)];
    home[i] = joint.home;
    torque_limit_[i] = joint.torque_limit_Nm;
  }
  model_.evaluate(home, VectorJ::Zero(home.size()), &terms_);
  if (springs_.any()) gravity_gradient_ = model_.gravity_gradient(home);
}

PositionFeedback ArmView::resolve(PositionFeedback choice, Potential potential) const noexcept {
  if (!springs_.any()) return PositionFeedback::kLink;
  if (choice != PositionFeedback::kAuto) return choice;
  return potential == Potential::kNone ? PositionFeedback::kMotor : PositionFeedback::kStatic;
}

void ArmView::evaluate(PositionFeedback resolved, const ArmState& state, const Statics& statics,
                       const TermsDue& due) noexcept {
  point_.q = state.q;
  point_.v = state.v;
  if (springs_.any()) {
    point_.v = state.theta_dot;
    elastic_.K_J = springs_.stiffness(deflection_, state.preload);
    solved_ = true;
    if (resolved != PositionFeedback::kLink) point_.q = state.theta;
    if (resolved == PositionFeedback::kStatic) {
      unsolved_cycles_ =
          solve(state.theta, statics) ? std::max(unsolved_cycles_ - 1, 0) : kUnsolvedCycles;
      solved_ = unsolved_cycles_ == 0;
      if (solved_) point_.q = reachable(qbar_.q_bar(), state.theta);
    } else {
      unsolved_cycles_ = 0;
    }
    elastic_.position = solved_ ? resolved : PositionFeedback::kMotor;
    deflection_ = state.theta - (link_measured_ ? state.q : point_.q);
    gravity_gradient_ = model_.gravity_gradient(point_.q);
  }
  model_.evaluate(point_.q, point_.v, due, &terms_);
}

VectorJ ArmView::reachable(const VectorJ& q, const VectorJ& theta) const noexcept {
  const VectorJ bend = torque_limit_.cwiseQuotient(elastic_.K_J);
  return q.cwiseMax(theta - bend).cwiseMin(theta + bend);
}

bool ArmView::solve(const VectorJ& theta, const Statics& statics) noexcept {
  qbar_.set(elastic_.K_J, statics.gravity, statics.tau_constant);
  const Goal& goal = statics.goal;
  const Gains& gains = statics.gains;
  if (statics.potential == Potential::kTipSpring) {
    const LawSettings& s = gains.settings;
    return qbar_.solve(theta,
                       TipSpring{goal.X_BD, gains.K_x, s.orientation, goal.F_ff,
                                 SpringLimit(gains.K_x, s.spring_force_N, s.spring_moment_Nm)});
  }
  const bool spring = statics.potential == Potential::kJointSpring;
  const Eigen::Index n = theta.size();
  return qbar_.solve(theta,
                     JointSpring{goal.q_d, spring ? gains.K_q : MatrixJ(MatrixJ::Zero(n, n))});
}

}  // namespace limber::controller
