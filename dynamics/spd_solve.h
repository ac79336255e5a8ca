// Systems of equations with the arm's inertia matrix.
#pragma once

#include "common/types.h"

namespace limber::dynamics {

/// X <- M^-1 X for a symmetric positive definite M, n x n, by elimination without pivoting. Gives
/// values that are not finite where M is not positive definite or not finite. May be called in the
/// cycle.
void solve_spd(const MatrixJ& M, MatrixJ6* X) noexcept;
void solve_spd(const MatrixJ& M, VectorJ* X) noexcept;

}  // namespace limber::dynamics
