// Where a redundant arm keeps its elbow.
#pragma once

#include "common/types.h"
#include "controller/arm_state.h"
#include "controller/arm_terms.h"
#include "controller/gains.h"
#include "controller/goal.h"
#include "controller/singularity.h"

namespace limber::controller {

/// The rows of the task: those in which K_x has an entry. An arm that is free in a direction may
/// use it to keep its posture.
struct TaskRows {
  explicit TaskRows(const Matrix6& K_x) noexcept;
  bool operator==(const TaskRows&) const = default;

  bool stiff[6];
};

/// tau_0 less the part of it that would move the tip along the task's rows:
///   N tau_0,  N = I - J_t^T Lambda J_t M^-1      (Khatib 1987),
/// J_t the task's rows of J, M with rotors, Lambda damped near singularities (there the projector
/// opens and closes gradually). J_t M^-1 N tau_0 = 0 elsewhere. Zero if nothing is left over.
VectorJ project_to_null_space(const ArmTerms& terms, const TaskRows& rows,
                              const VectorJ& tau_0) noexcept;

/// N (-K_null (q - q_null) - D_null v). Not the gradient of an energy: keep D_null > 0. Each
/// component before the projection is limited to `torque_limit`, so that a posture far away does
/// not take the torque the task needs. Both may be called in the cycle.
VectorJ null_space_torque(const ArmState& state, const ArmTerms& terms, const Goal& goal,
                          const Gains& gains, const TaskRows& rows,
                          const VectorJ& torque_limit) noexcept;

}  // namespace limber::controller
