// How gravity's torque changes with the posture.
#pragma once

#include "controller/model/arm_terms.h"

namespace limber::controller {

/// dg/dq, symmetric, n x n, N m/rad, by central differences (2 n evaluations of g; error about 1e-9
/// of g). The greatest norm over the workspace is what a motor-side position law has to exceed. May
/// be called in the cycle.
MatrixJ gravity_gradient(ArmModel* model, const VectorJ& q) noexcept;

}  // namespace limber::controller
