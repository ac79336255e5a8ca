// Which side of its elastic joints an arm is controlled at.
#pragma once

#include "controller/arm_state.h"
#include "controller/arm_terms.h"
#include "controller/gains.h"
#include "controller/goal.h"
#include "controller/laws/law.h"
#include "controller/motor_side/joint_springs.h"
#include "controller/motor_side/qbar.h"

namespace limber::controller {

/// What the law that runs asks of the link at rest.
struct Statics {
  StaticForm form;
  bool gravity;  ///< the weight is part of it
  const Goal& goal;
  const Gains& gains;
  const VectorJ& besides;  ///< torque besides (null space), N m, taken as constant
};

/// Puts in the place of (q, v) what Position says; a rigid arm is left as it is measured. After
/// construction all members may be called in the cycle.
class ArmSide {
 public:
  /// The model must outlive this.
  ArmSide(const Robot& robot, ArmModel* model);

  const JointSprings& springs() const noexcept { return springs_; }
  /// Stiffness of the springs as they are stretched now, n, N m/rad.
  const VectorJ& K_J() const noexcept { return K_J_; }
  /// kOfArm told apart; kLink for rigid arms.
  Position resolve(Position asked, StaticForm form) const noexcept;

  /// The state as the law shall see it.
  void look(Position resolved, const ArmState& measured, const Statics& statics,
            ArmState* seen) noexcept;
  /// theta - q, n, rad: measured, or as the law takes it.
  const VectorJ& deflection() const noexcept { return deflection_; }
  /// False while q_bar has no solution: then the law sees the motor's position.
  bool solved() const noexcept { return solved_; }

 private:
  bool solve(const VectorJ& theta, const Statics& statics) noexcept;

  JointSprings springs_;
  bool link_measured_;
  VectorJ K_J_;
  VectorJ deflection_;
  QbarSolver qbar_;
  bool solved_ = true;
};

}  // namespace limber::controller
