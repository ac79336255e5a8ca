// Systems of equations with the arm's inertia matrix, and what the tip is to a wrench.
#pragma once

#include "common/types.h"

#pragma GCC visibility push(default)
namespace limber::dynamics {

/// X <- M^-1 X for a symmetric positive definite M, n x n, by elimination without pivoting. Gives
/// values that are not finite where M is not positive definite or not finite. May be called in the
/// cycle.
void solve_spd(const MatrixJ& M, VectorJ* X) noexcept;

/// M^-1 J^T, n x 6, and G = J M^-1 J^T, 6 x 6; likewise.
void solve_spd(const MatrixJ& M, const Matrix6J& J, MatrixJ6* Minv_JT, Matrix6* G) noexcept;

/// G^-1; likewise.
Matrix6 inverse_spd(const Matrix6& G) noexcept;

}  // namespace limber::dynamics
#pragma GCC visibility pop
