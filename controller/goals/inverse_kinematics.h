// Joint goal for a goal at the tip.
#pragma once

#include "controller/impedance/nullspace.h"
#include "controller/kinds/goal.h"
#include "controller/model/arm_terms.h"

namespace limber::controller {

/// Follows the goal at the tip with q_d, by damped Gauss-Newton steps from where it was, up to
/// three a cycle (the goal moves smoothly, so it keeps up to rounding), and its rates:
///   v_d = J^+ (V_BD) + (I - J^+ J) v_0,   a_d = J^+ (A_BD - Jdot v_d),   J = J(q_d)
/// over the task's rows only (a_d without the rate of v_0), J^+ damped near singularities. v_0
/// pulls a redundant arm towards the posture q_null. Where the goal is out of reach q_d stays as
/// close as the damping lets it.
class InverseKinematics {
 public:
  explicit InverseKinematics(const ArmModel& model);

  /// Starts from q. In the cycle.
  void reset(const VectorJ& q) noexcept;
  /// Goes to a pose that is not where the arm is, so that the joints do not have to run after it.
  /// In the cycle, where a law starts.
  void approach(const TaskRows& rows, const Pose& X_BD) noexcept;
  /// Takes X_BD, V_BD, A_BD and q_null of the goal, writes q_d, v_d, a_d. In the cycle.
  void track(const TaskRows& rows, double dt_s, Goal* goal) noexcept;

 private:
  /// Of the task's rows, at q_.
  struct Tangent {
    Matrix6J J;
    MatrixJ6 inverse;  ///< damped pseudo-inverse
  };
  /// At most so many steps, until one no longer moves a joint.
  Tangent correct(int steps, const TaskRows& rows, const Pose& X_BD) noexcept;

  ArmModel model_;
  VectorJ q_;
  VectorJ drift_;  // rate of the posture in the null space
};

}  // namespace limber::controller
