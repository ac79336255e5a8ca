// Where a redundant arm keeps its elbow.
#pragma once

#include "common/types.h"
#include "controller/kinds/gains.h"
#include "controller/kinds/goal.h"
#include "controller/model/arm_state.h"
#include "controller/model/arm_terms.h"
#include "controller/model/singularity.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// The rows of the task: those in which K_x has an entry. An arm that is free in a direction may
/// use it to keep its posture.
struct TaskRows {
  explicit TaskRows(const Matrix6& K_x) noexcept;
  bool operator==(const TaskRows&) const = default;

  int count() const noexcept;
  /// M with the rows that are not stiff set to zero.
  Matrix6J of(Matrix6J J) const noexcept;
  Vector6 of(Vector6 F) const noexcept;

  bool stiff[6];
};

/// Directions whose apparent inertia is more than ten thousand times the lightest one's are being
/// lost.
inline constexpr double kLostShare = 1e-4;

/// M on the task's rows, zero elsewhere.
Matrix6 on_task(const TaskRows& rows, Matrix6 M) noexcept;

/// The same with ones on the diagonal of every row left empty, so that it has an inverse: also
/// while a ramp of K_x still holds rows that M no longer has.
Matrix6 invertible_on_task(const TaskRows& rows, const Matrix6& M) noexcept;

/// nullptr if M_x is zero or positive definite wherever K_x has entries; in the goal's axes an
/// entry in one row may turn into any of its block. In the cycle.
const char* check_tip_inertia(const Gains& gains) noexcept;

/// The tip's inertia over the task's rows alone. In the cycle.
TipInertia task_tip(const ArmTerms& terms, const TaskRows& rows) noexcept;

/// Of the task's rows alone; zero out of them. In the cycle.
TipMobility task_mobility(const ArmTerms& terms, const TaskRows& rows) noexcept;

/// Tip inertia Lambda = (J_t M^-1 J_t^T)^-1 over the task's rows, 6 x 6 with zeros elsewhere, kg
/// and kg m^2; M with rotors. Damped near singularities, see damped_tip_inertia(). In the cycle.
Matrix6 task_inertia(const ArmTerms& terms, const TaskRows& rows,
                     double lost_share = kLostShare) noexcept;

/// N, n x n, the part of a joint torque that does not act on the task's rows J_t of J:
///   dynamic    N = I - J_t^T Lambda J_t M^-1 (Khatib 1987): J_t M^-1 N = 0, the tip does not move
///   kinematic  N = I - J_t^T (J_t^+)^T: no static force at the tip, but it accelerates
///   none       N = I
/// M with rotors. Near singularities the inverses are damped and the projector opens and closes
/// gradually. Zero if nothing is left over. May be called in the cycle.
MatrixJ null_space_projector(const ArmTerms& terms, const TaskRows& rows, Projector projector,
                             double lost_share = kLostShare) noexcept;

/// N (-K_null (q - q_null) - D_null v). Not the gradient of an energy: keep D_null > 0. Each
/// component before the projection is limited to `torque_limit`, so that a posture far away does
/// not take the torque the task needs. May be called in the cycle.
VectorJ null_space_torque(const ControlPoint& point, const ArmTerms& terms, const Goal& goal,
                          const Gains& gains, const TaskRows& rows,
                          const VectorJ& torque_limit) noexcept;

}  // namespace limber::controller
#pragma GCC visibility pop
