// Systems of equations with the arm's inertia matrix.
#pragma once

#include "common/types.h"

namespace limber::controller {

/// X <- M^-1 X for a symmetric positive definite M, n x n, by M = L D L^T with unit lower L (no
/// pivots, no roots). Gives values that are not finite where M is not positive definite or not
/// finite. May be called in the cycle.
void solve_spd(const MatrixJ& M, MatrixJ6* X) noexcept;

}  // namespace limber::controller
