// The damping a user's gains ask for: a design, or the matrix given.
#pragma once

#include "controller/arm_terms.h"
#include "controller/gains.h"

namespace limber::controller {

/// For the joint stiffness K_q on the inertia M (n x n), with the floor for joints without
/// stiffness unless it is given. In the cycle.
MatrixJ chosen_joint_damping(const Gains& gains, const MatrixJ& M, const MatrixJ& K_q) noexcept;

/// For K_x at the tip, without the floor. In the cycle.
Matrix6 chosen_tip_damping(const Gains& gains, const ArmTerms& terms) noexcept;

}  // namespace limber::controller
