// Damping that suits a mass and a spring.
#pragma once

#include "common/types.h"
#include "controller/kinds/law_settings.h"
#include "controller/model/singularity.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// Damping for the joints, n x n, N m s/rad, from M (n x n positive definite, rotors included) and
/// K (n x n symmetric positive semidefinite), so that the modes of M s^2 + D s + K have the damping
/// ratio zeta (Albu-Schaeffer, Ott, Frese, Hirzinger, ICRA 2003):
///   double diagonalisation  M = L L^T, S = L^-1 K L^-T, D = 2 zeta L sqrt(S) L^T: every mode. That
///                           is 2 zeta M # K (dynamics/geometric_mean.h)
///   factorisation           D = zeta (sqrt(M) sqrt(K) + sqrt(K) sqrt(M)): if M and K commute;
///                           negative eigenvalues, which the sum can have, are set to zero
///   without inertia         D = 2 zeta sqrt(K): off by the root of the inertia
/// Directions without stiffness get no damping from any: see joint_damping_floor(). kGiven is no
/// design and returns zero. May be called in the cycle.
MatrixJ joint_damping(DampingDesign design, const MatrixJ& M, const MatrixJ& K,
                      double ratio) noexcept;

/// The same at the tip, for the directions the arm can move in: with G = J M^-1 J^T = L L^T,
///   double diagonalisation  S = L^T K L, D = 2 zeta L^-T sqrt(S) L^-1
/// where L = U sqrt(s) is taken from the eigenvalues of G and directions out of reach are left out
/// (no damping; there is no motion to damp). Near a singularity D fades to zero with the
/// eigenvalue and stays bounded. K: 6 x 6, symmetric positive semidefinite.
Matrix6 tip_damping(DampingDesign design, const TipMobility& mobility, const Matrix6& K,
                    double ratio) noexcept;

/// The same: away from singularities the design for the inertia G^-1.
Matrix6 tip_damping(DampingDesign design, const TipInertia& tip, const Matrix6& K,
                    double ratio) noexcept;

/// The factorisation as it stands, with the negative eigenvalues it may have.
Matrix6 factorised_tip_damping(const TipMobility& mobility, const Matrix6& K,
                               double ratio) noexcept;

/// Damping of a wanted inertia at the tip, given as a matrix: the same for M_d s^2 + D s + K. M_d:
/// 6 x 6 symmetric positive definite.
Matrix6 inertia_damping(DampingDesign design, const Matrix6& M_d, const Matrix6& K,
                        double ratio) noexcept;

/// The double-diagonalised modes of the tip, softest first: the tip moves by L v_i, for which it
/// takes the wrench stiffness_i L^-T v_i.
struct TipModes {
  Vector6 stiffness;  ///< 1/s^2; zero for directions out of reach
  Matrix6 force;      ///< columns L^-T v_i, N or N m for 1 m/s^2 of the mode
};
/// In the cycle.
TipModes tip_modes_of(const Matrix6& G, const Matrix6& K) noexcept;

/// Stiffness of each double-diagonalised mode, ascending, 1/s^2: squares of the natural
/// frequencies; zero for directions out of reach.
Vector6 modal_stiffness(const TipMobility& mobility, const Matrix6& K) noexcept;

/// Damping of a direction without stiffness, so that a pushed arm comes to rest: 5 N s/m and
/// 0.2 N m s/rad, faded out where the stiffness exceeds 10 N/m or 0.9 N m/rad (10 N/m at
/// kRotationLength_m). Depends on K alone: compute it when K changes.
Matrix6 tip_damping_floor(const Matrix6& K) noexcept;

/// The same for joints: M_ii / 0.5 s on joints without stiffness, faded out at 1 N m/rad.
VectorJ joint_damping_floor(const MatrixJ& M, const MatrixJ& K) noexcept;

}  // namespace limber::controller
#pragma GCC visibility pop
