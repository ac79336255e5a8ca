// The arm as a law sees it in one cycle: the control point and the model's terms there.
#pragma once

#include "controller/elastic/joint_elasticity.h"
#include "controller/elastic/joint_springs.h"
#include "controller/elastic/qbar.h"
#include "controller/kinds/gains.h"
#include "controller/kinds/goal.h"
#include "controller/kinds/law_entry.h"
#include "controller/model/arm_state.h"
#include "controller/model/arm_terms.h"

#pragma GCC visibility push(default)
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
/// link's static equilibrium q_bar, no farther from the motor than the torque limit bends the
/// spring; on rigid joints it is the joint. After construction all members may be called in the
/// cycle.
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
  // The links as they are measured now; terms() of an arm with springs are those of the control
  // point.
  /// Torque of the springs on the links, n, N m; zero for rigid joints.
  VectorJ spring_torque(const ArmState& state) const noexcept {
    return springs_.torque(link_measured_ ? VectorJ(state.theta - state.q) : deflection_,
                           state.preload);
  }
  /// Torque that would hold their weight, n, N m.
  VectorJ link_gravity(const ArmState& state) noexcept {
    return springs_.any() ? model_.gravity(state.q) : terms_.g;
  }
  /// Their inertia, n x n, kg m^2. Stays valid until the next call.
  const MatrixJ& link_inertia(const ArmState& state) noexcept {
    if (!springs_.any()) return terms_.M;
    link_inertia_ = model_.mass(state.q);
    return link_inertia_;
  }
  /// theta - q, n, rad: measured, or with q at the control point.
  const VectorJ& deflection() const noexcept { return deflection_; }
  /// False while q_bar has no solution, and for kUnsolvedCycles after: the control point is then
  /// the motor's, so that it does not change back and forth where solutions come and go.
  bool solved() const noexcept { return solved_; }

 private:
  static constexpr int kUnsolvedCycles = 50;

  bool solve(const VectorJ& theta, const Statics& statics) noexcept;
  /// q, or the nearest to it that the motors' torque limits hold the links at.
  VectorJ reachable(const VectorJ& q, const VectorJ& theta) const noexcept;

  ArmModel model_;
  ControlPoint point_;
  ArmTerms terms_;
  JointSprings springs_;
  bool link_measured_;
  JointElasticity elastic_;
  MatrixJ gravity_gradient_;
  MatrixJ link_inertia_;
  VectorJ deflection_;
  VectorJ torque_limit_;
  QbarSolver qbar_;
  int unsolved_cycles_ = 0;  ///< to come
  bool solved_ = true;
};

}  // namespace limber::controller
#pragma GCC visibility pop
