// The arm as a law sees it in one cycle: the control point and the model's terms there.
#pragma once

#include "controller/elastic/joint_elasticity.h"
#include "controller/elastic/joint_springs.h"
#include "controller/elastic/qbar.h"
#include "controller/gains/gains.h"
#include "controller/goals/goal.h"
#include "controller/laws/law.h"
#include "controller/model/arm_state.h"
#include "controller/model/arm_terms.h"

namespace limber::controller {

/// What determines where the link of an elastic joint is at rest while its motor stays where it is.
struct Statics {
  Potential potential;
  bool gravity;  ///< the weight is part of it
  const Goal& goal;
  const Gains& gains;
  const VectorJ& tau_constant;  ///< further torque (null space), N m, taken as constant
};

/// Owns the model. On elastic joints the control point is the measured link, the motor, or the
/// link's static equilibrium q_bar; on rigid joints it is the joint. After construction all members
/// may be called in the cycle.
class ArmView {
 public:
  explicit ArmView(const LoadedRobot& robot);

  /// kAuto resolved for a law with this potential; kLink for rigid arms.
  PositionFeedback resolve(PositionFeedback choice, Potential potential) const noexcept;
  /// Finds the control point and evaluates the terms that are due there.
  void evaluate(PositionFeedback resolved, const ArmState& state, const Statics& statics,
                const TermsDue& due) noexcept;

  const ControlPoint& point() const noexcept { return point_; }
  /// Before the first evaluation: of the arm at rest in its home pose.
  const ArmTerms& terms() const noexcept { return terms_; }
  ArmModel& model() noexcept { return model_; }

  const JointSprings& springs() const noexcept { return springs_; }
  /// Stiffness of the springs as they are stretched now, n, N m/rad.
  const VectorJ& K_J() const noexcept { return elastic_.K_J; }
  /// The springs, and the position that the law received last; nullptr for rigid arms.
  const JointElasticity* elastic() const noexcept { return springs_.any() ? &elastic_ : nullptr; }
  /// dg/dq at the control point, n x n, N m/rad; zero for rigid arms, which no weight buckles.
  const MatrixJ& gravity_gradient() const noexcept { return gravity_gradient_; }
  /// What acts on the links as they are measured, n, N m: the springs (zero for rigid joints), and
  /// the torque that would hold the weight, which terms() has at the control point.
  VectorJ spring_torque(const ArmState& state) const noexcept {
    return springs_.torque(deflection_, state.preload);
  }
  VectorJ link_gravity(const ArmState& state) noexcept {
    return springs_.any() ? model_.gravity(state.q) : terms_.g;
  }
  /// theta - q, n, rad: measured, or with q at the control point.
  const VectorJ& deflection() const noexcept { return deflection_; }
  /// False while q_bar has no solution: the control point is then the motor's.
  bool solved() const noexcept { return solved_; }

 private:
  bool solve(const VectorJ& theta, const Statics& statics) noexcept;

  ArmModel model_;
  ControlPoint point_;
  ArmTerms terms_;
  JointSprings springs_;
  bool link_measured_;
  JointElasticity elastic_;
  MatrixJ gravity_gradient_;
  VectorJ deflection_;
  QbarSolver qbar_;
  bool solved_ = true;
};

}  // namespace limber::controller
