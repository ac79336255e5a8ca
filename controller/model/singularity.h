// Which directions the tip can move in, and how heavy it is there.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>

#include "common/types.h"

#pragma GCC visibility push(default)
namespace limber::controller {

/// Rotational rows count as the translation of a point this far from the tip, so that directions of
/// both kinds can be compared, m.
inline constexpr double kRotationLength_m = 0.3;

/// Eigenvalues of the tip's inverse inertia G = J M^-1 J^T, in rows scaled by kRotationLength_m:
///   diag(S) G diag(S) = U diag(s) U^T,  S = (1, 1, 1, l, l, l),  s ascending, 1/kg.
/// s is zero in directions the arm cannot move in: always for arms with fewer than six joints, at
/// singular poses for the others. There the inertia 1/s does not exist; functions of it are formed
/// from s alone and fade to zero instead.
struct TipMobility {
  Matrix6 U;
  Vector6 s;
  Vector6 S;

  /// Below this share of the largest eigenvalue a direction counts as lost. Never zero.
  double threshold(double share) const noexcept {
    return std::max(share * s[5], std::numeric_limits<double>::min());
  }
};

/// G^-1 by inverse_spd(), if that proves that no eigenvalue of G is below `least`; an
/// order of magnitude cheaper than the eigenvalues themselves. G: symmetric. May be called in the
/// cycle.
std::optional<Matrix6> regular_inverse(const Matrix6& G, double least) noexcept;

/// The tip as a body. To be made in the cycle.
struct TipInertia {
  TipInertia() = default;
  explicit TipInertia(const Matrix6& inverse_inertia) noexcept;

  Matrix6 G = Matrix6::Zero();       ///< J M^-1 J^T, 1/kg and 1/(kg m^2)
  Matrix6 Lambda = Matrix6::Zero();  ///< G^-1, kg and kg m^2; of no meaning unless regular
  /// No direction has less of the mobility of all, in scaled rows; not a number, or zero, where
  /// nothing is known.
  double least_share = 0.0;

  bool regular(double lost_share) const noexcept { return least_share >= lost_share; }
};

/// S of TipMobility.
Vector6 row_scale() noexcept;

/// diag(S) G diag(S), see TipMobility. May be called in the cycle.
Matrix6 scaled_mobility(const Matrix6& G) noexcept;

/// G = J M^-1 J^T. Rows of it that are zero count as directions out of reach. May be called in the
/// cycle.
TipMobility tip_mobility(const Matrix6& G) noexcept;

/// Damped pseudo-inverse of G: the tip inertia Lambda within reach, kg and kg m^2. Exact for
/// eigenvalues above the threshold; below, 1/s is faded out with 3 x^2 - 2 x^3, x = s / threshold,
/// so that it stays finite and continuous through a singularity. May be called in the cycle.
Matrix6 damped_tip_inertia(const TipMobility& mobility, double threshold) noexcept;

/// The same with the threshold TipMobility::threshold(lost_share); zero where the tip cannot move
/// at all. The eigenvalues are only formed where a direction may be lost. May be called in the
/// cycle.
Matrix6 damped_tip_inertia(const TipInertia& tip, double lost_share) noexcept;

/// Damped pseudo-inverse of J (Nakamura, Hanafusa 1986), n x 6:
///   J^T (J J^T + lambda^2 I)^-1,  lambda^2 = lambda_max^2 (1 - (sigma_min / sigma_0)^2)
/// below sigma_min < sigma_0, else lambda = 0; |inverse| <= 1 / (2 lambda). sigma_min is the least
/// singular value among as many as rows and columns allow; rows that are zero are left out. Rows
/// are not scaled here.
struct DampedInverse {
  double sigma_min;
  double lambda;
  MatrixJ6 inverse;
};

inline constexpr double kSigma_0 = 0.05;
inline constexpr double kLambdaMax = 0.05;

/// May be called in the cycle.
DampedInverse damped_inverse(const Matrix6J& J, double sigma_0 = kSigma_0,
                             double lambda_max = kLambdaMax) noexcept;

/// DampedInverse::inverse with kSigma_0 and kLambdaMax; the singular values are only formed where
/// the least may be below kSigma_0. May be called in the cycle.
MatrixJ6 damped_pseudo_inverse(const Matrix6J& J) noexcept;

}  // namespace limber::controller
#pragma GCC visibility pop
