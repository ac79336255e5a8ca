// Least squares with coefficients that may not be negative.
#pragma once

#include "common/types.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// Minimises x^T G x / 2 - h^T x over x >= 0: least squares |A x - b| with G = A^T A, h = A^T b.
/// Active-set method of Lawson and Hanson (Solving Least Squares Problems, 1974, chapter 23), in
/// the form with normal equations of Bro and de Jong (1997). G: n x n positive semidefinite;
/// directions G does not see stay zero. No allocation; takes as long as the active set needs to
/// settle, at most 3 n exchanges: for the slow rate, not for every cycle.
VectorJ nonnegative_least_squares(const MatrixJ& G, const VectorJ& h) noexcept;

}  // namespace limber::controller
#pragma GCC visibility pop
