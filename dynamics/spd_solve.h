// Systems of equations with the arm's inertia matrix.
#pragma once

#include "common/types.h"

namespace limber::dynamics {

/// X <- M^-1 X for a symmetric positive definite M, n x n, by M = L D L^T with unit lower L (no
/// pivots, no roots). Gives values that are not finite where M is not positive definite or not
/// finite. X is a MatrixJ6 or a VectorJ. May be called in the cycle.
template <int Columns>
void solve_spd(const MatrixJ& M,
               Eigen::Matrix<double, Eigen::Dynamic, Columns, Eigen::ColMajor, kMaxJoints, Columns>*
                   X) noexcept;
extern template void solve_spd(const MatrixJ& M, MatrixJ6* X) noexcept;
extern template void solve_spd(const MatrixJ& M, VectorJ* X) noexcept;

}  // namespace limber::dynamics
