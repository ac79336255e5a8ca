// Damping that gives every mode of a mass and a spring the same damping ratio.
#pragma once

#include "common/types.h"
#include "controller/singularity.h"

namespace limber::controller {

/// Double diagonalisation (Albu-Schaeffer, Ott, Frese, Hirzinger, ICRA 2003) in joint space:
///   M = L L^T,  S = L^-1 K L^-T,  D = 2 zeta L sqrt(S) L^T:
/// all modes of M s^2 + D s + K have damping ratio zeta. M: n x n positive definite, rotors
/// included; K: n x n diagonal, given as a vector, N m/rad, none negative. Joints without stiffness
/// get no damping from it: see joint_damping_floor(). May be called in the cycle.
MatrixJ joint_damping(const MatrixJ& M, const VectorJ& K, double ratio) noexcept;

/// The same at the tip, for the directions the arm can move in: with G = J M^-1 J^T = L L^T,
///   S = L^T K L,  D = 2 zeta L^-T sqrt(S) L^-1,
/// where L = U sqrt(s) is taken from the eigenvalues of G and directions out of reach are left out
/// (no damping; there is no motion to damp). Near a singularity D fades to zero with the
/// eigenvalue and stays bounded. K: 6 x 6, symmetric positive semidefinite.
Matrix6 tip_damping(const TipMobility& mobility, const Matrix6& K, double ratio) noexcept;

/// Damping of a direction without stiffness, so that a pushed arm comes to rest: 5 N s/m and
/// 0.2 N m s/rad, faded out where the stiffness exceeds 10 N/m or 0.9 N m/rad (10 N/m at
/// kRotationLength_m). Depends on K alone: compute it when K changes.
Matrix6 tip_damping_floor(const Matrix6& K) noexcept;

/// The same for joints: M_ii / 0.5 s on joints without stiffness, faded out at 1 N m/rad.
VectorJ joint_damping_floor(const MatrixJ& M, const VectorJ& K) noexcept;

}  // namespace limber::controller
